"""The four signs of a visitor: sensed, made steady by a filter, overruled by the wizard."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Iterator
from typing import Any, Generic, TypeVar

from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_words import CONDITION, FILTERS, SIGNS
from woz_tui.protocol.envelope import Json
from woz_tui.protocol.messages import SignShown
from woz_tui.protocol.sentence import Sentence
from woz_tui.sensing import sample_values
from woz_tui.sensing.filters import Fifo, IdentityFifo, Median
from woz_tui.sensing.joint_filter import JointFilter, JointSign
from woz_tui.sensing.model_time import SECOND, microseconds
from woz_tui.sensing.sample_values import UNKNOWN

# -- thinning -------------------------------------------------------------------------------------
# Fewer samples than a quick sensor sends, so that the places of a queue last as long as meant.


class SampleThinning:
    """One sample in each period of a steady beat counts: the first that comes.

    The first sample of all lies in the middle of its period, so that a sensor of just this rate
    may be half a period early or late and loses nothing. A sample that counts does so at once, and
    which ones do follows from their times (the model's, in microseconds) alone. `rate`: samples a
    second; None: all count.
    """

    def __init__(self, rate: float | None) -> None:
        self.rate = rate
        self.restart()

    def restart(self) -> None:
        """The next sample is the first."""
        self._began: int | None = None
        self._last = 0

    def beats(self, rate: float | None) -> None:
        """Another rate from now on."""
        if rate != self.rate:
            self.rate = rate
            self.restart()

    def counts(self, now: int) -> bool:
        """Whether a sample at `now`, no earlier than the one before, is to be taken."""
        if self.rate is None:
            return True
        if self._began is None:
            self._began, self._last = now, 0
            return True
        period = int((now - self._began) * self.rate / SECOND + 0.5)
        counts = period > self._last
        self._last = period
        return counts


#: Nobody counts as engaged on samples older than this, whatever the settings say; microseconds.
FRESH = 2 * SECOND
#: What a verdict is called: no, yes.
WORDS = {
    "presence": (
        Sentence("signs.nobody", "nobody is there"),
        Sentence("signs.present", "present"),
    ),
    "gaze": (Sentence("signs.away", "looks away"), Sentence("signs.looks", "looks")),
    "distance": (Sentence("signs.far", "not near"), Sentence("signs.near", "near")),
}
#: What a sign is called where it has no verdict.
_NAMES = {
    "presence": Sentence("engagement.presence", "presence"),
    "gaze": Sentence("engagement.gaze", "gaze"),
    "distance": Sentence("engagement.distance", "distance"),
}
_NO_NAME = Sentence("signs.no_name", "no name")


Q = TypeVar("Q", Fifo, IdentityFifo)


class FilteredSign(Generic[Q]):
    """A sensor, when it was heard last, and its filters: a queue, and its view of the joint filter;
    one of them decides. The queue is filled in any case, so that it is there when it is asked
    again. Times are the model's, in microseconds.
    """

    def __init__(
        self, name: str, settings: EngagementSettings, joint: JointFilter, now: int
    ) -> None:
        self.name = name
        self._start_up = settings.start_up
        self.stale_after = _stale_after(name, settings)
        self._thinning = SampleThinning(settings.sign(name).rate)
        self.heard_at = now
        #: Whether it was ever heard, and whether that is too long ago.
        self.ever = self.stale = False
        #: What the wizard says, or whoever it is by.
        self.forced: Any = None
        self.forced_by = ""
        kind, count, threshold = filter_settings(name, settings)
        self._joint = joint.view(name)
        self._joint.configure(count, threshold)
        self._jointly = kind == "joint"
        self.queue: Q = self._made(kind, count, threshold)

    def _made(self, kind: str, count: int, threshold: float) -> Q:
        """A queue of a kind; the usual one if it has no such kind."""
        raise NotImplementedError

    @property
    def filter(self) -> Q | JointSign:
        """What makes the verdict."""
        return self._joint if self._jointly else self.queue

    def pass_to(self, now: int) -> None:
        """Time passes; a sensor that says nothing for too long is stale, and its queue empty."""
        if not self.stale and now - self.heard_at > self.stale_after:
            self.stale = True
            self.queue.forget()
            self._joint.forget()
            self._thinning.restart()

    def configure(self, kind: str | None, count: int | None, threshold: float | None) -> None:
        """Another filter, or other numbers for it; it keeps what it holds as far as it fits. None
        leaves a number as it is.
        """
        before = self.queue
        count = before.places if count is None else count
        threshold = before.threshold if threshold is None else threshold
        before.configure(count, threshold)
        self._joint.configure(count, threshold)
        if kind is None:
            return
        if kind not in ("joint", before.kind):
            self.queue = self._made(kind, count, threshold)
            self.queue.resume(before.values)
        if kind == "joint" and not self._jointly:
            self._joint.catch_up()
        if kind != "joint" and self._jointly:
            self._joint.leave()
        self._jointly = kind == "joint"

    def adopt(self, settings: EngagementSettings, before: EngagementSettings) -> None:
        """Go on with what is new in the settings."""
        self.stale_after = _stale_after(self.name, settings)
        self._start_up = self.queue.start_up = self._joint.start_up = settings.start_up
        self._thinning.beats(settings.sign(self.name).rate)
        new = filter_settings(self.name, settings)
        if new != filter_settings(self.name, before):
            self.configure(*new)

    def _takes(self, value: Any, now: int) -> None:
        self.heard_at = now
        self.ever = True
        self.stale = False
        if self._thinning.counts(now):
            self.queue.add(value, now)
            if self._jointly:
                self._joint.add(value, now)
            else:
                self._joint.overhear(value, now)

    def _shown(self, **raw: Any) -> SignShown:
        """The sign as the screen shows it, with what its sensor says."""
        chosen = self.filter
        return SignShown(
            **raw,
            count=chosen.count,
            needed=chosen.needed,
            places=chosen.places,
            filter=chosen.kind,
            stale=self.stale and self.forced is None,
            forced=self.forced is not None,
        )

    def _with_share(self, said: str) -> str:
        """With how many speak for it, unless all do or none."""
        chosen = self.filter
        if not 0 < chosen.count < chosen.places:
            return said
        if self._jointly:
            return Sentence("signs.per_cent", "{said} ({number} %)", said=said, number=chosen.count)
        return Sentence(
            "signs.share",
            "{said} ({number} of {places})",
            said=said,
            number=chosen.count,
            places=chosen.places,
        )

    def _with_hand(self, said: str) -> str:
        """With whoever says so by hand."""
        return Sentence("signs.by", "{said} ({by})", said=said, by=self.forced_by)


def _stale_after(name: str, settings: EngagementSettings) -> int:
    own = settings.sign(name).stale
    return microseconds(settings.stale if own is None else own)


def filter_settings(name: str, settings: EngagementSettings) -> tuple[str, int, float]:
    """The filter of a sign, its places and its threshold, as the settings have them."""
    own = settings.sign(name)
    kind = own.filter or settings.filter
    if kind == "median" and name != "distance":
        kind = "fifo"
    threshold = settings.threshold if own.threshold is None else own.threshold
    return kind, own.samples or settings.samples, threshold


class Sign(FilteredSign[Fifo]):
    """Presence, gaze or distance; `forced` is a verdict, or metres. `joint` is what all signs share
    that are filtered jointly.
    """

    def __init__(
        self, name: str, settings: EngagementSettings, joint: JointFilter, now: int
    ) -> None:
        self.near = settings.social_distance
        self._farthest = settings.farthest
        self.raw: float | None = None
        super().__init__(name, settings, joint, now)

    def add(self, value: object, now: int) -> bool:
        """A sample, whatever it is; whether it is one."""
        read = sample_values.FLAGS.get(self.name)
        understood = sample_values.metres(value, self._farthest) if read is None else read(value)
        if understood is None:
            return False
        self.raw = float(value) if isinstance(value, bool) else sample_values.number(value)
        self._takes(understood, now)
        return True

    def near_within(self, metres: float) -> None:
        """Another social distance."""
        self.near = metres
        if self.name == "distance":
            self.queue.near_within(metres)

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
            if self.ever:
                return Sentence("signs.stale", "{sign} stale", sign=_NAMES[self.name])
            return Sentence("signs.no_sensor", "no {sign} sensor", sign=_NAMES[self.name])
        if verdict is None or (self.forced is None and not self.ever):
            return Sentence("signs.unknown", "{sign} not known yet", sign=_NAMES[self.name])
        said = WORDS[self.name][verdict]
        metres = self.metres
        if self.name == "distance" and metres is not None and math.isfinite(metres):
            said = Sentence("signs.metres", "{said} {metres:.1f} m", said=said, metres=metres)
        return self._with_hand(said) if self.forced is not None else self._with_share(said)

    @property
    def metres(self) -> float | None:
        """The distance that counts: the wizard's, or the last sample."""
        forced = self.forced
        return self.raw if forced is None else None if isinstance(forced, bool) else forced

    def shown(self) -> SignShown:
        """The sign as the screen shows it; what is beyond all measure has no number."""
        raw = self.metres if self.raw is None else self.raw
        known = raw if raw is not None and math.isfinite(raw) else None
        return self._shown(raw=known, verdict=self.verdict)

    def _made(self, kind: str, count: int, threshold: float) -> Fifo:
        near = self.near if self.name == "distance" else None
        if kind == "median" and near is not None:
            return Median(count, threshold, self._start_up, near)
        return Fifo(count, threshold, self._start_up, near)


class IdentitySign(FilteredSign[IdentityFifo]):
    """Who the visitor is; `forced` is the name that the wizard gives, which may be "Unknown"."""

    forced: str | None
    raw = ""

    def add(self, value: object, text: str, now: int) -> bool:
        """A recognition, whatever it is; whether it is one."""
        name = sample_values.name(value, text)
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
            return int(self.has_name)
        return self.filter.verdict

    @property
    def has_name(self) -> bool:
        """Whether there is an ID."""
        return self.name_given != UNKNOWN

    def words(self, introduced: str = "") -> str:
        """Who it is, as a person says it; `introduced`: the name that somebody has given."""
        if introduced and not self.has_name:
            return Sentence("signs.known_as", "known as {name}", name=introduced)
        if self.forced is not None:
            return self._with_hand(self.forced if self.has_name else _NO_NAME)
        if not self.has_name:
            return _NO_NAME
        return self._with_share(self.name_given)

    def shown(self) -> SignShown:
        """The sign as the screen shows it."""
        return self._shown(raw_name=self.raw, verdict=self.verdict, name=self.name_given)

    def _made(self, kind: str, count: int, threshold: float) -> IdentityFifo:
        return IdentityFifo(count, threshold, self._start_up)


# -- condition ------------------------------------------------------------------------------------
# All signs of a visitor together: whether somebody is there, and with the robot.
#
# The condition of engagement is that every sign which the experiment uses says yes, and has been
# sensed lately.

#: Social distances that may be set, in metres.
NEAREST, FARTHEST = 0.1, 10.0


class Signs:
    """Presence, gaze, distance and identity. Times are the model's, in microseconds."""

    def __init__(self, settings: EngagementSettings, now: int) -> None:
        self._joint = JointFilter(
            settings.social_distance, start_up=settings.start_up, glance=settings.joint.glance
        )
        self._by_name = {name: Sign(name, settings, self._joint, now) for name in CONDITION}
        self.identity = IdentitySign("identity", settings, self._joint, now)
        self._all: list[Sign | IdentitySign] = [*self._by_name.values(), self.identity]
        self.uses: list[Sign] = []
        self._use(settings)

    # -- what comes in --------------------------------------------------------------------------

    def pass_to(self, now: int) -> None:
        for sign in self._all:
            sign.pass_to(now)

    def add(self, sign: str, value: object, name: str, now: int) -> bool:
        """A sample, whatever it is; whether it is one. ValueError if there is no such sign."""
        if sign == "identity":
            return self.identity.add(value, name, now)
        return self._sign(sign).add(value, now)

    def override(self, sign: str, value: object | None, name: str, by: str) -> None:
        """What the wizard says, or another by whom; ValueError with a sentence if it makes no
        sense.
        """
        known = sign == "identity"
        chosen: FilteredSign[Any] = self.identity if known else self._sign(sign)
        chosen.forced = _name(value, name) if known else _verdict(sign, value)
        short = by.removeprefix("the ").removeprefix("a ")
        chosen.forced_by = by.spelt(short) if isinstance(by, Sentence) else short

    def configure(
        self, sign: str, kind: str | None, count: int | None, threshold: float | None
    ) -> None:
        """Another filter, or other numbers; ValueError with a sentence if there are not such."""
        if sign not in SIGNS:
            raise ValueError(f"{sign!r} is none of {', '.join(SIGNS)}")
        if kind is not None and kind not in FILTERS:
            raise ValueError(f"{kind!r} is none of {', '.join(FILTERS)}")
        if kind == "median" and sign != "distance":
            raise ValueError(f"a median is for distance, not for {sign}")
        if count is not None and not 1 <= count <= 1000:
            raise ValueError(f"{count} is not 1 to 1000 places")
        if threshold is not None and not 0 <= threshold <= 1:
            raise ValueError(f"{threshold:g} is not 0 to 1")
        chosen = self.identity if sign == "identity" else self._by_name[sign]
        chosen.configure(kind, count, threshold)

    def near_within(self, metres: float) -> None:
        """Another social distance; ValueError outside of 0.1 to 10 m."""
        if not NEAREST <= metres <= FARTHEST:
            raise ValueError(f"{metres:g} m is not {NEAREST:g} to {FARTHEST:g} m")
        self._joint.near_within(metres)
        for sign in self._by_name.values():
            sign.near_within(metres)

    def adopt(self, settings: EngagementSettings, before: EngagementSettings) -> None:
        """Go on with what is new in the settings."""
        for sign in self._all:
            sign.adopt(settings, before)
        if settings.social_distance != before.social_distance:
            self.near_within(settings.social_distance)
        if settings.joint != before.joint:
            self._joint.glances_last(settings.joint.glance)
        self._use(settings)

    # -- how they stand -------------------------------------------------------------------------

    @property
    def near(self) -> float:
        """The social distance in metres."""
        return self._by_name["distance"].near

    def engaged(self, now: int) -> bool:
        """The condition of engagement."""
        return bool(self.uses) and all(sign.verdict == 1 and sign.fresh(now) for sign in self.uses)

    @property
    def present(self) -> bool:
        """Whether somebody is there: by presence, or by any sign used if presence is not."""
        return any(sign.verdict == 1 for sign in self._there)

    @property
    def verdicts(self) -> dict[str, Json]:
        """Presence, gaze, distance (near) as 0, 1 or None; identity as a name or "Unknown"."""
        found: dict[str, Json] = {name: sign.verdict for name, sign in self._by_name.items()}
        return {**found, "identity": self.identity.name_given}

    @property
    def stale(self) -> list[str]:
        """Those whose sensors were heard once, and are not heard any more."""
        return [sign.name for sign in self._all if sign.stale and sign.ever]

    def reason(self, now: int, introduced: str) -> str:
        """What they say, in words; `introduced` is the name that somebody has given."""
        return _listed([*(sign.words(now) for sign in self.uses), self.identity.words(introduced)])

    def explained(self, why: Sentence, now: int, introduced: str) -> Sentence:
        """`why`, with `reason` as what all say and `absence` as why nobody is there."""
        nobody: str = WORDS["presence"][0]
        absence = _listed([sign.words(now) for sign in self._there]) or nobody
        if not absence.startswith(nobody):
            absence = Sentence("signs.nobody_by", "{nobody}: {why}", nobody=nobody, why=absence)
        return why.filled(reason=self.reason(now, introduced), absence=absence)

    def shown(self) -> dict[str, SignShown]:
        """All of them for the screen."""
        return {sign.name: sign.shown() for sign in self._all}

    def overruled(self, presence: bool, condition: bool, name: bool) -> bool:
        """Whether the wizard has a hand in presence, in the condition, or in the name."""
        signs = [*(self._there if presence else ()), *(self.uses if condition else ())]
        return any(sign.forced is not None for sign in signs) or (
            name and self.identity.forced is not None
        )

    def deadlines(self) -> Iterator[int]:
        """When they grow stale, or too old to engage anybody, if no sample comes."""
        for sign in self._all:
            if not sign.stale:
                yield sign.heard_at + sign.stale_after + 1
        yield from (sign.heard_at + FRESH + 1 for sign in self.uses)

    def _use(self, settings: EngagementSettings) -> None:
        self.uses = [sign for name, sign in self._by_name.items() if name in settings.signs]
        presence = self._by_name["presence"]
        self._there = [presence] if presence in self.uses else self.uses

    def _sign(self, name: str) -> Sign:
        if name not in self._by_name:
            raise ValueError(f"{name!r} is none of {', '.join(SIGNS)}")
        return self._by_name[name]


def _listed(words: Iterable[str]) -> str:
    """One behind the other, with commas."""
    return functools.reduce(_and, words, "")


def _and(first: str, more: str) -> str:
    return Sentence("signs.listed", "{first}, {more}", first=first, more=more) if first else more


def _verdict(sign: str, value: object | None) -> float | bool | None:
    if value is None or isinstance(value, bool):
        return value
    number = sample_values.number(value)
    if sign == "distance":
        if number is None or not number >= 0.0:
            raise ValueError(f"{value!r} is no distance: a number of metres, on or off")
        return number
    if number not in (0.0, 1.0):
        raise ValueError(f"{value!r} is no verdict on {sign}: on or off")
    return bool(number)


def _name(value: object | None, name: str) -> str | None:
    if value is None and not name:
        return None
    found = sample_values.name(value if isinstance(value, str) else "", name)
    if found is None:
        raise ValueError(f"{name or value!r} is no name of a visitor")
    return found
