"""How a replay stands, as the console knows it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from typing import Any, NamedTuple

from woz_tui.core.messages import Json
from woz_tui.core.requests import Replaying


class Place(NamedTuple):
    """Something on the time line: when, what sort (see `Replaying`), what it says."""

    t: int
    sort: str
    text: str


@dataclass(frozen=True, slots=True)
class ReplayPicture:
    """Length and idle time left out in microseconds; the speed, also while it stands still; what
    there is to go to, oldest first.
    """

    length_us: int = 0
    rate: float = 1.0
    paused: bool = False
    ended: bool = False
    cut_us: int = 0
    places: tuple[Place, ...] = ()


def following(before: ReplayPicture | None, told: Replaying) -> ReplayPicture:
    """What `told` makes of it: places that are not told again stay."""
    places = before.places if before is not None else ()
    if told.marks is not None:
        sorts = [*told.sorts, *("marker" for _ in told.marks[len(told.sorts) :])]
        places = tuple(
            Place(t, sort, text) for (t, text), sort in zip(told.marks, sorts, strict=False)
        )
    now = ReplayPicture(told.length_us, told.rate, told.paused, told.ended, told.cut_us)
    return replace(now, places=places)


def about(settings: Mapping[str, Json]) -> dict[str, Any]:
    """What the welcome says of the log that is replayed; another version may say anything."""
    told = settings.get("replay")
    return told if isinstance(told, dict) else {}


def notes(settings: Mapping[str, Json]) -> list[str]:
    """What is to be known of the log: damage, what is missing."""
    told = about(settings).get("notes")
    return [str(note) for note in told] if isinstance(told, list) else []


def wall_at(settings: Mapping[str, Json], t: int) -> datetime | None:
    """What the clock on the wall said at `t`, in UTC; None where the log does not tell."""
    told = about(settings)
    at, stamp = told.get("t"), told.get("ts")
    if not isinstance(at, int) or not isinstance(stamp, str):
        return None
    try:
        return datetime.fromisoformat(stamp) + timedelta(microseconds=t - at)
    except (ValueError, OverflowError):
        return None
