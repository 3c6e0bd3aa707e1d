"""One serial device on asyncio, and why a serial port cannot be opened."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import stat
import termios
from collections.abc import Callable
from pathlib import Path

import serial

from woz_drivers.lines.device_line import POLL_S, DeviceLine
from woz_tui.drivers.contract import DeviceLostError

#: Names that stay the same whichever socket and in whichever order devices are plugged in.
BY_ID = Path("/dev/serial/by-id")
#: All the ways in which pyserial says that the device is not there (any more).
LOSSES = (OSError, serial.SerialException, termios.error)


class SerialLine(DeviceLine):
    """A serial port that is kept open."""

    def __init__(
        self,
        port: str,
        baud: int,
        *,
        on_open: Callable[[], None],
        on_bytes: Callable[[bytes], None],
        on_trouble: Callable[[DeviceLostError], None],
        poll_s: float = POLL_S,
    ) -> None:
        super().__init__(
            port, on_open=on_open, on_bytes=on_bytes, on_trouble=on_trouble, poll_s=poll_s
        )
        self._baud = baud
        self._serial: serial.Serial | None = None

    async def _open(self) -> int:
        try:
            self._serial = open_port(self.path, self._baud)
        except (*LOSSES, ValueError) as error:
            raise await asyncio.to_thread(
                explain_port_error, self.path, self._baud, error
            ) from error
        return int(self._serial.fileno())

    def _close(self, fd: int) -> None:
        assert self._serial is not None
        with contextlib.suppress(*LOSSES):
            self._serial.close()


def open_port(port: str, baud: int) -> serial.Serial:
    """Open `port` for this process alone, without ever waiting on it.

    Raises one of `LOSSES`, or ValueError for a rate that the port does not know.
    """
    return serial.Serial(port, baud, timeout=0, exclusive=True)


def explain_port_error(
    port: str, baud: int, error: Exception, by_id: Path = BY_ID
) -> DeviceLostError:
    """Why `port` could not be opened, and what to do; `by_id` is where the system lists ports."""
    match getattr(error, "errno", None):
        case errno.ENOENT | errno.ENXIO | errno.ENODEV:
            return DeviceLostError(
                f"{port} is not there", f"plug the adapter in; {_present(by_id)}"
            )
        case errno.EACCES | errno.EPERM:
            return DeviceLostError(
                f"no permission to open {port}",
                f"sudo usermod -aG {_group(port)} $USER, then log out and in again",
            )
        case errno.EBUSY | errno.EAGAIN:
            return _occupied(port)
    if isinstance(error, ValueError):
        return DeviceLostError(
            f"{port} cannot run at {baud} baud", "set the rate the device is built for"
        )
    if _is_no_terminal(port):
        return DeviceLostError(f"{port} is not a serial port", _present(by_id))
    return DeviceLostError(f"{port} cannot be opened: {reason_of(error)}", _present(by_id))


def _occupied(port: str) -> DeviceLostError:
    others = holders(port)
    if others:
        return DeviceLostError(f"{port} is in use by {', '.join(others)}", "end the other program")
    return DeviceLostError(
        f"{port} is in use by another program",
        f"end it; see which one with: sudo fuser -v {port} (ModemManager is a frequent one:"
        " sudo systemctl disable --now ModemManager)",
    )


def holders(port: str) -> list[str]:
    """Programs that hold the device open, as `name (pid)`; only those this user may look at."""
    target = str(Path(port).resolve())
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if any(_leads_to(link, target) for link in (process / "fd").iterdir()):
                name = (process / "comm").read_text("utf-8", "replace").strip()
                found.append(f"{name} ({process.name})")
    return found


def _leads_to(link: Path, target: str) -> bool:
    """False, too, for what the program has closed meanwhile."""
    with contextlib.suppress(OSError):
        return str(link.readlink()) == target
    return False


def reason_of(error: Exception) -> str:
    """The sentence inside an exception of pyserial, termios or the system."""
    if isinstance(error, termios.error) and len(error.args) == 2:
        return str(error.args[1])
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    return str(error) or type(error).__name__


def present_ports(by_id: Path = BY_ID) -> list[str]:
    """Paths of the serial devices that are plugged in now, by their lasting names if they have
    any.
    """
    with contextlib.suppress(OSError):
        return sorted(str(entry) for entry in by_id.iterdir())
    usual = ("ttyUSB*", "ttyACM*")
    return sorted(str(path) for kind in usual for path in Path("/dev").glob(kind))


def _present(by_id: Path) -> str:
    ports = present_ports(by_id)
    if not ports:
        return "no serial device is plugged in now"
    return "plugged in now: " + ", ".join(ports)


def _group(port: str) -> str:
    """The group that may open `port`; Debian's is dialout."""
    import grp  # noqa: PLC0415 - only needed to word this one error

    with contextlib.suppress(OSError, KeyError):
        name = grp.getgrgid(Path(port).stat().st_gid).gr_name
        if name != "root":
            return name
    return "dialout"


def _is_no_terminal(port: str) -> bool:
    with contextlib.suppress(OSError):
        return not stat.S_ISCHR(Path(port).stat().st_mode)
    return False
