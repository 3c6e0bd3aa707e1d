"""Finds the time to go to: from a typed time, or from a place in the log."""

from __future__ import annotations

import operator
import re
from collections.abc import Sequence

from woz_tui.protocol.sentence import Sentence
from woz_tui.replay.bookmarks import Bookmark
from woz_tui.replay.recording import Recording
from woz_tui.system.text_cleaning import elapsed

_CLOCK = re.compile(r"(?:(\d+):)?(\d+):(\d{1,2}(?:\.\d*)?)")
_SECONDS = re.compile(r"\d+(?:\.\d*)?|\.\d+")

#: Sorts of marks at which going from one to the next does not halt.
MANY = frozenset({"engagement", "end"})
#: Going back from a mark within so much after it, in microseconds, goes to the one before.
AGAIN_US = 1_000_000


class ReplayError(ValueError):
    """A request of the viewer cannot be carried out; `hint` says what would help."""

    def __init__(self, reason: str, hint: str = "") -> None:
        super().__init__(reason)
        self.reason, self.hint = reason, hint


def time_of(text: str) -> int | None:
    """Microseconds of `12:34`, `1:02:03`, `12:34.5` or `754.2` (seconds); None if it is no time."""
    text = text.strip()
    if clock := _CLOCK.fullmatch(text):
        hours, minutes, seconds = (float(part or 0) for part in clock.groups())
        return round((hours * 3600 + minutes * 60 + seconds) * 1_000_000)
    return round(float(text) * 1_000_000) if _SECONDS.fullmatch(text) else None


def seek_time(text: str, recording: Recording, now: int) -> int:
    """The time that is meant: `start`, `end`, `next` and `before` (marks, seen from `now`), a time,
    or the text of a mark: the next one after `now` that is called so, begins so or has it in
    itself, or else the first. Raises `ReplayError`.
    """
    wanted = text.strip()
    word = wanted.casefold()
    if word in ("start", "end"):
        return recording.begin_us if word == "start" else recording.length_us
    if word in ("next", "before"):
        return _beside(recording.marks, now, later=word == "next")
    t = time_of(wanted)
    if t is not None:
        if t > recording.length_us:
            long = elapsed(recording.length_us)
            raise ReplayError(Sentence("replay.long", "the session is {time} long", time=long))
        return t
    mark = _named(word, recording.marks, now)
    if mark is None:
        raise ReplayError(
            Sentence("replay.not_in_log", "there is no {wanted!r} in this log", wanted=wanted),
            Sentence("replay.press_g", "press g for the list"),
        )
    return mark.t


def _beside(marks: Sequence[Bookmark], now: int, *, later: bool) -> int:
    places = [mark.t for mark in marks if mark.sort not in MANY]
    found = (
        [t for t in places if t > now] if later else [t for t in places[::-1] if t < now - AGAIN_US]
    )
    if not found:
        if later:
            raise ReplayError(
                Sentence("replay.none_later", "there is no marker, stop or trial later")
            )
        raise ReplayError(
            Sentence("replay.none_before", "there is no marker, stop or trial before")
        )
    return found[0]


def _named(wanted: str, marks: Sequence[Bookmark], now: int) -> Bookmark | None:
    if not wanted:
        return None
    for fits in (operator.eq, str.startswith, operator.contains):
        found = [mark for mark in marks if fits(mark.text.casefold(), wanted)]
        if found:
            return next((mark for mark in found if mark.t > now), found[0])
    return None
