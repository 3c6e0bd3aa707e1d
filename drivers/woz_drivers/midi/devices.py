"""Which MIDI devices there are, and how to open one and keep it open.

ALSA gives every MIDI port a character device, /dev/snd/midiC<card>D<device>, from which raw bytes
are read and to which they are written; nothing else is needed. Source: ALSA's RawMidi interface,
kernel documentation "sound/designs/midi-2.0" and alsa-lib's rawmidi reference.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import os
import re
import stat
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from woz_drivers.lines.device_line import DeviceLine
from woz_tui.drivers.contract import DeviceLostError

DEV, PROC = Path("/dev/snd"), Path("/proc/asound")
_NODE = re.compile(r"midiC(\d+)D(\d+)")
#: ` 1 [nanoKONTROL2   ]: USB-Audio - nanoKONTROL2`
_CARD = re.compile(r"^\s*(\d+) \[(.*?)\s*\]: \S+ - (.*)$", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class MidiDevice:
    """A MIDI port of a sound card."""

    path: str
    card: str
    name: str

    def called(self, wanted: str) -> bool:
        """Whether `wanted` is its card's short name, or a part of the long one."""
        word = wanted.casefold()
        return word == self.card.casefold() or word in self.name.casefold()


def present_devices(dev: Path = DEV, proc: Path = PROC) -> list[MidiDevice]:
    """The devices that are plugged in now, in the order of their cards."""
    try:
        cards = {
            number: (card, name.strip())
            for number, card, name in _CARD.findall((proc / "cards").read_text("utf-8", "replace"))
        }
        nodes = [(match, node) for node in dev.iterdir() if (match := _NODE.fullmatch(node.name))]
    except OSError:
        return []
    nodes.sort(key=lambda found: (int(found[0][1]), int(found[0][2])))
    return [
        MidiDevice(str(node), *cards.get(match[1], (f"card {match[1]}", "")))
        for match, node in nodes
    ]


def is_path(wanted: str) -> bool:
    """Whether a device is named by its path and not by its card."""
    return "/" in wanted


def paths_of(wanted: str, folder: Path, dev: Path = DEV, proc: Path = PROC) -> list[str]:
    """The paths of devices that are `wanted`: a path, relative to `folder`, a card's name, or
    nothing for any; the best first. Raises `DeviceLostError` if there is none.
    """
    if is_path(wanted):
        return [str(folder / Path(wanted).expanduser())]
    devices = present_devices(dev, proc)
    fitting = [device for device in devices if not wanted or device.called(wanted)]
    if fitting:
        fitting.sort(key=lambda device: device.card.casefold() != wanted.casefold())
        return [device.path for device in fitting]
    missing = f"no MIDI device is called {wanted!r}" if wanted else "no MIDI device is there"
    raise DeviceLostError(missing, f"plug the panel in; {device_list(devices)}")


def open_one(
    wanted: str, folder: Path, dev: Path = DEV, proc: Path = PROC
) -> tuple[str, int, bool]:
    """Open the first device that is `wanted` and free: two panels of one make have one name.

    Its path, and what `open_device` returns. Raises `DeviceLostError`.
    """
    refused: DeviceLostError | None = None
    for path in paths_of(wanted, folder, dev, proc):
        try:
            return path, *open_device(path)
        except DeviceLostError as error:
            refused = refused or error
    raise refused or DeviceLostError("no MIDI device is there")


def device_list(devices: list[MidiDevice]) -> str:
    """What is plugged in, as the end of a sentence."""
    if not devices:
        return "no MIDI device is plugged in now"
    return "plugged in now: " + ", ".join(f"{it.card} ({it.path})" for it in devices)


def open_device(path: str) -> tuple[int, bool]:
    """A descriptor that never blocks, and whether it can be written to. Raises `DeviceLostError`.

    From a FIFO or a plain file, a recording for instance, is only read.
    """
    flags = os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC
    try:
        if stat.S_ISCHR(Path(path).stat().st_mode):
            try:
                return os.open(path, os.O_RDWR | flags), True
            except OSError as error:
                if error.errno not in (errno.EACCES, errno.EPERM, errno.EROFS):
                    raise
        return os.open(path, os.O_RDONLY | flags), False
    except (OSError, ValueError) as error:
        raise open_error(path, error) from error


def open_error(path: str, error: Exception) -> DeviceLostError:
    """Why `path` could not be opened, and what to do."""
    match getattr(error, "errno", None):
        case errno.ENOENT | errno.ENXIO | errno.ENODEV | errno.EIO:
            return DeviceLostError(
                f"{path} is not there", f"plug the panel in; {device_list(present_devices())}"
            )
        case errno.EACCES | errno.EPERM:
            return DeviceLostError(
                f"no permission to open {path}",
                "sudo usermod -aG audio $USER, then log out and in again",
            )
        case errno.EBUSY | errno.EAGAIN:
            return DeviceLostError(f"{path} is in use by another program", "end the other program")
    reason = getattr(error, "strerror", None) or str(error)
    return DeviceLostError(f"{path} cannot be opened: {reason}", device_list(present_devices()))


# -- one device, kept open ------------------------------------------------------------------------

#: How often a plain file is looked at for more, in seconds: no event tells that it has grown.
_FILE_S = 0.02


class MidiPort(DeviceLine):
    """The first device that is `wanted` (see `paths_of`) and free; relative paths start at
    `folder`. `path` is the one that was opened last.
    """

    def __init__(
        self,
        wanted: str,
        folder: Path,
        *,
        on_open: Callable[[], None],
        on_bytes: Callable[[bytes], None],
        on_trouble: Callable[[DeviceLostError], None],
    ) -> None:
        super().__init__(
            wanted, on_open=on_open, on_bytes=on_bytes, on_trouble=on_trouble, most_unsent=4096
        )
        self._wanted = wanted
        self._folder = folder
        self._writable = False
        self._file_timer: asyncio.TimerHandle | None = None

    @property
    def ready(self) -> bool:
        """Whether it takes bytes now: it can be written to and has taken all before."""
        return self.connected and self._writable and not self._unsent

    async def close(self, farewell: bytes = b"") -> None:
        """Stop looking, send `farewell` if there is somebody to hear it, let go."""
        if farewell and self.ready:
            self.write(farewell)
        await super().close()

    def write(self, data: bytes) -> None:
        """Send `data` as the device takes it; nothing if it cannot be written to."""
        if self._writable:
            with contextlib.suppress(DeviceLostError):
                super().write(data)

    async def _open(self) -> int:
        self.path, fd, self._writable = open_one(self._wanted, self._folder)
        return fd

    def _watch(self, fd: int) -> None:
        if stat.S_ISREG(os.fstat(fd).st_mode):
            self._file_timer = asyncio.get_running_loop().call_later(0, self._read_file)
            return
        try:
            super()._watch(fd)
        except OSError:  # a folder, /dev/null: nothing that ever becomes readable
            os.close(fd)
            raise DeviceLostError(
                f"{self.path} is no MIDI device", "name a card, or a path under /dev/snd"
            ) from None

    def _read_file(self) -> None:
        self._file_timer = asyncio.get_running_loop().call_later(_FILE_S, self._read_file)
        self._read(end_is_loss=os.fstat(self._fd).st_nlink == 0)

    def _close(self, fd: int) -> None:
        if self._file_timer is not None:
            self._file_timer.cancel()
        super()._close(fd)
