"""Makes a session on another machine usable here, for as long as a command runs."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from woz_tui.console.link.message_feed import Loss, LostPart
from woz_tui.network.certificates import AccessError, AccessFile
from woz_tui.network.listen_address import ListenAddress

#: How long the process may take to end, in seconds.
_END_S = 3.0


class RemoteLine:
    """A session on another machine, and what the process that carries its lines says of the line.

    Args:
        process: That process.
        address: `HOST:PORT` of the robot's computer.
    """

    def __init__(self, process: subprocess.Popen[bytes], address: str) -> None:
        self._process = process
        self._address = address
        self._last: dict[str, Any] = {}
        self._follower = threading.Thread(target=self._follow, name="remote line", daemon=True)
        self.socket: Path | None = None

    def open(self) -> Path | None:
        """Wait until it can be joined: its local socket. Troubles on the way are printed."""
        assert self._process.stdout is not None
        shown = ""
        for line in self._process.stdout:
            announced = json.loads(line)
            if "socket" in announced:
                self.socket = Path(announced["socket"])
                # Somebody has to read on: a full pipe would hold up the line.
                self._follower.start()
                return self.socket
            if announced["trouble"] != shown:
                shown = announced["trouble"]
                print(f"woz: {shown}", file=sys.stderr)
                if not announced.get("final"):
                    print("woz: it is tried again; ctrl+c gives up", file=sys.stderr)
        return None

    def _follow(self) -> None:
        assert self._process.stdout is not None
        with contextlib.suppress(ValueError):  # closed: the command ends
            for line in self._process.stdout:
                self._last = json.loads(line)

    @property
    def usable(self) -> bool:
        """Whether it can be joined at the moment."""
        return not self.reason and self.socket is not None and self.socket.exists()

    @property
    def reason(self) -> str:
        """Why it cannot be used at the moment; empty: it can."""
        return str(self._last.get("trouble", ""))

    @property
    def reached(self) -> bool:
        """Whether the robot's computer was there at the last attempt, and no session listened."""
        return bool(self._last.get("reached"))

    @property
    def final(self) -> bool:
        """Whether it will not come back: we are not let in any more, or nobody carries it."""
        ended = self._process.poll() is not None
        if ended and self._follower.is_alive():
            self._follower.join(_END_S)  # the reason is the last that it has said
        return ended or bool(self._last.get("final"))

    def explained(self, loss: Loss) -> Loss:
        """How its loss is to be understood: whether the line or the robot process is gone."""
        if self.reason:
            part = LostPart.PROCESS if self.reached else LostPart.LINE
            return Loss(self.reason, part)
        if loss.part is LostPart.ANSWER:
            return loss
        return Loss(f"the connection to {self._address} broke", LostPart.LINE)


@contextlib.contextmanager
def remote_session(access: Path, address: str) -> Iterator[RemoteLine | None]:
    """The session at `address` (empty: the one in the access file); None after printing why there
    is none. While the network is gone its socket is gone, too.
    """
    try:
        place = address or AccessFile.read(access).address
        if not place:
            raise AccessError(f"where is the robot? add HOST:PORT behind --access {access}")
        ListenAddress.read(place)
    except (AccessError, ValueError) as error:
        print(f"woz: {error}", file=sys.stderr)
        yield None
        return
    process = subprocess.Popen(
        [
            *(sys.executable, "-P", "-m", "woz_tui.remote.remote_session"),
            *("--access", str(access), "--address", place),
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        start_new_session=True,  # ctrl+c is the wizard's stop
    )
    line = RemoteLine(process, place)
    try:
        yield line if line.open() is not None else None
    finally:
        assert process.stdin is not None
        assert process.stdout is not None
        with contextlib.suppress(OSError):
            process.stdin.close()
        try:
            process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
