"""What else draws the robot's attention while it talks with somebody, and when it looks back.

Three modes, after NAOqi's basic awareness:

* `FullyEngaged`: it looks nowhere else while a visitor is engaged.
* `SemiEngaged`: it looks to a sound, and back at the engaged visitor `seconds` later.
* `Unengaged`: it looks to a sound, and stays with somebody who is there; otherwise it looks back.

While nobody is engaged, sounds count in every mode; it stays with somebody who is there, and
otherwise looks back to what it did before. Whether somebody is there only a camera on the head can
tell (`camera: head`): what it says in the second half of the look counts, when the head has
turned, and most of it has to be yes. While it looks to a sound, no other one takes over. What goes
on (a fan, a corridor) is looked at once; it counts again after it has been gone for `seconds`.

    attention = Attention(settings)
    order = attention.engaged(True, 0.0, t)     the visitor, and where they stand
    order = attention.sound(60.0, t)            -> GazeDirection, if it counts
    attention.presence(True, t)                 what the camera says meanwhile
    order = attention.advance(t)                -> LookBack or Stay; at the latest at `due()`

Pure: `t` in whole microseconds (a step back does not count), directions in degrees of the robot's
own frame, 0 ahead, positive to its left, any number of turns. Calls that change nothing answer
None.

While the head is turned away (`away`), a camera on it does not see the visitor: what it says then
is no evidence about them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from woz_tui.config.engagement import AttentionSettings
from woz_tui.config.engagement_words import MODES

_SECOND = 1_000_000


@dataclass(frozen=True, slots=True)
class GazeDirection:
    """Turn to a sound, `direction` in degrees."""

    direction: float


@dataclass(frozen=True, slots=True)
class LookBack:
    """Turn back to the engaged visitor; `direction` None: to what was done before."""

    direction: float | None


@dataclass(frozen=True, slots=True)
class Stay:
    """Go on looking into `direction`, in degrees: somebody is there."""

    direction: float


Order = GazeDirection | LookBack | Stay


class Attention:
    """Where the robot should look. `mode` is one of `MODES`."""

    def __init__(self, settings: AttentionSettings) -> None:
        self.mode = settings.mode
        self._settings = settings
        self._now = 0
        self._engaged = False
        self._visitor: float | None = None
        #: The direction to which it looks away, and until when.
        self._away: tuple[float, int] | None = None
        #: The last sound, and when it was heard.
        self._last: tuple[float, int] | None = None
        #: How often the camera saw somebody there, less how often it saw nobody.
        self._seen = 0

    # -- what is the case -----------------------------------------------------------------------

    @property
    def away(self) -> bool:
        """Whether it looks to a sound now."""
        return self._away is not None

    @property
    def shown(self) -> str:
        """What draws its attention, in words; empty: nothing does."""
        return "" if self._away is None else f"a sound {direction_words(self._away[0])}"

    def due(self) -> int | None:
        """When `advance` has something to do; None: never by itself."""
        return None if self._away is None else self._away[1]

    # -- what happens ---------------------------------------------------------------------------

    def attend(self, mode: str, t: int) -> Order | None:
        """Take another mode; `ValueError` if there is none of that name."""
        if mode not in MODES:
            raise ValueError(f"there is no mode {mode!r}; take one of {', '.join(MODES)}")
        self._pass(t)
        self.mode = mode
        return self._undistracted()

    def engaged(self, engaged: bool, direction: float | None, t: int) -> Order | None:
        """Whether somebody is engaged, and where they are (None or no number: not known)."""
        over = self.advance(t)
        began = engaged and not self._engaged
        self._engaged = engaged
        self._visitor = _degrees(direction) if engaged else None
        return self._undistracted() if began and over is None else over

    def sound(self, direction: float | None, t: int) -> Order | None:
        """A sound may draw attention, if it is known where it is."""
        over = self.advance(t)
        place = _degrees(direction)
        if place is None or self._goes_on(place) or self._holds or self.away:
            return over
        if self._engaged and self._same(place, self._visitor or 0.0):
            return over
        self._away, self._seen = (place, self._now + self._length), 0
        return GazeDirection(place)

    def presence(self, somebody: bool, t: int) -> None:
        """What the camera on the head says: whether somebody is there where it looks."""
        self._pass(t)
        if self._away is not None and self._now >= self._away[1] - self._length // 2:
            self._seen += 1 if somebody else -1

    def advance(self, t: int) -> Order | None:
        """Time passes: it may have looked long enough."""
        self._pass(t)
        if self._away is None or self._now < self._away[1]:
            return None
        if not self._finds_somebody:
            return self._back()
        direction, self._away = self._away[0], None
        if self._engaged:
            self._visitor = direction
        return Stay(direction)

    # -- rules ----------------------------------------------------------------------------------

    @property
    def _holds(self) -> bool:
        """Whether nothing may distract it."""
        return self._engaged and self.mode == "FullyEngaged"

    @property
    def _finds_somebody(self) -> bool:
        """Whether it looks at somebody with whom it may stay."""
        bound = self._engaged and self.mode != "Unengaged"
        return self._seen > 0 and self._settings.camera == "head" and not bound

    @property
    def _length(self) -> int:
        return round(self._settings.seconds * _SECOND)

    def _pass(self, t: int) -> None:
        self._now = max(self._now, t)

    def _same(self, one: float, other: float) -> bool:
        return abs(math.remainder(one - other, 360.0)) <= self._settings.within

    def _goes_on(self, place: float) -> bool:
        """Whether this is what was heard a moment ago."""
        last, self._last = self._last, (place, self._now)
        return (
            last is not None and self._same(place, last[0]) and self._now - last[1] < self._length
        )

    def _undistracted(self) -> Order | None:
        """Look back if nothing may distract it any more."""
        return self._back() if self._away is not None and self._holds else None

    def _back(self) -> LookBack:
        self._away = None
        return LookBack((self._visitor or 0.0) if self._engaged else None)


def direction_words(direction: float) -> str:
    """A direction in words: `60 degrees to the left`."""
    degrees = round(abs(direction))
    if degrees == 0:
        return "ahead"
    return f"{degrees} degrees to the {'left' if direction > 0 else 'right'}"


def _degrees(direction: float | None) -> float | None:
    """The direction between -180 and 180; None if it is no number."""
    if direction is None or not math.isfinite(direction):
        return None
    return math.remainder(direction, 360.0)
