"""Clocks: the calendar that dates a log, and the one that times it."""

from __future__ import annotations

import ctypes
import os
import time
from datetime import UTC, datetime

from woz_tui.drivers.contract import Finding
from woz_tui.machine.bounded_checks import output_of

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
        return Finding("ok", "date", text)
    return Finding("error", "date", text, f"set the clock: {_SET_NTP}")


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
