"""A robot process as far as its socket goes: it speaks the wire, and writes down what it is asked.

Runs in threads of the test, so a console in another process finds it like a real one.
"""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import msgspec

from woz_tui.protocol import codec
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.protocol.requests import (
    PROTOCOL,
    AskStop,
    Beat,
    Hello,
    Pulse,
    Reply,
    Request,
    Welcome,
)
from woz_tui.protocol.welcome import WelcomeSettings

R = TypeVar("R", bound=Request)
WAIT_S = 40.0


@dataclass(frozen=True, slots=True)
class Heard:
    """A request, when it came (CLOCK_MONOTONIC, microseconds), and over which connection."""

    request: Request
    at_us: int
    connection: int


class FakeHost:
    """Listens at `path`; use it as a context manager.

    Args:
        path: Of the socket, made by `listen`.
        keys: Chord -> name of the action in the one panel that is offered.
        verbs: Driver -> verbs, as in the welcome.
        pulse_s: Seconds between pulses.
    """

    def __init__(
        self,
        path: Path,
        *,
        keys: dict[str, str] | None = None,
        verbs: dict[str, list[str]] | None = None,
        pulse_s: float = 0.2,
    ) -> None:
        self.path = path
        self.heard: list[Heard] = []
        self.closed: list[int] = []
        #: Set: it neither reads nor speaks, as a stopped process.
        self.frozen = False
        #: What the welcome says of the machine.
        self.boot_id = self.robot_at = ""
        #: What it says of the experiment.
        self.settings = WelcomeSettings()
        #: Set: it reads and answers, but does not pulse.
        self.silent = False
        self._keys = keys or {}
        self._verbs = verbs or {}
        self._pulse_s = pulse_s
        self._changed = threading.Condition()
        self._connections: dict[int, socket.socket] = {}
        self._count = 0
        self._over = threading.Event()
        self._listener: socket.socket | None = None

    def __enter__(self) -> FakeHost:
        self.listen()
        threading.Thread(target=self._pulse, daemon=True).start()
        return self

    def __exit__(self, *failed: object) -> None:
        self._over.set()
        self.stop_listening()
        self.drop()

    # -- what a test does with it --------------------------------------------------------------

    def listen(self) -> None:
        """Take connections (again)."""
        self.path.unlink(missing_ok=True)
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(str(self.path))
        listener.listen(16)
        self._listener = listener
        threading.Thread(target=self._accept, args=(listener,), daemon=True).start()

    def stop_listening(self) -> None:
        """Take no more connections; those that stand go on."""
        if self._listener is not None:
            with contextlib.suppress(OSError):
                self._listener.shutdown(socket.SHUT_RDWR)
            self._listener.close()
            self._listener = None
        self.path.unlink(missing_ok=True)

    def drop(self) -> None:
        """Close every connection."""
        with self._changed:
            connections = list(self._connections.values())
        for connection in connections:
            with contextlib.suppress(OSError):
                connection.shutdown(socket.SHUT_RDWR)

    def say(self, *messages: msgspec.Struct) -> None:
        """Send messages to everybody."""
        self.say_bytes(b"".join(map(codec.encode, messages)))

    def say_bytes(self, data: bytes) -> None:
        """Send `data` to everybody."""
        with self._changed:
            for connection in self._connections.values():
                with contextlib.suppress(OSError):
                    connection.sendall(data)

    def all(self, kind: type[R]) -> list[R]:
        """Every request of this kind so far."""
        with self._changed:
            return [heard.request for heard in self.heard if isinstance(heard.request, kind)]

    def wait(self, kind: type[R], count: int = 1) -> R:
        """The `count`-th request of this kind, as soon as it is there."""
        self.until(lambda: len(self.all(kind)) >= count, f"{kind.__name__} number {count}")
        return self.all(kind)[count - 1]

    def line_ok(self) -> bool | None:
        """What the last beat said about the line; None before the first."""
        beats = self.all(Beat)
        return beats[-1].line_ok if beats else None

    def until(self, true: Callable[[], bool], what: str) -> None:
        """Wait until `true()`; `what` says in the failure what did not happen."""
        with self._changed:
            if not self._changed.wait_for(true, WAIT_S):
                told = [h.request for h in self.heard if not isinstance(h.request, Beat)]
                raise AssertionError(f"never came: {what}; heard so far: {told}")

    # -- threads -------------------------------------------------------------------------------

    def _accept(self, listener: socket.socket) -> None:
        while not self._over.is_set():
            try:
                connection, _ = listener.accept()
            except OSError:
                return
            with self._changed:
                self._count += 1
                number = self._count
                self._connections[number] = connection
            threading.Thread(target=self._serve, args=(number, connection), daemon=True).start()

    def _serve(self, number: int, connection: socket.socket) -> None:
        rest = b""
        while True:
            while self.frozen and not self._over.wait(0.01):
                pass
            try:
                data = connection.recv(65536)
            except OSError:
                data = b""
            if not data:
                break
            lines = (rest + data).split(b"\n")
            rest = lines.pop()
            for line in lines:
                self._hear(number, connection, codec.decode_request(line))
        with self._changed:
            del self._connections[number]
            self.closed.append(number)
            self._changed.notify_all()
        connection.close()

    def _hear(self, number: int, connection: socket.socket, request: Request) -> None:
        with self._changed:
            self.heard.append(Heard(request, time.monotonic_ns() // 1000, number))
            self._changed.notify_all()
        if isinstance(request, Beat):
            return
        answer: msgspec.Struct = Reply(ref=request.ref, ok=True)
        if isinstance(request, Hello):
            answer = self._welcome()
        with contextlib.suppress(OSError):
            connection.sendall(codec.encode(answer))

    def _welcome(self) -> Welcome:
        actions = [ActionView(name=name, label=name, key=key) for key, name in self._keys.items()]
        return Welcome(
            protocol=PROTOCOL,
            console="con1",
            role="wizard",
            seq=-1,
            t=0,
            title="Fake",
            log="",
            panels=[PanelView(title="Actions", actions=actions)],
            script=[],
            verbs=self._verbs,
            variables=[],
            conditions=[],
            keyboard="us",
            drivers=list(self._verbs),
            boot_id=self.boot_id,
            robot_at=self.robot_at,
            settings=self.settings,
        )

    def _pulse(self) -> None:
        while not self._over.wait(self._pulse_s):
            if not self.frozen and not self.silent:
                self.say(Pulse(t=time.monotonic_ns() // 1000))


def stops(host: FakeHost) -> list[str]:
    """Sources of all stops that arrived."""
    return [request.source for request in host.all(AskStop)]
