"""Checks of the machine: clocks, processor, serial ports, the disk that takes the recordings.

`bounded` keeps a check from hanging or raising, however broken the machine is.
"""

from __future__ import annotations

import ctypes
import grp
import os
import platform
import pwd
import shutil
import statistics
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable
from datetime import UTC, datetime
from pathlib import Path

from woz_tui.drivers.contract import Finding
from woz_tui.machine.program_output import output_of
from woz_tui.protocol.sentence import Sentence

Check = Callable[[], Iterable[Finding] | Finding]
#: What the findings are about that the preflight has, too.
_DATE = Sentence("preflight.date", "date")
_DISK = Sentence("preflight.disk", "disk")


def bounded(subject: str, check: Check, seconds: float = 5.0) -> list[Finding]:
    """What `check` finds, or one error that it raised or took longer than `seconds`.

    It runs in a thread of its own, which is left behind if it hangs (a dead network disk cannot be
    interrupted) and does not keep the process from ending.
    """
    found: list[Finding] = []
    failed: list[BaseException] = []

    def run() -> None:
        try:
            result = check()
            found.extend([result] if isinstance(result, Finding) else result)
        except BaseException as error:  # noqa: BLE001 - told as a finding
            failed.append(error)

    thread = threading.Thread(target=run, name=f"check {subject}", daemon=True)
    thread.start()
    thread.join(seconds)
    if thread.is_alive():
        return [Finding("error", subject, f"no answer within {seconds:g} s")]
    if failed:
        what = f"{type(failed[0]).__name__}: {failed[0]}"
        return [Finding("error", subject, f"cannot be checked: {what}")]
    return found


#: Clocks of machines without a battery begin in 1970 or at their image's date.
FIRST_YEAR = 2025
LAST_YEAR = 2100

_STA_UNSYNC = 0x0040
_SET_NTP = "sudo timedatectl set-ntp true"


class _Timex(ctypes.Structure):
    """The head of `struct timex` (adjtimex(2)); the kernel writes 208 bytes at most."""

    _fields_ = [
        ("modes", ctypes.c_uint),
        ("offset", ctypes.c_long),
        ("freq", ctypes.c_long),
        ("maxerror", ctypes.c_long),
        ("esterror", ctypes.c_long),
        ("status", ctypes.c_int),
        ("rest", ctypes.c_byte * 256),
    ]


def calendar(now: datetime) -> Finding:
    """Whether the wall clock shows a year that can be true."""
    text = f"{now.astimezone(UTC):%Y-%m-%d %H:%M} UTC"
    if FIRST_YEAR <= now.year < LAST_YEAR:
        return Finding("ok", _DATE, text)
    remedy = Sentence("preflight.set_clock", "set the clock: {command}", command=_SET_NTP)
    return Finding("error", _DATE, text, remedy)


def synchronised() -> Finding:
    """Whether a time server keeps the wall clock right, as kernel or systemd see it."""
    synced = _kernel_synced()
    if synced is None:
        answer = output_of(["timedatectl", "show", "--property=NTPSynchronized", "--value"])
        synced = {"yes": True, "no": False}.get(answer or "")
    if synced is None:
        return Finding("info", "time server", "neither the kernel nor timedatectl reports it")
    if synced:
        return Finding("ok", "time server", "the clock is synchronised")
    text = "the clock is not synchronised: logs of several machines will have different times"
    return Finding("warning", "time server", text, _SET_NTP)


def _kernel_synced() -> bool | None:
    """Reads the kernel's clock status; None where that is forbidden (some containers)."""
    try:
        libc = ctypes.CDLL(None, use_errno=True)
        timex = _Timex(modes=0)
        state: int = libc.adjtimex(ctypes.byref(timex))
    except (OSError, AttributeError):
        return None
    return None if state < 0 else not timex.status & _STA_UNSYNC


def monotonic_clock() -> Finding:
    """Whether times can be told apart to the microsecond."""
    resolution = time.clock_getres(time.CLOCK_MONOTONIC)
    text = f"{resolution * 1e9:.0f} ns steps"
    if resolution <= 1e-6:
        return Finding("ok", "timing", text)
    remedy = "the kernel has no high-resolution timers; use another kernel"
    return Finding("warning", "timing", f"{text} on {os.uname().release}", remedy)


CPUS = Path("/sys/devices/system/cpu")

#: Bits of `vcgencmd get_throttled` (Raspberry Pi documentation); 16 higher: since the last start.
_THROTTLED = {
    0: "under-voltage",
    1: "frequency capped",
    2: "throttled",
    3: "soft temperature limit",
}
#: Drivers whose governor "powersave" still goes to full speed under load.
_SELF_GOVERNING = ("intel_pstate", "amd-pstate", "amd-pstate-epp")


def python_version() -> Finding:
    """Which Python this is; anything that could start this is new enough."""
    return Finding("ok", "python", f"{platform.python_version()} on {platform.machine()}")


def governor(cpus: Path = CPUS) -> list[Finding]:
    """How the processor's frequency is chosen; empty where the machine does not say."""
    governors: Counter[str] = Counter()
    slow = 0
    for file in cpus.glob("cpu[0-9]*/cpufreq/scaling_governor"):
        name = _word(file)
        governors[name] += 1
        driver = _word(file.with_name("scaling_driver"))
        slow += name == "powersave" and driver not in _SELF_GOVERNING
    if not governors:
        return []
    text = ", ".join(f"{name} on {count} cores" for name, count in sorted(governors.items()))
    if not slow:
        return [Finding("ok", "processor", text)]
    remedy = f"echo ondemand | sudo tee {cpus}/cpu*/cpufreq/scaling_governor"
    return [Finding("warning", "processor", f"{text}: never runs at full speed", remedy)]


def _word(file: Path) -> str:
    try:
        return file.read_text().strip()
    except OSError:
        return ""


def throttling() -> list[Finding]:
    """Whether a Raspberry Pi's firmware slows it down; empty on other machines."""
    answer = output_of(["vcgencmd", "get_throttled"])
    return [] if answer is None else read_throttling(answer)


def read_throttling(answer: str) -> list[Finding]:
    """What the firmware's answer (`throttled=0x50005`) means."""
    try:
        flags = int(answer.partition("=")[2], 16)
    except ValueError:
        return [Finding("info", "power", f"vcgencmd says {answer!r}")]
    now = [what for bit, what in _THROTTLED.items() if flags >> bit & 1]
    past = [what for bit, what in _THROTTLED.items() if flags >> (bit + 16) & 1]
    remedy = "use the official power supply and a short cable; cool the board"
    if now:
        return [Finding("error", "power", f"right now: {', '.join(now)}", remedy)]
    if past:
        return [Finding("warning", "power", f"since the last start: {', '.join(past)}", remedy)]
    return [Finding("ok", "power", "never throttled since the last start")]


#: The group that owns serial ports on Debian and its children.
GROUP = "dialout"
DEV = Path("/dev")
#: Writing to the disk is measured for so long at most, in seconds.
SYNC_S = 2.0
USB_SERIAL = Path("/sys/bus/usb-serial/devices")

_UDEV_RULE = 'ACTION=="add", SUBSYSTEM=="usb-serial", DRIVER=="ftdi_sio", ATTR{latency_timer}="1"'


def serial_ports(dev: Path = DEV) -> list[Finding]:
    """One finding for each adapter under `/dev/serial/by-id`."""
    links = sorted((dev / "serial" / "by-id").glob("*"))
    if not links:
        return [Finding("info", "serial ports", "no USB serial adapter is plugged in")]
    return [_port(link) for link in links]


def _port(link: Path) -> Finding:
    target = link.resolve()
    if not target.exists():
        return Finding(
            "warning", link.name, f"points to {target}, which does not exist", "plug it in again"
        )
    if not os.access(target, os.R_OK | os.W_OK):
        return Finding(
            "error", link.name, f"you have no permission to open {target}", _join_group()
        )
    return Finding("ok", link.name, str(target))


def serial_group() -> list[Finding]:
    """Whether this login may open serial ports."""
    try:
        group = grp.getgrnam(GROUP)
    except KeyError:
        return [Finding("info", "serial access", f"this system has no group {GROUP}")]
    if os.geteuid() == 0:
        return [Finding("ok", "serial access", "root can open every port")]
    if group.gr_gid in {os.getegid(), *os.getgroups()}:
        return [Finding("ok", "serial access", f"you are in the group {GROUP}")]
    if _user() in group.gr_mem:
        text = f"you are in the group {GROUP}, but you logged in before you were added"
        return [Finding("warning", "serial access", text, "log out and in again")]
    text = f"you are not in the group {GROUP}: serial ports will refuse you"
    return [Finding("warning", "serial access", text, _join_group())]


def _join_group() -> str:
    return f"sudo adduser {_user()} {GROUP}, then log out and in again"


def _user() -> str:
    try:
        return pwd.getpwuid(os.getuid()).pw_name
    except KeyError:
        return str(os.getuid())


def latency_timers(usb_serial: Path = USB_SERIAL) -> list[Finding]:
    """How long each FTDI adapter holds bytes back, in milliseconds; 16 unless somebody set it.

    A control loop waits for at least one such period a turn (FTDI AN232B-04).
    """
    findings = []
    for timer in sorted(usb_serial.glob("*/latency_timer")):
        port = timer.parent.name
        try:
            milliseconds = int(timer.read_text())
        except (OSError, ValueError):
            continue
        subject = f"latency of {port}"
        if milliseconds <= 1:
            findings.append(Finding("ok", subject, f"{milliseconds} ms"))
        else:
            text = f"{milliseconds} ms: at most {1000 // milliseconds} reads a second"
            remedy = f"echo 1 | sudo tee {timer}; for good, a udev rule: {_UDEV_RULE}"
            findings.append(Finding("warning", subject, text, remedy))
    return findings


#: Less free room than this is an error, less than ten times a warning (bytes).
LEAST_FREE = 50_000_000
#: Syncs slower than these make the recorder warn, and raise its alarm (seconds).
SLOW_SYNC = 0.25
ALARMING_SYNC = 1.0
#: A block as the recorder writes it when much happens at once (bytes).
BLOCK = 4096


def free_space(folder: Path) -> Finding:
    """How much room is left where `folder` is or will be."""
    try:
        free = shutil.disk_usage(nearest(folder)).free
    except OSError as error:
        text = Sentence(
            "session.unreadable",
            "{path} cannot be read: {strerror}",
            path=folder,
            strerror=error.strerror,
        )
        return Finding("error", _DISK, text)
    text = Sentence(
        "preflight.free", "{free:.1f} GB free for {folder}", free=free / 1e9, folder=folder
    )
    if free < LEAST_FREE:
        remedy = Sentence("preflight.room_before", "make room before the session")
        return Finding("error", _DISK, text, remedy)
    if free < 10 * LEAST_FREE:
        return Finding("warning", _DISK, text, Sentence("preflight.room_soon", "make room soon"))
    return Finding("ok", _DISK, text)


def sync_time(folder: Path, writes: int = 20) -> Finding:
    """How long a written line takes until it is safe: `fdatasync` of up to `writes` blocks.

    Ends after `SYNC_S`, if there was one measurement by then. Leaves nothing behind.
    """
    place = nearest(folder)
    try:
        times = _measure(place, writes)
    except OSError as error:
        remedy = "choose another folder with --recordings, or change its rights"
        return Finding(
            "error", "recordings", f"{place} cannot be written to: {error.strerror}", remedy
        )
    worst = max(times)
    text = (
        f"written to disk in {statistics.median(times) * 1e3:.1f} ms, at worst {worst * 1e3:.1f} ms"
    )
    if worst < SLOW_SYNC:
        return Finding("ok", "recordings", text)
    remedy = "record to a faster disk (--recordings); old SD cards and network folders are too slow"
    return Finding("error" if worst >= ALARMING_SYNC else "warning", "recordings", text, remedy)


def _measure(folder: Path, writes: int) -> list[float]:
    times: list[float] = []
    until = time.monotonic() + SYNC_S
    with tempfile.TemporaryFile(dir=folder) as file:
        while len(times) < writes and (not times or time.monotonic() < until):
            begin = time.monotonic()
            os.write(file.fileno(), b"\n" * BLOCK)
            os.fdatasync(file.fileno())
            times.append(time.monotonic() - begin)
    return times


def nearest(folder: Path) -> Path:
    """`folder` itself, or the closest folder above it that exists already."""
    folder = folder.absolute()
    while not folder.exists() and folder != folder.parent:
        folder = folder.parent
    return folder
