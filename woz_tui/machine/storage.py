"""The disk that takes the recordings: room, rights, and how long a safe write takes."""

from __future__ import annotations

import os
import shutil
import statistics
import tempfile
import time
from pathlib import Path

from woz_tui.drivers.contract import Finding

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
        return Finding("error", "disk", f"{folder} cannot be read: {error.strerror}")
    text = f"{free / 1e9:.1f} GB free for {folder}"
    if free < LEAST_FREE:
        return Finding("error", "disk", text, "make room before the session")
    if free < 10 * LEAST_FREE:
        return Finding("warning", "disk", text, "make room soon")
    return Finding("ok", "disk", text)


def sync_time(folder: Path, writes: int = 20, seconds: float = 2.0) -> Finding:
    """How long a written line takes until it is safe: `fdatasync` of up to `writes` blocks.

    Ends after `seconds`, if there was one measurement by then. Leaves nothing behind.
    """
    place = nearest(folder)
    try:
        times = _measure(place, writes, seconds)
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


def _measure(folder: Path, writes: int, seconds: float) -> list[float]:
    times: list[float] = []
    until = time.monotonic() + seconds
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
