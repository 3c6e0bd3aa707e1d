"""Joints and base of the simulated robot, moved by asking for the time.

All times are seconds of the simulated world. The joints follow their setpoints with a limited
speed, as servos do; the base drives straight to its goal while it turns.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from woz_drivers.simulated.settings import SimulatedJoint

#: Joints move in steps of this length, whatever the rate at which the body is looked at.
STEP = 0.02

#: A joint this near to its setpoint has arrived, in degrees.
ARRIVED = 0.05


def clamp(value: float, low: float, high: float) -> float:
    """`value`, or the limit it lies beyond."""
    return min(max(value, low), high)


class MovingJoint:
    """One joint: a track of setpoints to come, and an angle that follows."""

    def __init__(self, limits: SimulatedJoint) -> None:
        self.limits = limits
        self.setpoint = limits.home
        self.present = limits.home
        self._from = (0.0, limits.home)
        self._track: list[tuple[float, float]] = []

    @property
    def still(self) -> bool:
        """Whether it stands where it should and nothing more is to come."""
        return not self._track and abs(self.present - self.setpoint) <= ARRIVED

    @property
    def goal(self) -> float:
        """Where the track leads, in degrees."""
        return self._track[-1][1] if self._track else self.setpoint

    def follow(self, now: float, track: Iterable[tuple[float, float]]) -> None:
        """Forget the old track; be at `degrees` at `time` for each (time, degrees) of the new."""
        low, high = self.limits.low, self.limits.high
        self._from = (now, self.setpoint)
        self._track = [(time, clamp(degrees, low, high)) for time, degrees in track]

    def freeze(self) -> None:
        """Stay at the present angle."""
        self._track.clear()
        self._from = (0.0, self.present)
        self.setpoint = self.present

    def advance(self, now: float, seconds: float) -> None:
        """Move on to `now`, `seconds` after the last time."""
        self.setpoint = self._planned(now)
        reach = self.limits.speed * seconds
        self.present += clamp(self.setpoint - self.present, -reach, reach)

    def _planned(self, now: float) -> float:
        while self._track and self._track[0][0] <= now:
            self._from = self._track.pop(0)
        begin, start = self._from
        if not self._track:
            return start if now >= begin else self.setpoint
        end, goal = self._track[0]
        share = (now - begin) / (end - begin)
        return start + (goal - start) * (1 - math.cos(math.pi * clamp(share, 0, 1))) / 2


class MovingBase:
    """Where the robot stands in the room: metres from its start, x forward, y left; degrees."""

    def __init__(self) -> None:
        self.x = self.y = self.heading = 0.0
        self._begin = self._end = 0.0
        self._start = self._goal = (0.0, 0.0, 0.0)
        self.moving = False

    def drive(self, now: float, seconds: float, x: float, y: float, turn: float) -> None:
        """Go `x` metres forward and `y` to the left, turning by `turn` degrees, in `seconds`."""
        angle = math.radians(self.heading)
        self._start = (self.x, self.y, self.heading)
        self._goal = (
            self.x + x * math.cos(angle) - y * math.sin(angle),
            self.y + x * math.sin(angle) + y * math.cos(angle),
            self.heading + turn,
        )
        self._begin, self._end = now, now + seconds
        self.moving = True

    def freeze(self) -> None:
        """Stay here."""
        self.moving = False

    def advance(self, now: float) -> None:
        """Move on to `now`."""
        if not self.moving:
            return
        span = self._end - self._begin
        share = 1.0 if span <= 0 else clamp((now - self._begin) / span, 0, 1)
        place = [a + (b - a) * share for a, b in zip(self._start, self._goal, strict=True)]
        self.x, self.y = place[0], place[1]
        self.heading = (place[2] + 180) % 360 - 180
        self.moving = share < 1


class SimulatedRobotBody:
    """All joints and the base."""

    def __init__(self, joints: Mapping[str, SimulatedJoint]) -> None:
        self.joints = {name: MovingJoint(limits) for name, limits in joints.items()}
        self.base = MovingBase()
        self.torque = True
        self.now = 0.0

    def advance(self, now: float) -> None:
        """Move on to `now`; earlier times change nothing."""
        moving = [joint for joint in self.joints.values() if not joint.still]
        while moving and self.now < now:
            step = min(STEP, now - self.now)
            self.now += step
            for joint in moving:
                joint.advance(self.now, step)
            moving = [joint for joint in moving if not joint.still]
        self.now = max(self.now, now)
        self.base.advance(self.now)

    def go(self, goals: Mapping[str, float], seconds: float) -> float:
        """Take the joints of `goals` there in `seconds`, or as fast as they can where that is
        longer; returns the seconds it will take.
        """
        needed = max((self._quickest(name, goal) for name, goal in goals.items()), default=0.0)
        return self.trace([(max(seconds, needed), goals)])

    def trace(self, poses: Iterable[tuple[float, Mapping[str, float]]]) -> float:
        """Pass through `poses`, each (seconds from now, degrees by joint); returns the seconds
        until the last. What is too fast for a joint is smoothed away by its speed limit.
        """
        tracks: dict[str, list[tuple[float, float]]] = {}
        last = 0.0
        for seconds, goals in poses:
            last = max(last, seconds)
            for name, degrees in goals.items():
                tracks.setdefault(name, []).append((self.now + seconds, degrees))
        for name, track in tracks.items():
            self.joints[name].follow(self.now, track)
        return last

    def jump(self, goals: Mapping[str, float]) -> None:
        """New setpoints at once; the joints follow as fast as they can."""
        for name, degrees in goals.items():
            self.joints[name].follow(self.now, [(self.now + STEP, degrees)])

    def freeze(self) -> None:
        """Stand still: every joint and the base."""
        self.hold(self.joints)
        self.base.freeze()

    def hold(self, names: Iterable[str]) -> None:
        """These joints stay at their present angles."""
        for name in names:
            self.joints[name].freeze()

    def still(self, names: Iterable[str]) -> bool:
        """Whether these joints have arrived."""
        return all(self.joints[name].still for name in names)

    @property
    def moving(self) -> bool:
        """Whether anything moves."""
        return self.base.moving or not self.still(self.joints)

    def _quickest(self, name: str, goal: float) -> float:
        """Seconds in which a cosine track stays below the joint's speed: its peak is pi/2."""
        joint = self.joints[name]
        low, high = joint.limits.low, joint.limits.high
        return abs(clamp(goal, low, high) - joint.present) / joint.limits.speed * math.pi / 2
