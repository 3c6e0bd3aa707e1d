"""Pepper's joints.

Ranges and the table of the head are those of the manufacturer's page "Joints" of Pepper for NAOqi
2.5 (family/pepper_technical/joints_pep). HipPitch and KneePitch count from the torso downwards
(links torso, Hip, Pelvis, Tibia of pepper_description's URDF), so a Pepper that bends forward has a
negative HipPitch, as in its posture at rest.
"""

from __future__ import annotations

from collections.abc import Mapping

from woz_drivers.naoqi_robot.joint_table import (
    HAND,
    HEAD_PITCH,
    HEAD_YAW,
    JointTable,
    clamp,
    degrees,
)
from woz_tui.drivers.fields import Range

HIP_PITCH, HIP_ROLL = "HipPitch", "HipRoll"

_RANGES: Mapping[str, Range] = {
    HEAD_YAW: degrees(-119.5, 119.5),
    HEAD_PITCH: degrees(-40.5, 25.5),
    "LShoulderPitch": degrees(-119.5, 119.5),
    "LShoulderRoll": degrees(0.5, 89.5),
    "LElbowYaw": degrees(-119.5, 119.5),
    "LElbowRoll": degrees(-89.5, -0.5),
    "LWristYaw": degrees(-104.5, 104.5),
    "LHand": HAND,
    HIP_ROLL: degrees(-29.5, 29.5),
    HIP_PITCH: degrees(-59.5, 59.5),
    "KneePitch": degrees(-29.5, 29.5),
    "RShoulderPitch": degrees(-119.5, 119.5),
    "RShoulderRoll": degrees(-89.5, -0.5),
    "RElbowYaw": degrees(-119.5, 119.5),
    "RElbowRoll": degrees(0.5, 89.5),
    "RWristYaw": degrees(-104.5, 104.5),
    "RHand": HAND,
}

#: The tablet and the casing are in the way of a head that is turned.
_HEAD_LIMITS = (
    (0.0, -40.5, 25.5),
    (33.33, -40.5, 25.5),
    (61.6, -35.2, 20.9),
    (91.4, -35.1, 13.5),
    (119.5, -35.0, 13.5),
)


JOINTS = JointTable(
    "Pepper", _RANGES, _HEAD_LIMITS, frozenset((HIP_PITCH, HIP_ROLL, "KneePitch")), "hip and knee"
)


def hip(pitch: float, roll: float) -> tuple[float, float]:
    """The nearest bend forward and sideways that the hip can take, in degrees."""
    return clamp(pitch, _RANGES[HIP_PITCH]), clamp(roll, _RANGES[HIP_ROLL])
