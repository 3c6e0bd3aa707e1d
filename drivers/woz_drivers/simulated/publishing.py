"""Publishes the simulated robot's readings, as far as break-downs let them through."""

from __future__ import annotations

import math
from collections.abc import Sequence

from woz_drivers.simulated.body import SimulatedRobotBody
from woz_drivers.simulated.faults import ActiveFaults
from woz_drivers.simulated.senses import UNITS, Sample
from woz_tui.drivers.contract import DriverContext

#: Joints and base are published this often when nothing moves, in seconds; else at every tick.
CALM = 1.0

#: So many samples may be published at once: those of a second and a half.
MANY = 50


class Publisher:
    """Body and visitor as readings."""

    def __init__(self, context: DriverContext, faults: ActiveFaults) -> None:
        self._context = context
        self._faults = faults
        self._last: dict[str, float | None] = {}
        self._was_moving = True
        self._calm_until = -math.inf

    def body(self, body: SimulatedRobotBody, now: float) -> None:
        """Joints and base: always while something moves, once when it ends, else now and then."""
        moving = body.moving
        if not (moving or self._was_moving or now >= self._calm_until):
            return
        self._was_moving = moving
        self._calm_until = now + CALM
        for name, joint in body.joints.items():
            self._publish(f"joint.{name}", round(joint.present, 2), now, unit="deg")
            self._publish(f"setpoint.{name}", round(joint.setpoint, 2), now, unit="deg")
        self._publish("base.x", round(body.base.x, 3), now, unit="m")
        self._publish("base.y", round(body.base.y, 3), now, unit="m")
        self._publish("base.heading", round(body.base.heading, 1), now, unit="deg")

    def samples(self, samples: Sequence[Sample], now: float) -> None:
        """What a visitor leaves in the sensors: all of it, so that being late now and then changes
        nothing; of much at once, as in a world that runs fast, the last of each sensor.
        """
        if len(samples) > MANY:
            samples = list({sample.sensor: sample for sample in samples}.values())
        for sample in samples:
            self._publish(
                sample.sensor,
                sample.value,
                now,
                text=sample.text,
                unit=UNITS.get(sample.sensor, ""),
            )

    def silent(self, sensor: str, now: float) -> bool:
        """Whether a sensor is silent."""
        return self._faults.holding("silent", sensor, now) is not None

    def broken(self, sensor: str, value: float | None, now: float) -> float | None:
        """The reading of a sensor for `value`: another one while it is broken."""
        if self._faults.holding("nan", sensor, now):
            return math.nan
        if self._faults.holding("stuck", sensor, now):
            return self._last.get(sensor, value)
        self._last[sensor] = value
        return value

    def _publish(
        self, sensor: str, value: float | None, now: float, *, text: str = "", unit: str = ""
    ) -> None:
        if not self.silent(sensor, now):
            self._context.reading(sensor, self.broken(sensor, value, now), text=text, unit=unit)
