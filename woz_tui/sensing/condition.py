"""All signs of a visitor together: whether somebody is there, and with the robot.

The condition of engagement is that every sign which the experiment uses says yes, and has been
sensed lately.
"""

from __future__ import annotations

from collections.abc import Iterator

from woz_tui.core.engaged import SignShown
from woz_tui.core.envelope import Json
from woz_tui.experiment.engagement import CONDITION, FILTERS, SIGNS, EngagementSettings
from woz_tui.sensing import samples
from woz_tui.sensing.joint import Joint
from woz_tui.sensing.signs import FRESH, WORDS, Identity, Sign

#: Social distances that may be set, in metres.
NEAREST, FARTHEST = 0.1, 10.0


class Signs:
    """Presence, gaze, distance and identity. Times are the model's, in microseconds."""

    def __init__(self, settings: EngagementSettings, now: int) -> None:
        self._joint = Joint(
            settings.social_distance, start_up=settings.start_up, glance=settings.joint.glance
        )
        self._by_name = {name: Sign(name, settings, self._joint, now) for name in CONDITION}
        self.identity = Identity(settings, self._joint, now)
        self.uses: list[Sign] = []
        self._use(settings)

    # -- what comes in --------------------------------------------------------------------------

    def pass_to(self, now: int) -> None:
        """Time passes."""
        for sign in self._by_name.values():
            sign.pass_to(now)
        self.identity.pass_to(now)

    def take(self, sign: str, value: object, name: str, now: int) -> bool:
        """A sample, whatever it is; whether it is one. ValueError if there is no such sign."""
        if sign == "identity":
            return self.identity.take(value, name, now)
        return self._sign(sign).take(value, now)

    def override(self, sign: str, value: object | None, name: str) -> None:
        """What the wizard says; ValueError with a sentence if it makes no sense."""
        if sign == "identity":
            self.identity.forced = _name(value, name)
        else:
            self._sign(sign).forced = _verdict(sign, value)

    def configure(
        self, sign: str, kind: str | None, count: int | None, threshold: float | None
    ) -> None:
        """Another filter, or other numbers; ValueError with a sentence if there are not such."""
        _check(sign, kind, count, threshold)
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
        for sign in (*self._by_name.values(), self.identity):
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
        everyone = (*self._by_name.values(), self.identity)
        return [sign.name for sign in everyone if sign.stale and sign.ever]

    def reason(self, now: int, told: str) -> str:
        """What they say, in words; `told` is the name that somebody has given."""
        return ", ".join([*(sign.words(now) for sign in self.uses), self.identity.words(told)])

    def explained(self, why: str, now: int, told: str) -> str:
        """`why`, with `{reason}` as what all say and `{absence}` as why nobody is there."""
        return why.format(reason=self.reason(now, told), absence=self._absence(now))

    def _absence(self, now: int) -> str:
        said = ", ".join(sign.words(now) for sign in self._there)
        nobody = WORDS["presence"][0]
        return said if said.startswith(nobody) else ": ".join(filter(None, (nobody, said)))

    def shown(self) -> dict[str, SignShown]:
        """All of them for the screen."""
        found = {name: sign.shown() for name, sign in self._by_name.items()}
        return {**found, "identity": self.identity.shown()}

    def overruled(self, presence: bool, condition: bool, name: bool) -> bool:
        """Whether the wizard has a hand in presence, in the condition, or in the name."""
        signs = [*(self._there if presence else ()), *(self.uses if condition else ())]
        return any(sign.forced is not None for sign in signs) or (
            name and self.identity.forced is not None
        )

    def deadlines(self) -> Iterator[int]:
        """When they grow stale, or too old to engage anybody, if no sample comes."""
        for sign in (*self._by_name.values(), self.identity):
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


def _verdict(sign: str, value: object | None) -> float | bool | None:
    if value is None or isinstance(value, bool):
        return value
    number = samples.number(value)
    if sign == "distance":
        if number is None or not number > 0.0:
            raise ValueError(f"{value!r} is no distance: a number of metres, on or off")
        return number
    if number not in (0.0, 1.0):
        raise ValueError(f"{value!r} is no verdict on {sign}: on or off")
    return bool(number)


def _name(value: object | None, name: str) -> str | None:
    if value is None and not name:
        return None
    found = samples.name(value if isinstance(value, str) else "", name)
    if found is None:
        raise ValueError(f"{name or value!r} is no name of a visitor")
    return found


def _check(sign: str, kind: str | None, count: int | None, threshold: float | None) -> None:
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
