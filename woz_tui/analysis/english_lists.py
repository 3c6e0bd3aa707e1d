"""Number and lists in English sentences."""

from __future__ import annotations

from collections.abc import Sequence


def some(count: int, one: str) -> str:
    """`1 session`, `2 sessions`."""
    return f"{count} {one if count == 1 else one + 's'}"


def Some(count: int, one: str) -> str:  # noqa: N802 - the same where a sentence begins
    """`One session`, `2 sessions`, `No session`."""
    if count == 0:
        return f"No {one}"
    return f"One {one}" if count == 1 else some(count, one)


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
