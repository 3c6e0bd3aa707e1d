"""Where the sockets of running sessions are, and who may use them."""

from __future__ import annotations

import os
import socket
import stat
from pathlib import Path

#: Longest path that fits into a Unix socket's address.
MAX_PATH = 107


class PlaceError(OSError):
    """The socket cannot be there; the text says why and what to do."""


def folder() -> Path:
    """The user's folder for sockets: `$XDG_RUNTIME_DIR/woz`, else `/tmp/woz-<uid>`.

    Made with mode 0700 if missing. Raises `PlaceError` if it belongs to somebody else.
    """
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    if runtime and Path(runtime).is_dir() and os.access(runtime, os.W_OK):
        place = Path(runtime) / "woz"
    else:
        place = Path("/tmp") / f"woz-{os.getuid()}"
    place.mkdir(mode=0o700, parents=True, exist_ok=True)
    status = place.lstat()
    if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid():
        raise PlaceError(f"{place} is not yours; remove it or set XDG_RUNTIME_DIR")
    if stat.S_IMODE(status.st_mode) & 0o077:
        place.chmod(0o700)
    return place


def socket_path(name: str) -> Path:
    """The socket of the session called `name`; `$WOZ_SOCKET` overrides it."""
    override = os.environ.get("WOZ_SOCKET", "")
    path = Path(override) if override else folder() / f"{name}.sock"
    if len(os.fsencode(path)) > MAX_PATH:
        raise PlaceError(f"{path} is too long for a socket; set WOZ_SOCKET to a shorter path")
    return path


def answers(path: Path) -> bool:
    """Whether a robot process listens there."""
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as probe:
            probe.settimeout(0.5)
            probe.connect(str(path))
    except OSError:
        return False
    return True


def running() -> list[Path]:
    """Sockets of all sessions of this user that answer, newest first."""
    override = os.environ.get("WOZ_SOCKET", "")
    candidates = [Path(override)] if override else list(folder().glob("*.sock"))
    living = [path for path in candidates if answers(path)]
    return sorted(living, key=lambda path: path.stat().st_mtime, reverse=True)


def bind(path: Path) -> socket.socket:
    """A listening socket with mode 0600; a dead one's leftover is replaced.

    Raises `PlaceError` if a living robot process has it.
    """
    if path.exists():
        if answers(path):
            raise PlaceError(
                f"a robot process already listens at {path}; `woz attach` joins it, or choose"
                " another --session"
            )
        path.unlink()
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    mask = os.umask(0o177)
    try:
        listener.bind(str(path))
    except OSError as error:
        listener.close()
        raise PlaceError(f"no socket at {path}: {error.strerror}") from error
    finally:
        os.umask(mask)
    listener.listen(16)
    listener.setblocking(False)
    return listener


def peer_uid(connection: socket.socket) -> int:
    """User id of the process at the other end."""
    credentials = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12)
    return int.from_bytes(credentials[4:8], "little")
