"""Pepper's joints: their ranges, and how far the head bends at which turn.

Ranges and the table of the head are those of the manufacturer's page "Joints" of Pepper for NAOqi
2.5 (family/pepper_technical/joints_pep). Directions: left and down are positive. HipPitch and
KneePitch count from the torso downwards (links torso, Hip, Pelvis, Tibia of pepper_description's
URDF), so a Pepper that bends forward has a negative HipPitch, as in its posture at rest.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from itertools import pairwise

from woz_tui.drivers.contract import RejectedError
from woz_tui.drivers.fields import Range
from woz_tui.protocol.messages import Json

HEAD_YAW, HEAD_PITCH = "HeadYaw", "HeadPitch"
HIP_PITCH, HIP_ROLL = "HipPitch", "HipRoll"
#: Hands have no angle: 0 is closed, 1 is open.
HANDS = ("LHand", "RHand")
_LOWER = (HIP_PITCH, HIP_ROLL, "KneePitch")


def _degrees(low: float, high: float) -> Range:
    return Range(low, high, "deg")


#: Joint -> range; degrees but for the hands.
JOINTS: Mapping[str, Range] = {
    HEAD_YAW: _degrees(-119.5, 119.5),
    HEAD_PITCH: _degrees(-40.5, 25.5),
    "LShoulderPitch": _degrees(-119.5, 119.5),
    "LShoulderRoll": _degrees(0.5, 89.5),
    "LElbowYaw": _degrees(-119.5, 119.5),
    "LElbowRoll": _degrees(-89.5, -0.5),
    "LWristYaw": _degrees(-104.5, 104.5),
    "LHand": Range(0.0, 1.0),
    HIP_ROLL: _degrees(-29.5, 29.5),
    HIP_PITCH: _degrees(-59.5, 59.5),
    "KneePitch": _degrees(-29.5, 29.5),
    "RShoulderPitch": _degrees(-119.5, 119.5),
    "RShoulderRoll": _degrees(-89.5, -0.5),
    "RElbowYaw": _degrees(-119.5, 119.5),
    "RElbowRoll": _degrees(0.5, 89.5),
    "RWristYaw": _degrees(-104.5, 104.5),
    "RHand": Range(0.0, 1.0),
}

#: (turn of the head to either side, highest and lowest bend), all in degrees: the tablet and the
#: casing are in the way. Between two rows the limits change evenly.
_HEAD_LIMITS = (
    (0.0, -40.5, 25.5),
    (33.33, -40.5, 25.5),
    (61.6, -35.2, 20.9),
    (91.4, -35.1, 13.5),
    (119.5, -35.0, 13.5),
)


def head_pitch(yaw: float) -> Range:
    """How far the head bends while it is turned by `yaw`, in degrees."""
    turned = min(abs(yaw), _HEAD_LIMITS[-1][0])
    for (before, low, high), (after, low_after, high_after) in pairwise(_HEAD_LIMITS):
        if turned <= after:
            share = (turned - before) / (after - before)
            return _degrees(low + share * (low_after - low), high + share * (high_after - high))
    return _degrees(*_HEAD_LIMITS[-1][1:])


def head(yaw: float, pitch: float) -> tuple[float, float]:
    """The nearest turn and bend that the head can take, in degrees."""
    turned = clamp(yaw, JOINTS[HEAD_YAW])
    return turned, clamp(pitch, head_pitch(turned))


def hip(pitch: float, roll: float) -> tuple[float, float]:
    """The nearest bend forward and sideways that the hip can take, in degrees."""
    return clamp(pitch, JOINTS[HIP_PITCH]), clamp(roll, JOINTS[HIP_ROLL])


def clamp(value: float, within: Range) -> float:
    """The nearest value inside of the range."""
    low = -math.inf if within.low is None else within.low
    high = math.inf if within.high is None else within.high
    return min(max(value, low), high)


def checked(pose: Json) -> dict[str, float]:
    """A pose as the robot takes it: degrees by joint, every one inside of its range.

    Raises `RejectedError` with the joint and what it can do.
    """
    if not isinstance(pose, Mapping) or not pose:
        raise RejectedError("a pose names joints, as in `joints: {HeadYaw: 20}`")
    found: dict[str, float] = {}
    for name, angle in pose.items():
        allowed = JOINTS.get(name)
        if allowed is None:
            raise RejectedError(f"Pepper has no joint {name!r}", _meant(name))
        if isinstance(angle, bool) or not isinstance(angle, int | float):
            raise RejectedError(f"{name} takes a number, not {angle!r}")
        _inside(name, float(angle), allowed)
        found[name] = float(angle)
    if HEAD_PITCH in found:
        turned = found.get(HEAD_YAW, 0.0)
        who = f"with the head turned by {turned:g}, {HEAD_PITCH}"
        _inside(who, found[HEAD_PITCH], head_pitch(turned))
    return found


def limb(name: str) -> str | None:
    """What of the robot to stiffen so that this joint follows; None for hip and knee.

    The manufacturer's page "Stiffness control" of NAOqi 2.5 (naoqi/motion/control-stiffness)
    allows head, arms and hands of a Pepper, and forbids its lower part.
    """
    if name in HANDS:
        return name
    return {"H": "Head", "L": "LArm", "R": "RArm"}[name[0]] if name not in _LOWER else None


def native(name: str, angle: float) -> float:
    """A joint's angle as NAOqi takes it: radians, and hands as they are."""
    return angle if name in HANDS else math.radians(angle)


def _inside(name: str, angle: float, allowed: Range) -> None:
    if not allowed.contains(angle):
        raise RejectedError(
            f"{name} goes from {allowed}, not to {angle:g}", "take an angle in between"
        )


def _meant(name: str) -> str:
    near = difflib.get_close_matches(name, JOINTS, 1, 0.5)
    return f"did you mean {near[0]!r}?" if near else f"the joints are {', '.join(JOINTS)}"
