"""Times, numbers and lists as people read them: on the terminal, on the page and in sentences."""

from __future__ import annotations

from collections.abc import Sequence

#: What stands where there is no figure.
NONE = "-"


def clock(us: float | None, decimals: int = 0) -> str:
    """Minutes and seconds since the beginning: `3:07`, `1:03:07`, `3:07.250`."""
    if us is None:
        return NONE
    scale = 10**decimals
    total, part = divmod(round(us * scale / 1_000_000), scale)
    minutes, seconds = divmod(total, 60)
    hours, minutes = divmod(minutes, 60)
    head = f"{hours}:{minutes:02}" if hours else str(minutes)
    return f"{head}:{seconds:02}" + (f".{part:0{decimals}}" if decimals else "")


def exact_clock(us: int) -> str:
    """To the millisecond, and as wide after an hour: `1:02.345`, `75:00.000`; before the beginning
    `-0:00.500`.
    """
    sign, us = ("-", -us) if us < 0 else ("", us)
    minutes, rest = divmod(us, 60_000_000)
    return f"{sign}{minutes}:{rest / 1_000_000:06.3f}"


def duration(us: float | None) -> str:
    """`0.85 ms`, `850 ms`, `3.07 s`, `12:03 min`, `1:12:03 h`."""
    if us is None:
        return NONE
    if us < 1_000:
        return f"{us / 1_000:.2f} ms" if us else "0 ms"
    if us < 999_500:
        return f"{digits(us / 1_000)} ms"
    if us < 99_950_000:
        return f"{digits(us / 1_000_000)} s"
    return f"{clock(us)} {'min' if us < 3_599_500_000 else 'h'}"


def in_seconds(us: float) -> str:
    """`0.25`, `3`: seconds without their unit."""
    return f"{us / 1e6:.2f}".rstrip("0").rstrip(".")


def percent(share: float | None) -> str:
    """`12.5 %`."""
    return NONE if share is None else f"{share * 100:.1f} %"


def digits(number: float) -> str:
    """Three digits that count; a large number has no exponent: `1220`, `16.1`, `3.00`, `0.0651`."""
    return f"{number:.0f}" if abs(number) >= 999.5 else f"{number:#.3g}".removesuffix(".")


def counted(count: int, one: str) -> str:
    """`1 session`, `2 sessions`."""
    return f"{count} {one if count == 1 else one + 's'}"


def Some(count: int, one: str) -> str:  # noqa: N802 - the same where a sentence begins
    """`One session`, `2 sessions`, `No session`."""
    if count == 0:
        return f"No {one}"
    return f"One {one}" if count == 1 else counted(count, one)


def times(count: int) -> str:
    """`once`, `twice`, `3 times`."""
    return {1: "once", 2: "twice"}.get(count, f"{count} times")


def listed(words: Sequence[str], last: str = "and") -> str:
    """`a`, `a and b`, `a, b and c`."""
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} {last} {words[-1]}"


def neither(words: Sequence[str]) -> str:
    """`not a`, `neither a nor b`, `neither a, b nor c`."""
    return f"not {words[0]}" if len(words) == 1 else f"neither {listed(words, 'nor')}"


def were(count: int) -> str:
    """After a number that is a word, or before one."""
    return "was" if count < 2 else "were"


def was(count: int) -> str:
    """After a bare number, of which 0 is a plural."""
    return "was" if count == 1 else "were"


def capital(words: str) -> str:
    """As at the beginning of a sentence."""
    return words[:1].upper() + words[1:]
