"""Setpoints: planned ahead, and followed live.

Nothing here knows a wire or a clock; times are seconds that somebody else counts, angles degrees.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from woz_tui.motion.safety import Limits

#: Peak speed and peak acceleration of a minimum-jerk move over its mean speed d/T and d/T^2
#: (Flash & Hogan 1985: s = 10 u^3 - 15 u^4 + 6 u^5).
JERK_SPEED = 1.875
JERK_ACCELERATION = 10 / math.sqrt(3)
#: A followed target is approached as if the joint reached full speed in this time, where no
#: acceleration limit is set.
FOLLOW_RAMP_S = 0.15
#: Closer than this a setpoint has arrived.
ARRIVED = 1e-6


@dataclass(frozen=True, slots=True)
class MotionSegment:
    """One joint from `start` to `goal` in `duration` seconds.

    `ramp` is the time to and from full speed of a trapezoid; None means minimum jerk.
    """

    start: float
    goal: float
    duration: float
    ramp: float | None = None

    def at(self, t: float) -> float:
        """The angle `t` seconds after the start; before and after it the joint stands."""
        if t <= 0:
            return self.start
        if t >= self.duration:
            return self.goal
        way = self.goal - self.start
        if self.ramp is None:
            u = t / self.duration
            return self.start + way * u * u * u * (10 - 15 * u + 6 * u * u)
        return self.start + way * _trapezoid(t, self.duration, self.ramp)


def _trapezoid(t: float, duration: float, ramp: float) -> float:
    speed = 1 / (duration - ramp)
    if t < ramp:
        return speed * t * t / (2 * ramp)
    if t > duration - ramp:
        left = duration - t
        return 1 - speed * left * left / (2 * ramp)
    return speed * (t - ramp / 2)


def shortest_duration(distance: float, limits: Limits) -> float:
    """The least time for `distance` degrees from rest to rest, in seconds."""
    way = abs(distance)
    if limits.acceleration is None:
        return way / limits.speed
    if way < limits.speed**2 / limits.acceleration:
        return 2 * math.sqrt(way / limits.acceleration)
    return way / limits.speed + limits.speed / limits.acceleration


def plan_segment(
    start: float, goal: float, duration: float, limits: Limits, profile: str
) -> MotionSegment:
    """A segment within the limits; `duration` is at least `shortest_duration(...)`.

    Minimum jerk peaks at 1.875 times the mean speed. Where that would be too fast, a trapezoid
    with its flat top at the limit still arrives in time.
    """
    way = abs(goal - start)
    if way <= ARRIVED:  # nothing to travel, and nothing to divide by
        return MotionSegment(goal, goal, duration)
    top = limits.acceleration if limits.acceleration is not None else math.inf
    if (
        profile == "minimum-jerk"
        and JERK_SPEED * way / duration <= limits.speed
        and JERK_ACCELERATION * way / duration**2 <= top
    ):
        return MotionSegment(start, goal, duration)
    gentlest = duration - way / limits.speed
    ramp = min(duration / 4 if profile == "trapezoid" else gentlest, gentlest, duration / 2)
    if math.isfinite(top):
        ramp = max(ramp, _least_ramp(way, duration, top))
    return MotionSegment(start, goal, duration, max(ramp, 0.0))


def _least_ramp(way: float, duration: float, acceleration: float) -> float:
    """The shortest ramp that needs no more than `acceleration`."""
    root = duration**2 - 4 * way / acceleration
    return (duration - math.sqrt(max(root, 0.0))) / 2


@dataclass(frozen=True, slots=True)
class Keyframe:
    """Angles to be reached `seconds` after the keyframe before; joints left out stay."""

    joints: Mapping[str, float]
    seconds: float


@dataclass(frozen=True, slots=True)
class JointTrack:
    """One joint's segments, one after the other."""

    segments: tuple[MotionSegment, ...]

    @property
    def goal(self) -> float:
        """Where it ends."""
        return self.segments[-1].goal

    def at(self, t: float) -> float:
        """The angle `t` seconds after the start of the first segment."""
        for part in self.segments[:-1]:
            if t < part.duration:
                return part.at(t)
            t -= part.duration
        return self.segments[-1].at(t)


@dataclass(frozen=True, slots=True)
class MotionPlan:
    """A whole movement.

    `clamped` holds, by joint, the angle that was asked for furthest outside the range; `late` the
    seconds by which it arrives later than asked.
    """

    tracks: Mapping[str, JointTrack]
    duration: float
    late: float
    clamped: Mapping[str, float] = field(default_factory=dict)


def plan_motion(
    start: Mapping[str, float],
    frames: Sequence[Keyframe],
    limits: Mapping[str, Limits],
    profile: str,
) -> MotionPlan:
    """Plan keyframes from the setpoints `start`; every joint arrives at a keyframe together.

    Only joints in `start` and in some keyframe move. A keyframe whose time is too short for the
    slowest joint takes as long as that joint needs at full speed. Times of 0 or less, and NaN,
    mean: as fast as the limits allow. Angles must be finite.
    """
    moving = [name for name in start if any(name in frame.joints for frame in frames)]
    position = {name: start[name] for name in moving}
    segments: dict[str, list[MotionSegment]] = {name: [] for name in moving}
    clamped: dict[str, float] = {}
    duration = asked = 0.0
    for frame in frames:
        goals = dict(position)
        for name, angle in frame.joints.items():
            if name in goals:
                goals[name] = limits[name].clamp(angle)
                if goals[name] != angle:
                    clamped[name] = _further_out(limits[name], clamped.get(name), angle)
        wanted = frame.seconds if math.isfinite(frame.seconds) and frame.seconds > 0 else 0.0
        needed = max(
            (shortest_duration(goals[name] - position[name], limits[name]) for name in moving),
            default=0.0,
        )
        seconds = max(wanted, needed)
        for name in moving:
            segments[name].append(
                plan_segment(position[name], goals[name], seconds, limits[name], profile)
            )
        position = goals
        duration += seconds
        asked += wanted if wanted > 0 else seconds
    tracks = {name: JointTrack(tuple(parts)) for name, parts in segments.items()}
    return MotionPlan(tracks, duration, max(0.0, duration - asked), clamped)


def _further_out(limits: Limits, known: float | None, angle: float) -> float:
    if known is None:
        return angle
    return max(known, angle, key=lambda value: abs(value - limits.clamp(value)))


@dataclass(slots=True)
class TargetFollower:
    """One joint after a target that keeps moving (gaze, arrow keys): quick, but never abrupt."""

    limits: Limits
    target: float
    speed: float = 0.0

    def step(self, position: float, elapsed: float) -> float:
        """The next setpoint after `elapsed` seconds; keeps the speed for the step after."""
        if elapsed <= 0:
            return position
        acceleration = self.limits.acceleration or self.limits.speed / FOLLOW_RAMP_S
        way = self.target - position
        # Fast enough to get there within this step, slow enough to stop at the target.
        wanted = min(self.limits.speed, abs(way) / elapsed, math.sqrt(2 * acceleration * abs(way)))
        wanted = math.copysign(wanted, way)
        change = acceleration * elapsed
        self.speed = min(max(wanted, self.speed - change), self.speed + change)
        moved = position + self.speed * elapsed
        if abs(way) <= abs(self.speed) * elapsed and way * self.speed >= 0:
            moved, self.speed = self.target, 0.0
        return moved

    def arrived(self, position: float) -> bool:
        """Whether nothing is left to do."""
        return abs(position - self.target) <= ARRIVED and abs(self.speed) <= ARRIVED
