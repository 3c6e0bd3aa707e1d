"""A line to the session for sound: `woz listen` and `woz talk` ask, and wait as `select` does."""

from __future__ import annotations

import socket
import time
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec

from woz_tui.protocol import codec
from woz_tui.protocol.requests import Hello, Reply, Request, Welcome

#: Pieces that may be under way at once, and how long one is, in seconds.
_AHEAD, _PIECE_S = 32, 0.02
#: A robot process that has not answered for so long is told of, in seconds.
LATE_S = 2.0
#: Hears what a person may read beside the sound: what it is about (`sound`, `late` ...), the text.
Tell = Callable[[str, str], None]


class SoundEndError(Exception):
    """There is no sound any more; the text says why, `remedy` what helps. `code`: of the exit.
    `gone`: the session went without a word: it has ended, or it is the network.
    """

    def __init__(self, why: str, remedy: str = "", code: int = 1, *, gone: bool = False) -> None:
        super().__init__(why)
        self.remedy = remedy
        self.code = code
        self.gone = gone


class SoundClient:
    """A client of the session's socket; what it asks is answered in order.

    Raises `SoundEndError` where the robot process refuses or leaves.
    """

    def __init__(self, path: Path, role: str, name: str, tell: Tell) -> None:
        self._tell = tell
        self._ref = 0
        self._rest = bytearray()
        self._answers: deque[Any] = deque()
        #: What has not been answered: its number, and when it was asked.
        self._asked: deque[tuple[int, float]] = deque()
        #: How long the last answer took, in seconds.
        self.took_s = 0.0
        try:
            self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            self.socket.connect(str(path))
        except OSError as error:
            why = f"the session cannot be reached: {error.strerror}"
            raise SoundEndError(why, gone=True) from error
        # As the wizard sees it: a sound can tell what is kept from a wizard.
        sees = "wizard" if role == "program" else ""
        self._send(Hello(role=role, name=name, stream="nothing", sees=sees))  # type: ignore[arg-type]
        answer = None
        while not isinstance(answer, Welcome):
            self.receive()
            while self._answers and not isinstance(answer, Welcome):
                answer = self._answers.popleft()
                self._check(answer)

    def ask(self, request: Request) -> None:
        """Send `request`, with a number; its answer comes by `answer`."""
        self._ref += 1
        self._asked.append((self._ref, time.monotonic()))
        self._send(msgspec.structs.replace(request, ref=self._ref))

    @property
    def asked_at(self) -> float | None:
        """When the oldest was asked that has not been answered; None: there is none."""
        return self._asked[0][1] if self._asked else None

    def tell_late(self) -> None:
        """Say so if the robot process stands still."""
        if self.asked_at is not None and time.monotonic() - self.asked_at > LATE_S:
            seconds = time.monotonic() - self.asked_at
            self._tell("late", f"the robot process has not answered for {seconds:.0f} s")

    def may_ask(self, way_s: float) -> bool:
        """Whether one more may be asked, where a question and its answer are under way for so long:
        as many pieces as come meanwhile.
        """
        return len(self._asked) < min(_AHEAD, 1 + round(way_s / _PIECE_S))

    def answer(self) -> Any:
        """The answer to the oldest question; None: it is not there yet."""
        while self._answers:
            answer = self._answers.popleft()
            self._check(answer)
            if self._asked and getattr(answer, "ref", 0) == self._asked[0][0]:
                self.took_s = time.monotonic() - self._asked.popleft()[1]
                return answer
        return None

    def receive(self) -> None:
        """Read what has come; blocks if nothing has."""
        try:
            data = self.socket.recv(1 << 16)
        except OSError:
            data = b""
        if not data:
            raise SoundEndError("the session has ended", code=0, gone=True)
        self._rest += data
        *lines, rest = bytes(self._rest).split(b"\n")
        self._rest = bytearray(rest)
        self._answers.extend(codec.decode_incoming(line) for line in lines if line)

    def _check(self, answer: Any) -> None:
        if isinstance(answer, Reply) and not answer.ok:
            raise SoundEndError(answer.reason, answer.hint)

    def _send(self, request: Request) -> None:
        try:
            self.socket.sendall(codec.encode(request))
        except OSError as error:
            raise SoundEndError("the session has ended", code=0, gone=True) from error
