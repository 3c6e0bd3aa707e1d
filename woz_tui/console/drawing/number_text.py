"""Numbers as the console writes them: short, and always equally wide where they change."""

from __future__ import annotations

import math

#: Loudness below this is drawn as silence (dB relative to full scale).
SILENCE_DB = -60.0


def seconds(us: int) -> str:
    """`2.1 s`, from a hundred seconds on `123 s`."""
    value = max(0, us) / 1_000_000
    return f"{value:.1f} s" if value < 99.95 else f"{value:.0f} s"


def time_left(us: int) -> str:
    """What is still to go, without its unit: `7.4` seconds, from a hundred on `6:11` minutes."""
    value = max(0, us) / 1_000_000
    if value < 99.95:
        return f"{value:.1f}"
    minutes, rest = divmod(round(value), 60)
    return f"{minutes}:{rest:02}"


def age(us: int) -> str:
    """`4 s`, from a hundred seconds on in minutes."""
    value = max(0, us) / 1_000_000
    return f"{value:.0f} s" if value < 99.5 else f"{value / 60:.0f} min"


def millis(us: int) -> str:
    """`23 ms`, from ten seconds on in seconds."""
    return f"{us / 1000:.0f} ms" if us < 10_000_000 else seconds(us)


def decibels(rms: float) -> float:
    """RMS (0..1 of full scale) in dB relative to full scale, not below `SILENCE_DB`."""
    if not rms > 0:
        return SILENCE_DB
    return max(SILENCE_DB, 20 * math.log10(rms))
