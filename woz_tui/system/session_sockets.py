"""The sockets of running sessions: their folder, their names, who may use them."""

from __future__ import annotations

import fcntl
import os
import re
import socket
import stat
import struct
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

#: Longest path that fits into a Unix socket's address.
MAX_PATH = 107
#: Consoles and programs that may wait to be let in.
BACKLOG = 128
#: How long a session waits for others that start at the same moment, in seconds.
START_WAIT_S = 10.0
#: `..._S07.jsonl`, its segments and doubles `..._S07-2.samples.jsonl`.
_SESSION = re.compile(r"_S(\d{1,6})(?:[.-]|$)")


class SessionSocketError(OSError):
    """The socket cannot be there; the text says why and what to do."""


def folder() -> Path:
    """The user's folder for sockets: `$XDG_RUNTIME_DIR/woz`, else `/tmp/woz-<uid>`.

    Made with mode 0700 if missing. Raises `SessionSocketError` if it belongs to somebody else, or
    if there is something else in its place.
    """
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    if runtime and Path(runtime).is_dir() and os.access(runtime, os.W_OK):
        place = Path(runtime) / "woz"
    else:
        place = Path("/tmp") / f"woz-{os.getuid()}"
    with suppress(FileExistsError):  # a file or a link, which is told below
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
    status = place.lstat()
    if not stat.S_ISDIR(status.st_mode):
        raise SessionSocketError(
            f"{place} is not a folder, but sessions need a folder there: remove it, or set"
            " XDG_RUNTIME_DIR to another folder"
        )
    if status.st_uid != os.getuid():
        raise SessionSocketError(
            f"{place} belongs to another user; remove it or set XDG_RUNTIME_DIR"
        )
    if stat.S_IMODE(status.st_mode) & 0o077:
        place.chmod(0o700)
    return place


def socket_path(name: str) -> Path:
    """The socket of the session called `name`; `$WOZ_SOCKET` overrides it.

    Raises `SessionSocketError` if nothing can be called so, or the path is too long.
    """
    if not name.isprintable() or "/" in name or name.startswith(".") or not name:
        raise SessionSocketError(
            f"a session cannot be called {name!r}: its name is one of a file, without / and without"
            " a dot in front, such as S07"
        )
    override = os.environ.get("WOZ_SOCKET", "")
    path = Path(override) if override else folder() / f"{name}.sock"
    if len(os.fsencode(path)) > MAX_PATH:
        raise SessionSocketError(
            f"{path} is too long for a socket; set WOZ_SOCKET to a shorter path"
        )
    return path


def answers(path: Path) -> bool:
    """Whether a robot process listens there."""
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as probe:
            probe.settimeout(0.5)
            probe.connect(str(path))
    except BlockingIOError:  # so many are waiting that the next one is turned away
        return True
    except OSError:
        return False
    return True


def inode(path: Path) -> tuple[int, int] | None:
    """What tells the file at `path` from any other; None if there is none."""
    try:
        status = path.lstat()
    except OSError:
        return None
    return status.st_dev, status.st_ino


def running() -> list[Path]:
    """Sockets of all sessions of this user that answer, newest first."""
    override = os.environ.get("WOZ_SOCKET", "")
    candidates = [Path(override)] if override else list(folder().glob("*.sock"))
    living = [(_made(path), path) for path in candidates if answers(path)]
    return [path for _, path in sorted(living, reverse=True)]


def age_s(path: Path) -> float:
    """Seconds since the session at this socket began."""
    return max(0.0, time.time() - _made(path))


def _made(path: Path) -> float:
    """When the file was made; long ago, if it has gone meanwhile."""
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0


@contextmanager
def starting() -> Iterator[None]:
    """Let only one session of this user at a time choose its code, its socket and its files.

    Who cannot wait any longer, or has no folder for the lock, goes on without: at worst the start
    is refused because the socket is in use.
    """
    lock = -1
    with suppress(OSError):
        lock = os.open(folder() / "starting.lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        until = time.monotonic() + START_WAIT_S
        while lock >= 0 and time.monotonic() < until:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except OSError:
                time.sleep(0.01)
        yield
    finally:
        if lock >= 0:
            os.close(lock)


def next_session(recordings: Path, sockets: Iterable[Path] = ()) -> str:
    """`S` and one more than the highest number among the logs and the sockets in use."""
    logs = recordings.glob("*.jsonl") if recordings.is_dir() else ()
    names = [*(path.name for path in logs), *(f"_{path.stem}" for path in sockets)]
    numbers = [int(match.group(1)) for name in names if (match := _SESSION.search(name))]
    return f"S{max(numbers, default=0) + 1:02d}"


def bind(path: Path) -> socket.socket:
    """A listening socket with mode 0600; a dead one's leftover is replaced.

    Raises `SessionSocketError` if a living robot process has it, if it is no socket, or if its
    folder is not there and cannot be made.
    """
    try:
        path.parent.mkdir(mode=0o700, exist_ok=True)
    except OSError as error:
        raise SessionSocketError(
            f"cannot create the folder {path.parent}: {error.strerror}; create it, or set"
            " WOZ_SOCKET elsewhere"
        ) from error
    if inode(path) is not None:
        if not path.is_socket():
            raise SessionSocketError(
                f"{path} exists and is not a socket; remove it, or set WOZ_SOCKET to another path"
            )
        if answers(path):
            raise SessionSocketError(
                f"session {path.stem} is running ({path}); join it with `woz attach"
                f" {path.stem}`, or"
                " choose another --session"
            )
        path.unlink()
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        listener.bind(str(path))
        path.chmod(0o600)  # nobody can connect before it listens
        listener.listen(BACKLOG)
    except OSError as error:
        listener.close()
        raise SessionSocketError(f"cannot create the socket {path}: {error.strerror}") from error
    listener.setblocking(False)
    return listener


def peer_uid(connection: socket.socket) -> int:
    """User id of the process at the other end."""
    return _peer(connection)[1]


def peer_pid(connection: socket.socket) -> int:
    """Process id of the process at the other end."""
    return _peer(connection)[0]


def _peer(connection: socket.socket) -> tuple[int, int, int]:
    """Its process id, user id and group id."""
    packed = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12)
    process, user, group = struct.unpack("=iII", packed)
    return process, user, group
