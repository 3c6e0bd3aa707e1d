"""The pattern that participants' codes must match, compared within a time limit.

The limit is there because the robot process does nothing else meanwhile, and a stop waits: with
some patterns a comparison takes seconds or hours. Python's own `re` cannot be interrupted.
"""

from __future__ import annotations

import re

#: Seconds that one comparison may take; an ordinary one takes microseconds.
LIMIT_S = 0.02
#: What helps against a pattern that takes longer.
SIMPLER = "write participants.pattern without a repetition inside another one"


def matches(pattern: str, code: str) -> bool:
    """Whether all of `code` fits; `TimeoutError` if that cannot be found out in time."""
    import regex  # noqa: PLC0415 - takes a while, and most commands compare nothing

    try:
        return regex.fullmatch(pattern, code, timeout=LIMIT_S) is not None
    except regex.error:  # `{e}` and its kin, which only `re` takes for mere characters
        return re.fullmatch(pattern, code) is not None


def is_slow(pattern: str) -> bool:
    """Whether a long code of one letter or digit cannot be compared in time."""
    try:
        for character in "A0a":
            matches(pattern, character * 16)
    except TimeoutError:
        return True
    return False
