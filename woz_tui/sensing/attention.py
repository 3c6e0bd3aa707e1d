"""What else draws the robot's attention while it talks with somebody, and when it looks back.

Three modes, after NAOqi's basic awareness:

* `Unengaged`: any stimulus distracts it, also from an engaged visitor; if somebody is found there,
  it may turn to them for good.
* `FullyEngaged`: it looks nowhere else while a visitor is engaged.
* `SemiEngaged`: it looks, and always looks back at the engaged visitor, at the latest `seconds`
  after it looked away.

While nobody is engaged, stimuli count in every mode. Where nobody is found, the robot goes back to
what it did before. People count for more than a touch, a touch for more than one of the tablet,
then sounds, then movements: a stimulus that counts for more takes over from the one it looks at,
others do not. What goes on (a fan, a corridor) is looked at once; it counts again after it has been
gone for `seconds`.

    attention = Attention(settings)
    order = attention.engaged(True, 0.0, t)                 the visitor, and where they stand
    order = attention.stimulus(Stimulus.SOUND, 60.0, t)     -> Look, or Stay with the reason
    order = attention.found(True, t)                        is somebody there where it looks?
    order = attention.advance(t)                            at the latest at `due()`

Pure: `t` in whole microseconds (a step back does not count), directions in degrees of the robot's
own frame, 0 ahead, positive to its left, any number of turns. Orders say why in words:
`GazeDirection(direction, why)`, `LookBack(direction, why)` (None: to what it did before),
`SwitchPartner(direction, why)` (it stays with whoever is there) and `KeepLooking(why)`. Calls that
change nothing answer None.

While the head is turned away (`away`), a camera on it does not see the visitor: what it says then
is no evidence about them.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass

from woz_tui.config.engagement import MODES, AttentionSettings

_SECOND = 1_000_000


class Stimulus(enum.StrEnum):
    """What may draw attention; those that count for more come first."""

    PEOPLE = "People"
    TOUCH = "Touch"
    TABLET_TOUCH = "TabletTouch"
    SOUND = "Sound"
    MOVEMENT = "Movement"

    @property
    def priority(self) -> int:
        """1 counts most."""
        return list(Stimulus).index(self) + 1


@dataclass(frozen=True, slots=True)
class GazeDirection:
    """Turn to a stimulus, `direction` in degrees."""

    direction: float
    why: str


@dataclass(frozen=True, slots=True)
class LookBack:
    """Turn back to the engaged visitor; `direction` None: to what was done before."""

    direction: float | None
    why: str


@dataclass(frozen=True, slots=True)
class SwitchPartner:
    """Stay with whoever was found there; they may become the engaged visitor."""

    direction: float
    why: str


@dataclass(frozen=True, slots=True)
class KeepLooking:
    """Nothing is done about a stimulus."""

    why: str


Order = GazeDirection | LookBack | SwitchPartner | KeepLooking

#: What stays in view without a direction: hands are where the robot is.
_AT_THE_ROBOT = (Stimulus.TOUCH, Stimulus.TABLET_TOUCH)
_WORDS = {
    Stimulus.PEOPLE: "somebody",
    Stimulus.TOUCH: "a touch",
    Stimulus.TABLET_TOUCH: "a touch of the tablet",
    Stimulus.SOUND: "a sound",
    Stimulus.MOVEMENT: "a movement",
}
#: These may go on for long without anything new in them.
_LASTING = (Stimulus.SOUND, Stimulus.MOVEMENT)


@dataclass(frozen=True, slots=True)
class _Away:
    """It looks at a stimulus, until a moment."""

    kind: Stimulus
    direction: float
    until: int


class Attention:
    """Where the robot should look. `mode` is one of `MODES`."""

    def __init__(self, settings: AttentionSettings) -> None:
        self.mode = settings.mode
        self._settings = settings
        self._now = 0
        self._engaged = False
        self._visitor: float | None = None
        self._away: _Away | None = None
        self._lasting: dict[Stimulus, tuple[float, int]] = {}

    # -- what is the case -----------------------------------------------------------------------

    @property
    def away(self) -> bool:
        """Whether it looks at a stimulus now."""
        return self._away is not None

    @property
    def shown(self) -> str:
        """What draws its attention, in words; empty: nothing does."""
        away = self._away
        return "" if away is None else f"{_WORDS[away.kind]} {direction_words(away.direction)}"

    def due(self) -> int | None:
        """When `advance` has something to do; None: never by itself."""
        return None if self._away is None else self._away.until

    # -- what happens ---------------------------------------------------------------------------

    def attend(self, mode: str, t: int) -> Order | None:
        """Take another mode; `ValueError` if there is none of that name."""
        if mode not in MODES:
            raise ValueError(f"there is no mode {mode!r}; take one of {', '.join(MODES)}")
        self._pass(t)
        self.mode = mode
        return self._undistracted(f"mode {mode}")

    def engaged(self, engaged: bool, direction: float | None, t: int) -> Order | None:
        """Whether somebody is engaged, and where they are (None or no number: not known)."""
        over = self.advance(t)
        began = engaged and not self._engaged
        self._engaged = engaged
        self._visitor = _degrees(direction) if engaged else None
        return self._undistracted("somebody is engaged") if began and over is None else over

    def stimulus(self, kind: Stimulus, direction: float | None, t: int) -> Order:
        """Something may draw attention; a touch without a direction is straight ahead."""
        over = self.advance(t)
        place = _degrees(0.0 if direction is None and kind in _AT_THE_ROBOT else direction)
        if place is None:
            return over or KeepLooking(f"{_WORDS[kind]}, but nobody knows where")
        what = f"{_WORDS[kind]} {direction_words(place)}"
        lasts = self._lasts(kind, place)
        if self._holds:
            return over or KeepLooking(f"{what}, but the visitor has its full attention")
        reason = self._nothing_new(kind, place) or ("it goes on" if lasts else "")
        if reason:
            return over or KeepLooking(f"{what}, but {reason}")
        self._away = _Away(kind, place, self._look_until())
        return GazeDirection(place, what)

    def somebody_there(self, somebody: bool, t: int) -> Order | None:
        """Whether somebody is there, at the place it looks at now."""
        over = self.advance(t)
        away = self._away
        if away is None or over is not None:
            return over
        if not somebody:
            return self._back(f"nobody {direction_words(away.direction)}")
        if self._engaged and self.mode != "Unengaged":
            return None
        self._away = None
        if self._engaged:
            self._visitor = away.direction
        return SwitchPartner(away.direction, f"somebody is {direction_words(away.direction)}")

    def advance(self, t: int) -> Order | None:
        """Time passes: it may have looked long enough."""
        self._pass(t)
        if self._away is None or self._now < self._away.until:
            return None
        return self._back(f"looked {direction_words(self._away.direction)} long enough")

    # -- rules ----------------------------------------------------------------------------------

    @property
    def _holds(self) -> bool:
        """Whether nothing may distract it."""
        return self._engaged and self.mode == "FullyEngaged"

    @property
    def _length(self) -> int:
        return round(self._settings.seconds * _SECOND)

    def _pass(self, t: int) -> None:
        self._now = max(self._now, t)

    def _look_until(self) -> int:
        """The time away from an engaged visitor is bounded, however many stimuli take turns."""
        bound = self._engaged and self.mode == "SemiEngaged"
        if bound and self._away is not None:
            return self._away.until
        return self._now + self._length

    def _nothing_new(self, kind: Stimulus, place: float) -> str:
        """Why a stimulus is none; empty: it is one."""
        away = self._away
        if away is not None:
            if _apart(place, away.direction) <= self._settings.within:
                return "it looks there already"
            if kind.priority >= away.kind.priority:
                return f"{_WORDS[away.kind]} has its attention"
        elif self._engaged and _apart(place, self._visitor or 0.0) <= self._settings.within:
            return "that is where the visitor is"
        return ""

    def _lasts(self, kind: Stimulus, place: float) -> bool:
        """Whether this is what was there a moment ago."""
        if kind not in _LASTING:
            return False
        last = self._lasting.get(kind)
        self._lasting[kind] = (place, self._now)
        if last is None:
            return False
        return (
            _apart(place, last[0]) <= self._settings.within and self._now - last[1] < self._length
        )

    def _undistracted(self, why: str) -> Order | None:
        """Look back if nothing may distract it any more."""
        return self._back(why) if self._away is not None and self._holds else None

    def _back(self, why: str) -> LookBack:
        self._away = None
        if self._engaged:
            return LookBack(self._visitor or 0.0, f"{why}; back to the visitor")
        return LookBack(None, f"{why}; back to what it did")


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


def _apart(one: float, other: float) -> float:
    return abs(math.remainder(one - other, 360.0))
