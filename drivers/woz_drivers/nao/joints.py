"""A NAO's 26 joints.

Ranges and the table of the head are those of the manufacturer's page "H25 - Joints" of NAOqi 2.5
(doc.aldebaran.com/2-5/family/nao_h25/joints_h25, V4 and later). LHipYawPitch and RHipYawPitch are
one motor: what is asked of the left one holds.
"""

from __future__ import annotations

from collections.abc import Mapping

from woz_drivers.naoqi_robot.joint_table import HAND, HEAD_PITCH, HEAD_YAW, JointTable, degrees
from woz_tui.drivers.fields import Range

_LEGS: Mapping[str, Range] = {
    "LHipYawPitch": degrees(-65.62, 42.44),
    "LHipRoll": degrees(-21.74, 45.29),
    "LHipPitch": degrees(-88.0, 27.73),
    "LKneePitch": degrees(-5.29, 121.04),
    "LAnklePitch": degrees(-68.15, 52.86),
    "LAnkleRoll": degrees(-22.79, 44.06),
    "RHipYawPitch": degrees(-65.62, 42.44),
    "RHipRoll": degrees(-45.29, 21.74),
    "RHipPitch": degrees(-88.0, 27.73),
    "RKneePitch": degrees(-5.9, 121.47),
    "RAnklePitch": degrees(-67.97, 53.4),
    "RAnkleRoll": degrees(-44.06, 22.8),
}
_UPPER: Mapping[str, Range] = {
    HEAD_YAW: degrees(-119.5, 119.5),
    HEAD_PITCH: degrees(-38.5, 29.5),
    "LShoulderPitch": degrees(-119.5, 119.5),
    "LShoulderRoll": degrees(-18.0, 76.0),
    "LElbowYaw": degrees(-119.5, 119.5),
    "LElbowRoll": degrees(-88.5, -2.0),
    "LWristYaw": degrees(-104.5, 104.5),
    "LHand": HAND,
    "RShoulderPitch": degrees(-119.5, 119.5),
    "RShoulderRoll": degrees(-76.0, 18.0),
    "RElbowYaw": degrees(-119.5, 119.5),
    "RElbowRoll": degrees(2.0, 88.5),
    "RWristYaw": degrees(-104.5, 104.5),
    "RHand": HAND,
}
#: The shell of the shoulders is in the way of a head that is turned.
_HEAD_LIMITS = (
    (0.0, -38.5, 29.5),
    (27.85, -38.5, 24.18),
    (43.32, -31.4, 21.2),
    (51.74, -27.5, 18.91),
    (62.45, -24.64, 17.19),
    (87.49, -18.91, 11.46),
    (119.52, -25.73, 18.91),
)

UPPER, LEGS = tuple(_UPPER), tuple(_LEGS)
JOINTS = JointTable("NAO", {**_UPPER, **_LEGS}, _HEAD_LIMITS, frozenset(LEGS), "its legs")
