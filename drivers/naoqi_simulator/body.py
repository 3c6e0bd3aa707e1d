"""The body as it is at any moment: joints that are on their way, stiffness, a base that drives, and
what a fall does to it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from naoqi_simulator.joints import PEPPER, BodyPlan
from naoqi_simulator.memory_store import MemoryStore
from naoqi_simulator.robot_time import Activities, SimulatorTime


@dataclass(frozen=True, slots=True)
class _JointCourse:
    """From one angle (rad) to another between two times (s), evenly."""

    start: float
    end: float
    begun: float
    seconds: float

    def at(self, now: float) -> float:
        if self.seconds <= 0 or now >= self.begun + self.seconds:
            return self.end
        share = max(0.0, (now - self.begun) / self.seconds)
        return self.start + share * (self.end - self.start)


@dataclass(frozen=True, slots=True)
class Drive:
    """The base on its way: metres and radians a second, from where and when, for how long."""

    x: float
    y: float
    turn: float
    begun: float
    seconds: float


class SimulatedBody:
    """Angles in radians, poses in metres and radians of the world in which it was started."""

    def __init__(self, time_: SimulatorTime, plan: BodyPlan = PEPPER) -> None:
        self._time = time_
        self.plan = plan
        self._courses = {
            name: _JointCourse(angle, angle, 0.0, 0.0)
            for name, angle in plan.postures["Crouch"].items()
        }
        self.stiffness = dict.fromkeys(plan.joints, 0.0)
        self.awake = False
        self.posture = "Crouch"
        self.breathing = dict.fromkeys(plan.breathing["Body"], False)
        self._pose = (0.0, 0.0, 0.0)
        self._drive: Drive | None = None
        #: Metres to what stands in front or at the side, as of where the robot stood then.
        self._front: float | None = None
        self._front_from = 0.0
        self.side: float | None = None
        self._driven = 0.0

    def angle(self, joint: str) -> float:
        """Where the joint is now."""
        return self._courses[joint].at(self._time.now())

    def move_joint(self, joint: str, angle: float, seconds: float) -> None:
        """Let a joint go; without stiffness it stays where it is."""
        if self.stiffness[joint] > 0:
            now = self._time.now()
            self._courses[joint] = _JointCourse(
                self.angle(joint), self.plan.clip(joint, angle), now, seconds
            )

    def hold(self, joints: Iterable[str] | None = None) -> None:
        """These joints, or all, stay where they are."""
        now = self._time.now()
        for joint in self.plan.joints if joints is None else joints:
            here = self._courses[joint].at(now)
            self._courses[joint] = _JointCourse(here, here, now, 0.0)

    def take(self, posture: str, seconds: float) -> None:
        """Let all joints go to those of a posture."""
        for joint, angle in self.plan.postures[posture].items():
            self.move_joint(joint, angle, seconds)

    def wake(self) -> None:
        """Motors on."""
        self.awake = True
        self.stiffness = dict.fromkeys(self.plan.joints, 1.0)

    def relax(self) -> None:
        """Motors off; nothing breathes."""
        self.awake = False
        self.stiffness = dict.fromkeys(self.plan.joints, 0.0)
        self.breathing = dict.fromkeys(self.breathing, False)

    @property
    def family(self) -> str:
        return self.plan.family(self.posture)

    @property
    def stiff(self) -> bool:
        """Whether all joints hold: then it can take another posture."""
        return all(stiffness > 0 for stiffness in self.stiffness.values())

    def seconds_to(self, targets: Mapping[str, float], fraction: float) -> float:
        """How long the slowest of these joints needs at a fraction of its full speed."""
        return max(
            (abs(angle - self.angle(joint)) / (self.plan.joints[joint][2] * fraction))
            for joint, angle in targets.items()
        )

    def drive(self, x: float, y: float, turn: float, seconds: float) -> None:
        """Drive with these speeds of the robot's own frame, for so long."""
        self.halt()
        self._drive = Drive(x, y, turn, self._time.now(), seconds)

    def last_step(self, seconds: float) -> None:
        """It goes on for so long, and stands then."""
        if self._drive is not None:
            until = min(self._drive.seconds, self._elapsed() + seconds)
            self._drive = replace(self._drive, seconds=until)

    def halt(self) -> None:
        """The base stands; where it is now is where it stays."""
        self._pose, self._driven = self.pose(), self._forward()
        self._drive = None

    def _elapsed(self) -> float:
        if self._drive is None:
            return 0.0
        return min(self._drive.seconds, max(0.0, self._time.now() - self._drive.begun))

    def pose(self) -> tuple[float, float, float]:
        """Where the base is: x, y (m), heading (rad, within half a turn)."""
        x, y, heading = self._pose
        if self._drive is None:
            return self._pose
        passed = self._elapsed()
        along, across = self._drive.x * passed, self._drive.y * passed
        x += along * math.cos(heading) - across * math.sin(heading)
        y += along * math.sin(heading) + across * math.cos(heading)
        turned = heading + self._drive.turn * passed
        return x, y, math.remainder(turned, math.tau)

    def velocity(self) -> tuple[float, float, float]:
        """Speeds now: m/s, m/s, rad/s."""
        drive = self._drive
        if drive is None or self._elapsed() >= drive.seconds:
            return 0.0, 0.0, 0.0
        return drive.x, drive.y, drive.turn

    def _forward(self) -> float:
        return self._driven + (self._drive.x * self._elapsed() if self._drive else 0.0)

    @property
    def front(self) -> float | None:
        """Metres to what was put in front of it; nearer by what it has driven since."""
        if self._front is None:
            return None
        return max(0.0, self._front - (self._forward() - self._front_from))

    @front.setter
    def front(self, metres: float | None) -> None:
        self._front, self._front_from = metres, self._forward()


#: When the reflex begins, and when it is over (naoqi/motion/reflexes-fall-manager of NAOqi 2.8).
FALLING, FALLEN = "ALMotion/RobotIsFalling", "robotHasFallen"
#: On which side it lies then, by the word of the fault `fall:back`.
SIDES = {"": "LyingBelly", "front": "LyingBelly", "back": "LyingBack"}


class SimulatedFalls:
    """A robot on legs falls: its fall manager lets go of all motors, and ALMemory tells of it."""

    def __init__(self, body: SimulatedBody, going: Activities, store: MemoryStore) -> None:
        self._body, self._going, self._store = body, going, store

    @property
    def lies(self) -> bool:
        """Whether it has to get up before it can do anything else."""
        return self._body.family.startswith("Lying")

    def fall(self, side: str = "") -> None:
        """Fall now. Raises KeyError for a side that there is not.

        The values stay in ALMemory: nothing on the robot takes them back.
        """
        posture = SIDES[side]
        self._store.raise_event(FALLING, True)
        self._body.halt()
        self._body.hold()
        self._body.relax()
        self._body.posture = posture
        self._going.end("move", "joints", "posture", "animation")
        self._store.raise_event(FALLEN, True)
