"""Limits every setpoint before it leaves for the servos: range, speed, acceleration.

Every angle that leaves is finite, in range, and no further from the one before than speed and
acceleration allow. Nothing asked from outside can change that, and nothing makes it raise.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from woz_tui.motion.body_shape import JointShape

#: Time that counts in one step at most, in seconds. A process that was suspended goes on from
#: where it stood; a tick that is late by less is caught up with.
LONGEST_S = 0.1
#: How many names of joints that do not exist are told a step.
_MOST_NAMED = 16


@dataclass(frozen=True, slots=True)
class Limits:
    """What a joint may do: degrees, degrees a second, degrees a second squared."""

    low: float
    high: float
    speed: float
    acceleration: float | None = None

    @classmethod
    def of(cls, joint: JointShape) -> Limits:
        """Those of a joint as the robot file describes it."""
        return cls(joint.min, joint.max, joint.speed, joint.acceleration)

    def clamp(self, angle: float) -> float:
        """The nearest angle inside; NaN has none: `ValueError`."""
        if math.isnan(angle):
            raise ValueError("not a number")
        return min(max(angle, self.low), self.high)

    def clamp_beside(self, angle: float, last: float) -> float:
        """The nearest angle inside, for a joint that stands at `last`.

        One that was found outside its range need not come in, but gets no further out.
        """
        return min(max(angle, min(self.low, last)), max(self.high, last))


def limited_setpoint(limits: Limits, last: float, wanted: float, elapsed: float) -> float:
    """The setpoint that may follow `last` after `elapsed` seconds, acceleration aside.

    In range, no step beyond the speed limit, never NaN (then `last` stays). A joint found outside
    its range is not dragged back in without a command; it just cannot get further out.
    """
    if not math.isfinite(wanted):
        return last
    step = limits.speed * max(elapsed, 0.0) if math.isfinite(elapsed) else 0.0
    return min(max(limits.clamp_beside(wanted, last), last - step), last + step)


@dataclass(slots=True)
class LimitedJoint:
    """One joint's setpoint: where it is, how fast it goes, and where it may go next.

    `speed` is that of the last step, in degrees a second with sign. `landed`: the last step ended
    on the angle wanted, slowly enough to stand still from one step to the next. So with a speed of
    no more than acceleration times step, a wanted line is followed without any lag.
    """

    limits: Limits
    position: float
    speed: float = 0.0
    landed: bool = True

    def step(self, wanted: float | None, dt: float) -> float:
        """The setpoint `dt` seconds later; `wanted` None: stand still as soon as possible.

        `wanted` must be finite and `dt` more than 0. A wanted angle that stays where it is is
        never overshot, whatever the steps to come: before each one, what is left of the way is at
        least the distance that braking takes.
        """
        acceleration = self.limits.acceleration
        if acceleration is not None:
            goal = None if wanted is None else self.limits.clamp_beside(wanted, self.position)
            self._accelerate(goal, dt, acceleration)
        elif wanted is not None:
            self.position = limited_setpoint(self.limits, self.position, wanted, dt)
        return self.position

    def stand(self, position: float) -> None:
        """Begin anew at `position`, at rest."""
        self.position, self.speed, self.landed = position, 0.0, True

    def _accelerate(self, goal: float | None, dt: float, acceleration: float) -> None:
        change = acceleration * dt
        slowest, fastest = self.speed - change, self.speed + change
        if self.landed:
            slowest, fastest = min(slowest, 0.0), max(fastest, 0.0)
        way = 0.0 if goal is None else goal - self.position
        most = min(self.limits.speed, change)
        if goal is not None and abs(way) <= most * dt and slowest * dt <= way <= fastest * dt:
            self.position, self.speed, self.landed = goal, way / dt, True
            return
        speed = min(max(_approach(way, dt, acceleration), slowest), fastest)
        self.speed = min(max(speed, -self.limits.speed), self.limits.speed)
        self.landed = False
        moved = self.limits.clamp_beside(self.position + self.speed * dt, self.position)
        if moved == self.position:
            self.speed, self.landed = 0.0, True
        self.position = moved


def _approach(way: float, dt: float, acceleration: float) -> float:
    """The highest speed at which, after `dt` seconds of it, there is still room to brake.

    Solves v dt + v^2 / 2a = way. Steps that brake cover less ground than v^2 / 2a however long
    each of them is, so this holds for steps of any length.
    """
    left = abs(way)
    return math.copysign(2 * left / (dt + math.sqrt(dt * dt + 2 * left / acceleration)), way)


class Safety:
    """The joints of a body, bounded step by step.

    Attributes:
        last: The setpoints that left last, in degrees; one for each joint of the body, always.
        rejected: What the last `step` or `restart` did not take: joint -> why. A joint that is
            named here stands still (as soon as its acceleration allows).
    """

    def __init__(self, joints: Mapping[str, JointShape], start: Mapping[str, float]) -> None:
        self._joints = {
            name: LimitedJoint(Limits.of(joint), joint.home) for name, joint in joints.items()
        }
        self.restart(start)

    def restart(self, present: Mapping[str, float]) -> None:
        """Begin at the pose in which the joints were found, at rest, before anything moves.

        Joints that are left out, or of which there is no finite angle, stay where they are. One
        found outside its range may only come back in, at its speed.
        """
        rejected = self._unknown_joints(present)
        for name, joint in self._joints.items():
            if name not in present:
                joint.stand(joint.position)
                continue
            angle = finite_number(present[name])
            if angle is None:
                rejected[name] = _angle_problem(present[name])
            joint.stand(joint.position if angle is None else angle)
        self._publish(rejected)

    def step(self, wanted: Mapping[str, object], dt: float) -> Mapping[str, float]:
        """The setpoints `dt` seconds after the last ones, in degrees.

        `wanted` may hold anything: what is no finite number is named in `rejected`. Of `dt`, no
        more than `LONGEST_S` counts; 0, a negative one and NaN change nothing.
        """
        rejected = self._unknown_joints(wanted)
        seconds = finite_number(dt)
        elapsed = min(seconds, LONGEST_S) if seconds is not None else 0.0
        if dt == math.inf:
            elapsed = LONGEST_S
        for name, joint in self._joints.items():
            angle = finite_number(wanted[name]) if name in wanted else None
            if angle is None:
                rejected[name] = _angle_problem(wanted[name]) if name in wanted else "is missing"
            if elapsed > 0:
                joint.step(angle, elapsed)
        self._publish(rejected)
        return self.last

    def _unknown_joints(self, given: Iterable[object]) -> dict[str, str]:
        strange = [name for name in given if name not in self._joints][:_MOST_NAMED]
        return {str(name)[:80]: "there is no such joint" for name in strange}

    def _publish(self, rejected: Mapping[str, str]) -> None:
        self.rejected = rejected
        self.last: Mapping[str, float] = MappingProxyType(
            {name: one.position for name, one in self._joints.items()}
        )


def finite_number(value: object) -> float | None:
    """`value` as a finite number, or None; a flag is none."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        converted = float(value)
    except OverflowError:  # a whole number beyond any float
        return None
    return converted if math.isfinite(converted) else None


def _angle_problem(value: object) -> str:
    if isinstance(value, float):
        return f"{value} is no angle"
    return (
        f"{repr(value)[:60]} is no angle"
        if isinstance(value, str)
        else (f"{type(value).__name__} is no angle")
    )
