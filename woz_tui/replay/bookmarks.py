"""Finds places in a log to go to, and idle stretches that can be left out."""

from __future__ import annotations

import bisect
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

from woz_tui.feature import pieces
from woz_tui.log.line_order import count_falls
from woz_tui.protocol import messages as m
from woz_tui.protocol.requesters import END_REASONS, STOP_SOURCES
from woz_tui.protocol.sentence import Sentence
from woz_tui.timeline.feature_history import FeatureHistory

#: How much is shown before what ends an idle stretch, in microseconds, at most.
LEAD_US = 1_000_000
#: What happens; everything else, above all samples, comes by itself also where nobody does a thing.
_EVENTS = (
    m.ActionRequested,
    m.ActionEnd,
    m.Command,
    m.End,
    m.EngagementChanged,
    m.SpeechStarted,
    m.SpeechEnded,
    m.SpeechText,
    m.Marker,
    m.Note,
    m.Mistake,
    m.StopPressed,
    m.StopReleased,
    m.DriverLost,
    m.SessionStart,
    m.SessionChanged,
    m.SessionEnd,
    m.TrialStarted,
    m.TrialEnded,
    m.BreakStarted,
    m.BreakEnded,
)


#: Sort of a trial's number that somebody set; where trials are begun, it says nothing by itself.
SET = "trial set"


class Bookmark(NamedTuple):
    """A place on the time line: when, what sort (marker, note, mistake, stop, trial, phase,
    break, questionnaire, lost, engagement, end; code: a coder set it), what it says.
    """

    t: int
    sort: str
    text: str


#: Makes the mark of a line at `t`; None: it is none.
BookmarkMaker = Callable[[Any, int], Bookmark | None]


@dataclass(frozen=True, slots=True)
class FeatureBookmarks:
    """What marks a feature's messages are."""

    of: Mapping[type, BookmarkMaker]


_BREAK = Sentence("replay.break", "break")
_BREAK_OF = Sentence("replay.break_of", "break {text}", text="{text}")
_END = Sentence("replay.end", "end")
_END_OF = Sentence("replay.end_of", "end: {why}", why="{why}")


def bookmark_of(message: object, t: int) -> Bookmark | None:
    """The mark that a line of the log is; None for most of them."""
    match message:
        case m.Marker(text=text):
            return Bookmark(t, "marker", text or Sentence("replay.marker", "marker"))
        case m.Note(text=text):
            return Bookmark(t, "note", text)
        case m.Mistake(action=action, run=run, text=text):
            return Bookmark(t, "mistake", f"{action or run} {text}".strip())
        case m.StopPressed(scope="all", source=source):
            by = STOP_SOURCES.get(source, source)
            return Bookmark(t, "stop", Sentence("replay.stop_by", "stop by {source}", source=by))
        case m.TrialStarted(trial=trial, condition=condition):
            return Bookmark(t, "trial", _trial(trial, condition))
        case m.SessionChanged(trial=int(trial)):
            return Bookmark(t, SET, _trial(trial, ""))
        case m.BreakStarted(text=text):
            return Bookmark(t, "break", _BREAK_OF.filled(text=text) if text else _BREAK)
        case m.DriverLost(driver=driver):
            return Bookmark(t, "lost", Sentence("events.lost", "{driver} lost", driver=driver))
        case m.SessionEnd(reason=reason):
            return Bookmark(
                t, "end", _END_OF.filled(why=END_REASONS.get(reason, reason)) if reason else _END
            )
    marked = _of_features().get(type(message))
    return marked(message, t) if marked is not None else None


def _trial(number: int, condition: str) -> Sentence:
    if not condition:
        return Sentence("events.trial", "trial {trial}", trial=number)
    return Sentence(
        "replay.trial_in", "trial {trial} {condition}", trial=number, condition=condition
    )


@cache
def _of_features() -> dict[type, BookmarkMaker]:
    found: dict[type, BookmarkMaker] = {}
    for each in pieces("bookmarks", FeatureBookmarks).values():
        found |= each.of
    return found


def bookmarks_of(marks: Iterable[Bookmark | None]) -> list[Bookmark]:
    """What there is to go to: trials that were begun, or else the numbers that were set."""
    found = [mark for mark in marks if mark is not None]
    begun = any(mark.sort == "trial" for mark in found)
    return [
        mark._replace(sort="trial") if mark.sort == SET else mark
        for mark in found
        if mark.sort != SET or not begun
    ]


def is_event(message: object) -> bool:
    """Whether a line is something that happened, so that it ends an idle stretch."""
    return isinstance(message, _all_events())


@cache
def _all_events() -> tuple[type[object], ...]:
    kinds: list[type[FeatureHistory]] = [*pieces("history", type).values()]
    return (*_EVENTS, *(deed for kind in kinds for deed in kind.deeds))


@dataclass(frozen=True, slots=True)
class IdleCut:
    """A stretch that is left out: playing jumps from `begin` to `end` (microseconds)."""

    begin: int
    end: int


class IdleCuts:
    """What is left out of the idle stretches between `deeds`, times in microseconds, rising.

    A stretch longer than `most_us` keeps that much: most of it at its beginning, the rest before
    what ends it. Without `most_us` nothing is left out.
    """

    def __init__(self, deeds: Iterable[int], most_us: int | None) -> None:
        self._cuts = [] if most_us is None else list(_cuts(deeds, most_us))
        self._begins = [cut.begin for cut in self._cuts]
        self._shown = []
        left_out = 0
        for cut in self._cuts:
            self._shown.append(cut.begin - left_out)
            left_out += cut.end - cut.begin

    def crossed(self, start: int, to: int) -> IdleCut | None:
        """The first cut that playing from `start` to `to` comes to."""
        index = bisect.bisect_left(self._begins, start)
        if index < len(self._cuts) and self._begins[index] < to:
            return self._cuts[index]
        return None

    def before(self, t: int) -> int:
        """How much has been left out up to `t`."""
        return sum(
            min(cut.end, t) - cut.begin for cut in self._cuts[: bisect.bisect_left(self._begins, t)]
        )

    def moved(self, t: int, by: int) -> int:
        """`by` microseconds further or back, of what is shown."""
        wanted = t - self.before(t) + by
        index = bisect.bisect_left(self._shown, wanted)
        return wanted + sum(cut.end - cut.begin for cut in self._cuts[:index])


def _cuts(deeds: Iterable[int], most_us: int) -> Iterable[IdleCut]:
    lead = min(LEAD_US, most_us // 2)
    before: int | None = None
    for t in deeds:
        if before is not None and t - before > most_us:
            yield IdleCut(before + most_us - lead, t - lead)
        before = t


def monotonic(times: Sequence[int]) -> list[int]:
    """Times that never go back, from those of a log in its order.

    A single time that does not fit between its neighbours is damaged: one that is too late takes
    that of the line behind it, one that is too early that of the line before.
    """
    if not count_falls(times):
        return [*times]
    found: list[int] = []
    last = 0
    for index, t in enumerate(times):
        following = times[index + 1 : index + 3]
        late = following and last <= following[0] and max(following) < t
        last = max(last, following[0] if late else t)
        found.append(last)
    return found
