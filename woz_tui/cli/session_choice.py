"""Which session a command joins: one of this machine, or with an access file one on another."""

from __future__ import annotations

import contextlib
import socket
import sys
import time
from argparse import ArgumentParser
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from woz_tui.protocol import codec
from woz_tui.protocol.requests import AskAbout, Reply
from woz_tui.system import session_sockets
from woz_tui.system.text_cleaning import one_line

if TYPE_CHECKING:
    from woz_tui.cli.remote_start import RemoteLine

#: A session whose computer is there has ended when nobody has listened for so long, in seconds; and
#: so long it may take until a lost line is noticed.
_ENDED_S, _NOTICED_S = 5.0, 5.0
#: How long a session may take to say what it is, in seconds.
_ABOUT_S = 1.0


def add_session_choice(parser: ArgumentParser, name: str = "name") -> None:
    """Declare which session it is; `name` is the argument, an option if it begins with `--`."""
    more = {} if name.startswith("-") else {"nargs": "?"}
    parser.add_argument(
        name,
        default="",
        help="session code, such as S02, or socket (default: the only one that runs); with"
        " --access: the robot's HOST:PORT",
        **more,  # type: ignore[arg-type]
    )
    parser.add_argument(
        "--access",
        type=Path,
        default=None,
        metavar="FILE",
        help="join a session on another machine with this access file (see `woz access`)",
    )


@dataclass(frozen=True, slots=True)
class JoinedSession:
    """A session that a command has joined: its socket here, and the line to it if it is far."""

    path: Path
    line: RemoteLine | None = None

    def comes_back(self, tell: Callable[[str], None], idle: Callable[[], None]) -> bool:
        """Wait while the line to another machine is lost; whether the session can be joined again.
        `tell` hears why it cannot be, `idle` is called meanwhile and takes a moment.
        """
        line, told, reached = self.line, "", 0.0
        if line is None:
            return False
        began = time.monotonic()
        while not line.final:
            now = time.monotonic()
            if line.reason and line.reason != told:
                told = line.reason
                tell(f"{told}; it is looked for")
            reached = (reached or now) if line.reached else 0.0
            if reached and now - reached > _ENDED_S:
                return False
            if line.usable and (told or now - began > _NOTICED_S):
                return True
            idle()
        return False

    @property
    def barred(self) -> str:
        """Why nobody lets us in any more; empty: nobody said so."""
        return self.line.reason if self.line is not None and self.line.final else ""


@contextlib.contextmanager
def joined_session(access: Path | None, name: str, command: str) -> Iterator[JoinedSession | None]:
    """The session `name`, here or with `access` on another machine; None after printing why there
    is none. `command` is what is proposed to be typed with a name.
    """
    if access is None:
        path = find_session(name, command)
        yield None if path is None else JoinedSession(path)
        return
    from woz_tui.cli.remote_start import remote_session  # noqa: PLC0415 - few come from afar

    with remote_session(access, name) as line:
        yield None if line is None or line.socket is None else JoinedSession(line.socket, line)


def find_session(name: str, command: str, options: str = "") -> Path | None:
    """The socket of the session `name`, or of the only one; None after printing why there is none.
    `command` is what is proposed to be typed with a name, and `options` behind it.
    """
    try:
        if name:
            socket = Path(name) if "/" in name else session_sockets.socket_path(name)
            if session_sockets.answers(socket):
                return socket
            print(f"woz: no session is running at {socket}", file=sys.stderr)
        running = session_sockets.running()
    except session_sockets.SessionSocketError as error:
        print(f"woz: {error}", file=sys.stderr)
        return None
    if not name and len(running) == 1:
        return running[0]
    if running:
        names = "\n".join(
            f"  {command} {path.stem}{options}   # {_about(path)}running"
            f" {session_sockets.age_s(path) // 60:.0f} min"
            for path in running
        )
        print(f"woz: which session?\n{names}", file=sys.stderr)
    elif not name:
        print("woz: no session is running; start one with `woz run FILE`", file=sys.stderr)
    return None


def _about(path: Path) -> str:
    """The title and the participant of a session; empty if it does not tell them, as those of older
    versions.
    """
    reply = None
    with (
        contextlib.suppress(OSError, codec.WireError),
        socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection,
    ):
        connection.settimeout(_ABOUT_S)
        connection.connect(str(path))
        connection.sendall(codec.encode(AskAbout(ref=1)))
        with connection.makefile("rb") as answers:
            reply = codec.decode_incoming(answers.readline(codec.MAX_LINE))
    told = reply.data if isinstance(reply, Reply) else None
    if not isinstance(told, dict):
        return ""
    who = told.get("participant") or "no participant yet"
    return one_line(f"{told.get('title')}, {who}, ")
