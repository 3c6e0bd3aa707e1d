"""The state of a replay: length, speed, pause, places to go to."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from typing import NamedTuple

from woz_tui.protocol.requests import Replaying
from woz_tui.protocol.welcome import WelcomeSettings


class TimelinePlace(NamedTuple):
    """A place on the time line: when, its sort (see `Replaying`), its text."""

    t: int
    sort: str
    text: str


@dataclass(frozen=True, slots=True)
class ReplayState:
    """Length and idle time left out in microseconds; the speed, also while it stands still; what
    there is to go to, oldest first.
    """

    length_us: int = 0
    rate: float = 1.0
    paused: bool = False
    ended: bool = False
    cut_us: int = 0
    places: tuple[TimelinePlace, ...] = ()


def updated(before: ReplayState | None, told: Replaying) -> ReplayState:
    """The state after a message `told`; places stay if it has none."""
    places = before.places if before is not None else ()
    if told.marks is not None:
        sorts = [*told.sorts, *("marker" for _ in told.marks[len(told.sorts) :])]
        places = tuple(
            TimelinePlace(t, sort, text) for (t, text), sort in zip(told.marks, sorts, strict=False)
        )
    now = ReplayState(told.length_us, told.rate, told.paused, told.ended, told.cut_us)
    return replace(now, places=places)


def wall_time(settings: WelcomeSettings, t: int) -> datetime | None:
    """The wall clock's time at `t`, in UTC; None where the log does not have it."""
    told = settings.replay
    if not told or not told.ts:
        return None
    try:
        return datetime.fromisoformat(told.ts) + timedelta(microseconds=t - told.t)
    except (ValueError, OverflowError):
        return None
