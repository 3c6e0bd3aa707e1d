"""From the robot's values to readings: what makes no sense becomes null, with its reason."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from woz_drivers.pepper import memory, people
from woz_tui.core.driver import Outlet

#: What stays the same for hours is told this often: seldom, but not so that it looks stale.
_CALM_US = 1_000_000


@dataclass(frozen=True, slots=True)
class Refusal:
    """Instead of a value: why the robot gives none."""

    why: str


class Told:
    """Says what came of each round."""

    def __init__(self, outlet: Outlet) -> None:
        self._outlet = outlet
        self._heard: tuple[float, float] | None = None
        self._begun = False
        self._charge: float | None = None
        self._charged_us = outlet.clock.now_us() - _CALM_US

    def forget(self) -> None:
        """It may be another robot, with another clock."""
        self._heard, self._begun = None, False
        self._charged_us = self._outlet.clock.now_us() - _CALM_US

    def plain(self, sensor: str, value: float | None, said: Any, unit: str = "") -> None:
        """One number, as it was decoded from `said`."""
        if value is None:
            self.nothing(sensor, said)
        else:
            self._outlet.sensor(sensor, "ok")
            self._outlet.reading(sensor, value, unit=unit)

    def nothing(self, sensor: str, said: Any) -> None:
        """The robot has no value, or one that makes no sense."""
        self._outlet.sensor(sensor, "stale", _why(said))
        self._outlet.reading(sensor, None)

    def battery(self, said: Any) -> None:
        """The charge to the hundredth; while it stays the same, now and then."""
        charge = memory.battery(said)
        share = None if charge is None else round(charge, 2)
        now_us = self._outlet.clock.now_us()
        if share != self._charge or now_us - self._charged_us >= _CALM_US:
            self._charge, self._charged_us = share, now_us
            self.plain("battery", share, said)

    def sound(self, said: Any) -> None:
        """Where a sound came from, once for each; the first one found may be of yesterday."""
        if said is None or said in ([], ()):
            self._outlet.sensor("direction", "ok")
            self._begun = True
            return
        found = memory.sound(said)
        if found is None:
            self.nothing("direction", said)
            return
        self._outlet.sensor("direction", "ok")
        if found.stamp != self._heard and self._begun:
            self._outlet.reading("direction", round(found.degrees, 1), unit="deg")
        self._heard, self._begun = found.stamp, True

    def identity(self, said: Any) -> None:
        """Whose face it is: the name as text, the recognition's score as value."""
        found = people.face(said)
        if found is None:
            self.nothing("identity", said)
            return
        self._outlet.sensor("identity", "ok")
        score = found.score if found.name else 0.0
        self._outlet.reading("identity", score, text=found.name)

    def people(self, ids: Sequence[int], values: Mapping[str, Any], sensors: Sequence[str]) -> None:
        """How many there are, how far the nearest is, and whether they look at the robot; of
        somebody of whom nothing is known yet, only that they are there.
        """
        for sensor in ("presence", "people"):
            self._outlet.sensor(sensor, "ok")
        self._outlet.reading("presence", float(bool(ids)))
        self._outlet.reading("people", float(len(ids)))
        who = people.nearest(ids, values)
        if who is not None:
            said = values.get(people.distance_key(who.id))
            self.plain("nearest", who.distance, said, "m")
            looking = None if who.looking is None else float(who.looking)
            if "gaze" in sensors:
                self.plain("gaze", looking, values.get(people.looking_key(who.id)))
        elif not ids:
            self._outlet.sensor("nearest", "ok")
            self._outlet.reading("nearest", None, unit="m")
            if "gaze" in sensors:
                self.plain("gaze", 0.0, None)


def _why(said: Any) -> str:
    if said is None:
        return "the robot has no value for it"
    if isinstance(said, Refusal):
        return said.why
    return f"makes no sense: {memory.brief(said)}"
