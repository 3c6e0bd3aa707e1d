"""A robot's joints: their ranges, how far the head bends at which turn, what stiffens which."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

from woz_tui.drivers.contract import RejectedError
from woz_tui.drivers.fields import Range
from woz_tui.protocol.messages import Json

HEAD_YAW, HEAD_PITCH = "HeadYaw", "HeadPitch"
#: Hands have no angle: 0 is closed, 1 is open.
HANDS = ("LHand", "RHand")
HAND = Range(0.0, 1.0)


def degrees(low: float, high: float) -> Range:
    """A joint's range."""
    return Range(low, high, "deg")


@dataclass(frozen=True, slots=True)
class JointTable:
    """The joints of one kind of robot.

    Attributes:
        robot: Whose they are, in sentences.
        ranges: Joint to range; degrees but for the hands. Left and down are positive.
        head_limits: Turn of the head to either side, highest and lowest bend, all in degrees;
            between two rows the limits change evenly.
        lower: Joints that are stiff while the robot is awake, and never stiffened by themselves.
        lower_words: What they are called in a sentence, such as "hip and knee".
    """

    robot: str
    ranges: Mapping[str, Range]
    head_limits: tuple[tuple[float, float, float], ...]
    lower: frozenset[str]
    lower_words: str

    def head_pitch(self, yaw: float) -> Range:
        """How far the head bends while it is turned by `yaw`, in degrees."""
        turned = min(abs(yaw), self.head_limits[-1][0])
        for (before, low, high), (after, low_after, high_after) in pairwise(self.head_limits):
            if turned <= after:
                share = (turned - before) / (after - before)
                return degrees(low + share * (low_after - low), high + share * (high_after - high))
        return degrees(*self.head_limits[-1][1:])

    def head(self, yaw: float, pitch: float) -> tuple[float, float]:
        """The nearest turn and bend that the head can take, in degrees."""
        turned = clamp(yaw, self.ranges[HEAD_YAW])
        return turned, clamp(pitch, self.head_pitch(turned))

    def checked(self, pose: Json) -> dict[str, float]:
        """A pose as the robot takes it: degrees by joint, every one inside of its range.

        Raises `RejectedError` with the joint and what it can do.
        """
        if not isinstance(pose, Mapping) or not pose:
            raise RejectedError("a pose names joints, as in `joints: {HeadYaw: 20}`")
        found: dict[str, float] = {}
        for name, angle in pose.items():
            allowed = self.ranges.get(name)
            if allowed is None:
                raise RejectedError(f"{self.robot} has no joint {name!r}", self._meant(name))
            if isinstance(angle, bool) or not isinstance(angle, int | float):
                raise RejectedError(f"{name} takes a number, not {angle!r}")
            _inside(name, float(angle), allowed)
            found[name] = float(angle)
        if HEAD_PITCH in found:
            turned = found.get(HEAD_YAW, 0.0)
            who = f"with the head turned by {turned:g}, {HEAD_PITCH}"
            _inside(who, found[HEAD_PITCH], self.head_pitch(turned))
        return found

    def limb(self, name: str) -> str | None:
        """What of the robot to stiffen so that this joint follows; None for its lower part.

        The manufacturer's page "Stiffness control" of NAOqi 2.5 (naoqi/motion/control-stiffness)
        allows head, arms and hands of a Pepper, and forbids its lower part. A NAO whose legs are
        stiffened one by one falls: they, too, are left to waking up.
        """
        if name in HANDS:
            return name
        return None if name in self.lower else {"H": "Head", "L": "LArm", "R": "RArm"}[name[0]]

    def _meant(self, name: str) -> str:
        near = difflib.get_close_matches(name, self.ranges, 1, 0.5)
        return f"did you mean {near[0]!r}?" if near else f"the joints are {', '.join(self.ranges)}"


def clamp(value: float, within: Range) -> float:
    """The nearest value inside of the range."""
    low = -math.inf if within.low is None else within.low
    high = math.inf if within.high is None else within.high
    return min(max(value, low), high)


def native(name: str, angle: float) -> float:
    """A joint's angle as NAOqi takes it: radians, and hands as they are."""
    return angle if name in HANDS else math.radians(angle)


def _inside(name: str, angle: float, allowed: Range) -> None:
    if not allowed.contains(angle):
        raise RejectedError(
            f"{name} goes from {allowed}, not to {angle:g}", "take an angle in between"
        )
