"""The four signs of a visitor: sensed, made steady by a filter, overruled by the wizard."""

from __future__ import annotations

import math

from woz_tui.core.engaged import SignShown
from woz_tui.experiment.engagement import EngagementSettings
from woz_tui.sensing import samples
from woz_tui.sensing.filters import Fifo, Median
from woz_tui.sensing.identity import IdentityFifo
from woz_tui.sensing.passing import SECOND, microseconds
from woz_tui.sensing.samples import UNKNOWN

#: Nobody counts as engaged on samples older than this, whatever the settings say; microseconds.
FRESH = 2 * SECOND
#: What a verdict is called: no, yes.
WORDS = {
    "presence": ("nobody is there", "present"),
    "gaze": ("looks away", "looks"),
    "distance": ("too far", "near"),
}


class Heard:
    """When a sensor was heard last. Times are the model's, in microseconds."""

    def __init__(self, name: str, settings: EngagementSettings, now: int) -> None:
        self.name = name
        self.stale_after = _stale_after(name, settings)
        self.heard_at = now
        #: Whether it was ever heard, and whether that is too long ago.
        self.ever = False
        self.stale = False

    def _heard(self, now: int) -> None:
        self.heard_at = now
        self.ever = True
        self.stale = False

    def _turns_stale(self, now: int) -> bool:
        if self.stale or now - self.heard_at <= self.stale_after:
            return False
        self.stale = True
        return True


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
    """Presence, gaze or distance."""

    def __init__(self, name: str, settings: EngagementSettings, now: int) -> None:
        super().__init__(name, settings, now)
        self.near = settings.social_distance
        self._farthest = settings.farthest
        self._start_up = settings.start_up
        self.raw: float | None = None
        #: The wizard's verdict, or metres.
        self.forced: float | bool | None = None
        self.filter = self._made(*numbers(name, settings))

    def take(self, value: object, now: int) -> bool:
        """A sample, whatever it is; whether it is one."""
        meant = (
            samples.metres(value, self._farthest)
            if self.name == "distance"
            else samples.flag(value)
        )
        if meant is None:
            return False
        self.raw = float(value) if isinstance(value, bool) else samples.number(value)
        self._heard(now)
        self.filter.take(meant, now)
        return True

    def pass_to(self, now: int) -> None:
        """Time passes; a sensor that says nothing for too long is stale, and its queue empty."""
        if self._turns_stale(now):
            self.filter.forget()

    def configure(self, kind: str | None, count: int | None, threshold: float | None) -> None:
        """Another filter, or other numbers for it; it keeps what it holds as far as it fits."""
        old = self.filter
        count = old.places if count is None else count
        threshold = old.threshold if threshold is None else threshold
        if kind is None or kind == old.kind:
            old.configure(count, threshold)
        else:
            self.filter = self._made(kind, count, threshold)
            self.filter.resume(old.values)

    def adopt(self, settings: EngagementSettings, was: EngagementSettings) -> None:
        """Other settings; numbers that were set while running stay unless they were edited."""
        self.stale_after = _stale_after(self.name, settings)
        self._farthest = settings.farthest
        self._start_up = settings.start_up
        if numbers(self.name, settings) != numbers(self.name, was):
            self.configure(*numbers(self.name, settings))

    def near_within(self, metres: float) -> None:
        """Another social distance."""
        self.near = metres
        if self.name == "distance":
            self.filter.near_within(metres)

    def fresh(self, now: int) -> bool:
        """Whether somebody may count as engaged by it."""
        return self.forced is not None or now - self.heard_at <= FRESH

    @property
    def verdict(self) -> int | None:
        """1, 0, or None while there is none yet."""
        if self.forced is not None:
            if self.name == "distance" and not isinstance(self.forced, bool):
                return int(self.forced <= self.near)
            return int(self.forced)
        return 0 if self.stale else self.filter.verdict

    def words(self, now: int) -> str:
        """The verdict as a person says it: `looks (5 of 8)`."""
        verdict = self.verdict
        if verdict is None:
            return f"{self.name} not known yet ({len(self.filter.values)} of {self.filter.places})"
        if self.forced is None and (self.stale or not self.fresh(now)):
            return f"{self.name} {'stale' if self.ever else 'not sensed'}"
        said = WORDS[self.name][verdict]
        metres = self.metres
        if self.name == "distance" and metres is not None and math.isfinite(metres):
            said += f" {metres:.1f} m"
        return said + (" (wizard)" if self.forced is not None else self._share())

    @property
    def metres(self) -> float | None:
        """The distance that counts: the wizard's, or the last sample."""
        forced = self.forced
        return self.raw if forced is None else None if isinstance(forced, bool) else forced

    def shown(self) -> SignShown:
        """The sign as the screen shows it."""
        raw = self.metres if self.raw is None else self.raw
        return SignShown(
            raw=raw if raw is not None and math.isfinite(raw) else None,
            verdict=self.verdict,
            count=self.filter.count,
            needed=self.filter.needed,
            places=self.filter.places,
            filter=self.filter.kind,
            stale=self.stale and self.forced is None,
            forced=self.forced is not None,
        )

    def _share(self) -> str:
        filter_ = self.filter
        if not 0 < filter_.count < filter_.places:
            return ""
        return f" ({filter_.count} of {filter_.places})"

    def _made(self, kind: str, count: int, threshold: float) -> Fifo:
        near = self.near if self.name == "distance" else None
        if kind == "median" and near is not None:
            return Median(count, threshold, self._start_up, near)
        return Fifo(count, threshold, self._start_up, near)


class Identity(Heard):
    """Who the visitor is."""

    def __init__(self, settings: EngagementSettings, now: int) -> None:
        super().__init__("identity", settings, now)
        self.raw: str = ""
        #: The name that the wizard gives, which may be "Unknown".
        self.forced: str | None = None
        _, count, threshold = numbers("identity", settings)
        self.filter = IdentityFifo(count, threshold, settings.start_up)

    def take(self, value: object, text: str, now: int) -> bool:
        """A recognition, whatever it is; whether it is one."""
        name = samples.name(value, text)
        if name is None:
            return False
        self.raw = name
        self._heard(now)
        self.filter.take(name, now)
        return True

    def pass_to(self, now: int) -> None:
        """Time passes; what has not been heard for too long is forgotten."""
        if self._turns_stale(now):
            self.filter.forget()

    def configure(self, count: int | None, threshold: float | None) -> None:
        """Other numbers from now on."""
        old = self.filter
        old.configure(
            old.places if count is None else count,
            old.threshold if threshold is None else threshold,
        )

    def adopt(self, settings: EngagementSettings, was: EngagementSettings) -> None:
        """Other settings; numbers that were set while running stay unless they were edited."""
        self.stale_after = _stale_after(self.name, settings)
        if numbers(self.name, settings) != numbers(self.name, was):
            _, count, threshold = numbers(self.name, settings)
            self.configure(count, threshold)

    @property
    def name_given(self) -> str:
        """The ID, or "Unknown"."""
        return self.filter.name if self.forced is None else self.forced

    @property
    def known(self) -> bool:
        """Whether there is an ID."""
        return self.name_given != UNKNOWN

    def words(self) -> str:
        """Who it is, as a person says it."""
        if self.forced is not None:
            return f"{self.forced if self.known else 'no name'} (wizard)"
        if not self.known:
            return "no name"
        return f"{self.filter.name} ({self.filter.count} of {self.filter.places})"

    def shown(self) -> SignShown:
        """The sign as the screen shows it."""
        return SignShown(
            raw_name=self.raw,
            verdict=int(self.known) if self.forced is not None else self.filter.verdict,
            name=self.name_given,
            count=self.filter.count,
            needed=self.filter.needed,
            places=self.filter.places,
            filter=self.filter.kind,
            stale=self.stale and self.forced is None,
            forced=self.forced is not None,
        )
