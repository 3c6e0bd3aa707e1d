"""One serial device on asyncio: waits for its port, reads it, notices the loss, opens it again.

The port's file descriptor is watched by the event loop itself (`loop.add_reader`): a quarter of
the round trip of a reading thread, and no second thread to end.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import os
import stat
import termios
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import serial

from woz_tui.drivers.contract import DeviceLostError

#: A missing or occupied port is tried again this often, in seconds.
POLL_S = 0.5
#: Names that stay the same whichever socket and in whichever order devices are plugged in.
BY_ID = Path("/dev/serial/by-id")
#: More unsent bytes than this mean that nobody is reading at the other end.
MAX_UNSENT = 1 << 16

_READ_SIZE = 4096
#: All the ways in which pyserial says that the device is not there (any more).
LOSSES = (OSError, serial.SerialException, termios.error)


@dataclass(frozen=True, slots=True)
class PortTrouble:
    """Why a port is not open, and what to do about it."""

    what: str
    remedy: str


class SerialLine:
    """Keeps one port open for as long as it exists; all callbacks run in the event loop.

    `on_open()` comes before the first bytes of each connection, `on_bytes(data)` with every
    piece that arrives, `on_trouble(trouble)` when the port cannot be opened or is lost (and again
    whenever the reason changes).
    """

    def __init__(
        self,
        port: str,
        baud: int,
        *,
        on_open: Callable[[], None],
        on_bytes: Callable[[bytes], None],
        on_trouble: Callable[[PortTrouble], None],
        poll_s: float = POLL_S,
    ) -> None:
        self.port = port
        self._baud = baud
        self._on_open = on_open
        self._on_bytes = on_bytes
        self._on_trouble = on_trouble
        self._poll_s = poll_s
        self._serial: serial.Serial | None = None
        self._trouble: PortTrouble | None = None
        self._unsent = bytearray()
        self._gone = asyncio.Event()
        self._task: asyncio.Task[None] | None = None

    @property
    def connected(self) -> bool:
        """Whether the port is open."""
        return self._serial is not None

    def start(self) -> None:
        """Begin to look for the port; returns at once. Needs a running event loop."""
        self._task = asyncio.create_task(self._keep_open())

    async def close(self) -> None:
        """Stop looking and let go of the port."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
            self._task = None
        self._detach()

    def write(self, data: bytes) -> None:
        """Send `data`, in order, without waiting. Raises `DeviceLostError` if the port is not open
        or the device has stopped reading.
        """
        self._need_port()
        if len(self._unsent) + len(data) > MAX_UNSENT:
            raise DeviceLostError(
                f"{self.port} accepts no more data: {len(self._unsent)} bytes are waiting",
                "check the flow control and whether the device's firmware runs",
            )
        self._unsent += data
        self._send()
        self._need_port()

    def _need_port(self) -> None:
        if self._serial is not None:
            return
        if self._trouble is None:
            raise DeviceLostError(f"{self.port} is not open yet")
        raise DeviceLostError(self._trouble.what, self._trouble.remedy)

    # -- opening and losing --------------------------------------------------------------------

    async def _keep_open(self) -> None:
        while True:
            try:
                opened = open_port(self.port, self._baud)
            except (*LOSSES, ValueError) as error:
                self._tell(
                    await asyncio.to_thread(explain_port_error, self.port, self._baud, error)
                )
            else:
                self._attach(opened)
                await self._gone.wait()
            await asyncio.sleep(self._poll_s)

    def _attach(self, opened: serial.Serial) -> None:
        self._serial = opened
        self._trouble = None
        self._gone.clear()
        asyncio.get_running_loop().add_reader(opened.fileno(), self._read)
        self._on_open()

    def _lose(self, reason: str) -> None:
        self._detach()
        self._tell(
            PortTrouble(
                f"{self.port} was lost: {reason}",
                "plug it in again; it is connected again by itself",
            )
        )
        self._gone.set()

    def _detach(self) -> None:
        port, self._serial = self._serial, None
        self._unsent.clear()
        if port is None:
            return
        loop = asyncio.get_running_loop()
        with contextlib.suppress(*LOSSES):
            loop.remove_reader(port.fileno())
            loop.remove_writer(port.fileno())
        with contextlib.suppress(*LOSSES):
            port.close()

    def _tell(self, trouble: PortTrouble) -> None:
        if trouble != self._trouble:
            self._trouble = trouble
            self._on_trouble(trouble)

    # -- bytes ---------------------------------------------------------------------------------

    def _read(self) -> None:
        port = self._serial
        if port is None:
            return
        try:
            data = port.read(_READ_SIZE)
        except LOSSES as error:
            self._lose(reason_of(error))
            return
        if not data:
            self._lose("it delivers no more data")
            return
        self._on_bytes(data)

    def _send(self) -> None:
        port = self._serial
        if port is None or not self._unsent:
            return
        loop = asyncio.get_running_loop()
        try:
            written = os.write(port.fileno(), self._unsent)
        except (BlockingIOError, InterruptedError):
            written = 0
        except LOSSES as error:
            self._lose(reason_of(error))
            return
        del self._unsent[:written]
        if self._unsent:
            loop.add_writer(port.fileno(), self._send)
        else:
            loop.remove_writer(port.fileno())


def open_port(port: str, baud: int) -> serial.Serial:
    """Open `port` for this process alone, without ever waiting on it.

    Raises one of `LOSSES`, or ValueError for a rate that the port does not know.
    """
    return serial.Serial(port, baud, timeout=0, exclusive=True)


def explain_port_error(port: str, baud: int, error: Exception, by_id: Path = BY_ID) -> PortTrouble:
    """Why `port` could not be opened, and what to do; `by_id` is where the system lists ports."""
    match getattr(error, "errno", None):
        case errno.ENOENT | errno.ENXIO | errno.ENODEV:
            return PortTrouble(f"{port} is not there", f"plug the adapter in; {_present(by_id)}")
        case errno.EACCES | errno.EPERM:
            return PortTrouble(
                f"no permission to open {port}",
                f"sudo usermod -aG {_group(port)} $USER, then log out and in again",
            )
        case errno.EBUSY | errno.EAGAIN:
            return _occupied(port)
    if isinstance(error, ValueError):
        return PortTrouble(
            f"{port} cannot run at {baud} baud", "set the rate the device is built for"
        )
    if _is_no_terminal(port):
        return PortTrouble(f"{port} is not a serial port", _present(by_id))
    return PortTrouble(f"{port} cannot be opened: {reason_of(error)}", _present(by_id))


def _occupied(port: str) -> PortTrouble:
    others = holders(port)
    if others:
        return PortTrouble(f"{port} is in use by {', '.join(others)}", "end the other program")
    return PortTrouble(
        f"{port} is in use by another program",
        f"end it; see which one with: sudo fuser -v {port} (ModemManager is a frequent one:"
        " sudo systemctl disable --now ModemManager)",
    )


def holders(port: str) -> list[str]:
    """Programs that hold the device open, as `name (pid)`; only those this user may look at."""
    target = str(Path(port).resolve())
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if any(str(link.readlink()) == target for link in (process / "fd").iterdir()):
                name = (process / "comm").read_text("utf-8", "replace").strip()
                found.append(f"{name} ({process.name})")
        except OSError:
            continue
    return found


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
