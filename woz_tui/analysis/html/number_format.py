"""Numbers as people read them. None is shown as a dash."""

from __future__ import annotations

DASH = "\u2013"


def clock(us: int, decimals: int = 0) -> str:
    """Minutes and seconds since the beginning: `3:07`, `1:03:07`, `3:07.250`."""
    scale = 10**decimals
    ticks = round(us * scale / 1_000_000)
    whole, part = divmod(ticks, scale)
    minutes, seconds = divmod(whole, 60)
    hours, minutes = divmod(minutes, 60)
    head = f"{hours}:{minutes:02}" if hours else str(minutes)
    return f"{head}:{seconds:02}" + (f".{part:0{decimals}}" if decimals else "")


def calendar(timestamp: str, letters: int) -> str:
    """The first `letters` of an RFC 3339 time, as people write it: `2026-03-01 10:00`."""
    return timestamp[:letters].replace("T", " ")


def duration(us: float | None) -> str:
    """`850 ms`, `3.07 s`, `12:03 min`."""
    if us is None:
        return DASH
    if us == 0:
        return "0 ms"
    if us < 1_000:
        return f"{us / 1_000:.1f} ms"
    if us < 999_500:
        return f"{us / 1_000:.0f} ms"
    if us < 100_000_000:
        return f"{us / 1_000_000:.2f} s"
    return f"{clock(round(us))} min" if us < 3_600_000_000 else f"{clock(round(us))} h"


def percent(share: float | None) -> str:
    """`12.5 %`."""
    return DASH if share is None else f"{share * 100:.1f} %"


def digits(number: float) -> str:
    """Three digits that count; a large number has no exponent: `1220`, `16.1`, `0.0651`."""
    return f"{number:.0f}" if abs(number) >= 999.5 else f"{number:.3g}"


def counted(number: int, what: str) -> str:
    """`1 row`, `2 rows`."""
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def value(number: float | None) -> str:
    """What a column is sorted by: the number itself; empty: there is none."""
    return "" if number is None else f"{number:g}"
