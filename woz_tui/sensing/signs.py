"""The four signs of a visitor: sensed, made steady by a filter, overruled by the wizard."""

from __future__ import annotations

import math
from typing import Any, TypedDict

from woz_tui.core.engaged import SignShown
from woz_tui.experiment.engagement import EngagementSettings
from woz_tui.sensing import samples
from woz_tui.sensing.filters import Fifo, Filter, Median
from woz_tui.sensing.identity import IdentityFifo
from woz_tui.sensing.joint import Joint
from woz_tui.sensing.joint import Sign as JointSign
from woz_tui.sensing.passing import SECOND, microseconds
from woz_tui.sensing.samples import UNKNOWN
from woz_tui.sensing.steady import Steady
from woz_tui.sensing.thinning import Thinning

#: Nobody counts as engaged on samples older than this, whatever the settings say; microseconds.
FRESH = 2 * SECOND
#: What a verdict is called: no, yes.
WORDS = {
    "presence": ("nobody is there", "present"),
    "gaze": ("looks away", "looks"),
    "distance": ("not near", "near"),
}


class _Filled(TypedDict):
    count: int
    needed: int
    places: int
    filter: str


class Heard:
    """A sensor and its filter: when it was heard last. Times are the model's, in microseconds."""

    _steady: Steady[Any]

    def __init__(self, name: str, settings: EngagementSettings, now: int) -> None:
        self.name = name
        self._start_up = settings.start_up
        self.stale_after = _stale_after(name, settings)
        self._thinning = Thinning(settings.sign(name).rate)
        self.heard_at = now
        #: Whether it was ever heard, and whether that is too long ago.
        self.ever = False
        self.stale = False

    def pass_to(self, now: int) -> None:
        """Time passes; a sensor that says nothing for too long is stale, and its queue empty."""
        if not self.stale and now - self.heard_at > self.stale_after:
            self.stale = True
            self._steady.forget()
            self._thinning.restart()

    def configure(self, kind: str | None, count: int | None, threshold: float | None) -> None:
        """Another filter, or other numbers for it; None leaves them as they are."""
        self._steady.configure(kind, count, threshold)

    def adopt(self, settings: EngagementSettings, before: EngagementSettings) -> None:
        """Go on with what is new in the settings."""
        self.stale_after = _stale_after(self.name, settings)
        self._start_up = settings.start_up
        self._steady.start_as(settings.start_up)
        self._thinning.beats(settings.sign(self.name).rate)
        new = numbers(self.name, settings)
        if new != numbers(self.name, before):
            self.configure(*new)

    def _takes(self, value: float | str, now: int) -> None:
        self.heard_at = now
        self.ever = True
        self.stale = False
        if self._thinning.counts(now):
            self._steady.take(value, now)


def _stale_after(name: str, settings: EngagementSettings) -> int:
    own = settings.sign(name).stale
    return microseconds(settings.stale if own is None else own)


def numbers(name: str, settings: EngagementSettings) -> tuple[str, int, float]:
    """The filter of a sign, its places and its threshold, as the settings have them."""
    own = settings.sign(name)
    kind = own.filter or settings.filter
    if kind == "median" and name != "distance":
        kind = "fifo"
    threshold = settings.threshold if own.threshold is None else own.threshold
    return kind, own.samples or settings.samples, threshold


class Sign(Heard):
    """Presence, gaze or distance. `joint` is what all signs share that are filtered jointly."""

    _steady: Steady[Fifo]

    def __init__(self, name: str, settings: EngagementSettings, joint: Joint, now: int) -> None:
        super().__init__(name, settings, now)
        self.near = settings.social_distance
        self._farthest = settings.farthest
        self.raw: float | None = None
        #: The wizard's verdict, or metres.
        self.forced: float | bool | None = None
        self._steady = Steady(self._made, joint.view(name), numbers(name, settings))

    @property
    def filter(self) -> Filter:
        """What makes the verdict."""
        return self._steady.filter

    def take(self, value: object, now: int) -> bool:
        """A sample, whatever it is; whether it is one."""
        read = samples.FLAGS.get(self.name)
        meant = samples.metres(value, self._farthest) if read is None else read(value)
        if meant is None:
            return False
        self.raw = float(value) if isinstance(value, bool) else samples.number(value)
        self._takes(meant, now)
        return True

    def near_within(self, metres: float) -> None:
        """Another social distance."""
        self.near = metres
        if self.name == "distance":
            self._steady.queue.near_within(metres)

    def adopt(self, settings: EngagementSettings, before: EngagementSettings) -> None:
        """Go on with what is new in the settings."""
        self._farthest = settings.farthest
        super().adopt(settings, before)

    def fresh(self, now: int) -> bool:
        """Whether somebody may count as engaged by it."""
        return self.forced is not None or now - self.heard_at <= FRESH

    @property
    def verdict(self) -> int | None:
        """1, 0, or None while there is none yet; 0 for a sign that has fallen silent."""
        if self.forced is not None:
            if self.name == "distance" and not isinstance(self.forced, bool):
                return int(self.forced <= self.near)
            return int(self.forced)
        return 0 if self.stale and self.ever else self.filter.verdict

    def words(self, now: int) -> str:
        """The verdict as a person says it: `looks (5 of 8)`."""
        verdict = self.verdict
        if self.forced is None and (self.stale or not self.fresh(now)):
            return f"{self.name} stale" if self.ever else f"no {self.name} sensor"
        if verdict is None or (self.forced is None and not self.ever):
            return f"{self.name} not known yet"
        said = WORDS[self.name][verdict]
        metres = self.metres
        if self.name == "distance" and metres is not None and math.isfinite(metres):
            said += f" {metres:.1f} m"
        return said + (" (wizard)" if self.forced is not None else _share(self.filter))

    @property
    def metres(self) -> float | None:
        """The distance that counts: the wizard's, or the last sample."""
        forced = self.forced
        return self.raw if forced is None else None if isinstance(forced, bool) else forced

    def shown(self) -> SignShown:
        """The sign as the screen shows it; what is beyond all measure has no number."""
        raw = self.metres if self.raw is None else self.raw
        return SignShown(
            raw=raw if raw is not None and math.isfinite(raw) else None,
            verdict=self.verdict,
            **_filled(self.filter),
            stale=self.stale and self.forced is None,
            forced=self.forced is not None,
        )

    def _made(self, kind: str, count: int, threshold: float) -> Fifo:
        near = self.near if self.name == "distance" else None
        if kind == "median" and near is not None:
            return Median(count, threshold, self._start_up, near)
        return Fifo(count, threshold, self._start_up, near)


class Identity(Heard):
    """Who the visitor is."""

    _steady: Steady[IdentityFifo]

    def __init__(self, settings: EngagementSettings, joint: Joint, now: int) -> None:
        super().__init__("identity", settings, now)
        self.raw: str = ""
        #: The name that the wizard gives, which may be "Unknown".
        self.forced: str | None = None
        self._steady = Steady(self._made, joint.view("identity"), numbers("identity", settings))

    @property
    def filter(self) -> IdentityFifo | JointSign:
        """What makes the verdict."""
        return self._steady.filter

    def take(self, value: object, text: str, now: int) -> bool:
        """A recognition, whatever it is; whether it is one."""
        name = samples.name(value, text)
        if name is None:
            return False
        self.raw = name
        self._takes(name, now)
        return True

    @property
    def name_given(self) -> str:
        """The ID, or "Unknown"."""
        if self.forced is not None:
            return self.forced
        return UNKNOWN if self.stale else self.filter.name

    @property
    def verdict(self) -> int | None:
        """1 if there is an ID, 0 if not, None while there is no verdict yet."""
        if self.forced is not None or (self.stale and self.ever):
            return int(self.known)
        return self.filter.verdict

    @property
    def known(self) -> bool:
        """Whether there is an ID."""
        return self.name_given != UNKNOWN

    def words(self, told: str = "") -> str:
        """Who it is, as a person says it; `told`: the name that somebody has given."""
        if told and not self.known:
            return f"known as {told}"
        if self.forced is not None:
            return f"{self.forced if self.known else 'no name'} (wizard)"
        if not self.known:
            return "no name"
        return self.name_given + _share(self.filter)

    def shown(self) -> SignShown:
        """The sign as the screen shows it."""
        return SignShown(
            raw_name=self.raw,
            verdict=self.verdict,
            name=self.name_given,
            **_filled(self.filter),
            stale=self.stale and self.forced is None,
            forced=self.forced is not None,
        )

    def _made(self, kind: str, count: int, threshold: float) -> IdentityFifo:
        return IdentityFifo(count, threshold, self._start_up)


def _share(filter_: Filter) -> str:
    """How many speak for it, unless all do or none."""
    if not 0 < filter_.count < filter_.places:
        return ""
    return f" ({filter_.count} {'%' if filter_.kind == 'joint' else f'of {filter_.places}'})"


def _filled(filter_: Filter) -> _Filled:
    return _Filled(
        count=filter_.count,
        needed=filter_.needed,
        places=filter_.places,
        filter=filter_.kind,
    )
