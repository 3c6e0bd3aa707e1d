"""Degrees of a joint <-> counts of its servo."""

from __future__ import annotations

import math
from dataclasses import dataclass

from woz_drivers.dynamixel.settings import Joint
from woz_drivers.dynamixel.tables import Model

#: Counts that extended position control accepts to either side.
MULTI_TURN = 1_048_575


@dataclass(frozen=True, slots=True)
class Calibration:
    """How one joint's degrees and its servo's counts belong together.

    `low` and `high` are the joint's limits in degrees after the servo's own limits were taken
    into account (`low > high`: the two do not meet); `low_raw` and `high_raw` the counts that the
    servo accepts as a goal.
    """

    model: Model
    zero: int
    degrees_per_count: float
    low: float
    high: float
    low_raw: int
    high_raw: int

    def degrees(self, raw: int) -> float:
        """The joint's angle at the servo's count `raw`."""
        return (raw - self.zero) * self.degrees_per_count

    def raw(self, degrees: float) -> int:
        """The count for an angle, bounded by the servo's own limits; NaN is refused."""
        if not math.isfinite(degrees):
            raise ValueError(f"{degrees} degrees cannot be written to a servo")
        count = self.zero + round(degrees / self.degrees_per_count)
        return min(max(count, self.low_raw), self.high_raw)

    def speed_count(self, degrees_per_s: float) -> int:
        """Speed register for the joint's speed, rounded up, at least 1 (0 means no limit)."""
        servo_speed = degrees_per_s * self.model.degrees_per_step / abs(self.degrees_per_count)
        top = 32_767 if self.model.table.protocol == 2 else 1023
        return min(max(1, math.ceil(servo_speed / self.model.speed_unit)), top)

    def goal_value(self, raw: int, degrees_per_s: float) -> int:
        """The number for the table's `goal_block`: the goal, in protocol 1 with the speed."""
        table = self.model.table
        if table.goal_block() == table.goal:
            return raw
        return raw | self.speed_count(degrees_per_s) << 8 * table.goal.size


def calibrate(joint: Joint, model: Model, servo_limits: tuple[int, int] | None) -> Calibration:
    """Put a joint's settings, its model and the limits stored in the servo together.

    Args:
        joint: The settings.
        model: What answered the ping.
        servo_limits: Lowest and highest goal that the servo accepts; None in modes that know no
            limits (several turns).
    """
    zero = joint.zero if joint.zero is not None else model.centre
    per_count = joint.direction * model.degrees_per_step / joint.gear
    low, high = joint.min, joint.max
    if servo_limits is None:
        return Calibration(model, zero, per_count, low, high, -MULTI_TURN, MULTI_TURN)
    reach = sorted((limit - zero) * per_count for limit in servo_limits)
    low, high = max(low, reach[0]), min(high, reach[1])
    return Calibration(model, zero, per_count, low, high, *servo_limits)
