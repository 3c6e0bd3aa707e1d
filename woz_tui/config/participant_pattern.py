"""The pattern that participants' codes must match, compared within a time limit.

The limit is there because the robot process does nothing else meanwhile, and a stop waits: with
some patterns a comparison takes seconds or hours. Python's own `re` cannot be interrupted.
"""

from __future__ import annotations

import re

from woz_tui.protocol.sentence import Sentence

#: Seconds that one comparison may take; an ordinary one takes microseconds.
LIMIT_S = 0.02
#: What helps against a pattern that takes longer.
SIMPLER = Sentence("check.simpler_pattern", "write participants.pattern without nested repetitions")


def matches(pattern: str, code: str) -> bool:
    """Whether all of `code` fits; `TimeoutError` if that cannot be found out in time."""
    import regex  # noqa: PLC0415 - takes a while, and most commands compare nothing

    try:
        return regex.fullmatch(pattern, code, timeout=LIMIT_S) is not None
    except regex.error:  # `{e}` and its kin, which only `re` takes for mere characters
        return re.fullmatch(pattern, code) is not None


_PIECE = re.compile(r"(\\d|\[\w[^\]]*\]|\w)(?:\{(\d+)[,\d]*\}|([+*?]))?")


def example(pattern: str) -> str:
    """A code that matches, such as P01; empty if none is found for this pattern."""
    code = ""
    for piece in _PIECE.finditer(pattern):
        one, times, many = piece.groups()
        character = "0" if one == r"\d" else one.strip("[")[0]
        code += character * (int(times) if times else 0 if many in ("*", "?") else 1)
    try:
        found = (each for each in ("P01", code[:-1] + "1", code) if matches(pattern, each))
        return next(found, "")
    except TimeoutError:
        return ""


def describe_pattern(pattern: str) -> str:
    """What a code must look like, for a person."""
    found = example(pattern)
    return f"the code must look like {found}" if found else f"the code must match {pattern}"


def is_slow(pattern: str) -> bool:
    """Whether a long code of one letter or digit cannot be compared in time."""
    try:
        for character in "A0a":
            matches(pattern, character * 16)
    except TimeoutError:
        return True
    return False
