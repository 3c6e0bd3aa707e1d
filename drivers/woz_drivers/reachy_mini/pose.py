"""A pose of Reachy Mini: its joints, how far each of them goes, and how it stands on the wire.

The head stands on six arms, so it turns about three axes and moves along three. `pan`, `tilt` and
`roll` are angles from the robot's base, whatever the body does. The wire has radians and metres,
the head as a matrix or by x, y, z, roll, pitch, yaw, and the antennas as right and left, of which
the left one is positive outwards.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from woz_tui.drivers.contract import RejectedError
from woz_tui.drivers.fields import Range
from woz_tui.motion.safety import Limits, finite_number

Pose = Mapping[str, float]

#: Degrees, for the last three millimetres. Angles are those of the vendor's page "Core concepts"
#: ("Safety limits", reachy_mini 1.12) and of its URDF. The ways
#: are what the arms reach with the head level, by the vendor's analytical kinematics within the
#: stops of its URDF (46 mm back, 50 forward, 47 to each side, 50 down, 23 up), less a margin.
#: Speeds and accelerations are ours: what looks quick, and is not violent.
LIMITS: Mapping[str, Limits] = {
    "pan": Limits(-180, 180, 220, 900),
    "tilt": Limits(-40, 40, 180, 900),
    "roll": Limits(-40, 40, 180, 900),
    "body": Limits(-160, 160, 150, 500),
    "left-antenna": Limits(-175, 175, 400, 3000),
    "right-antenna": Limits(-175, 175, 400, 3000),
    "forward": Limits(-30, 30, 100, 500),
    "side": Limits(-30, 30, 100, 500),
    "lift": Limits(-40, 20, 100, 500),
}
#: The head can be turned so far from the body, in degrees: the vendor's "yaw delta".
MOST_TWIST = 65.0
#: Awake, looking ahead. Upright antennas tremble, so the vendor has them lean outwards a little.
HOME: Pose = {
    **dict.fromkeys(LIMITS, 0.0),
    "left-antenna": 10.0,
    "right-antenna": 10.0,
}
#: The head lies on the body: the vendor's SLEEP_HEAD_POSE (daemon/backend/abstract.py).
ASLEEP: Pose = {
    **HOME,
    "tilt": 24.4,
    "forward": -21.0,
    "lift": -40.0,
    "left-antenna": 174.7,
    "right-antenna": 174.7,
}
_MILLIMETRES = ("forward", "side", "lift")


def joint_ranges() -> dict[str, Range]:
    """The joints with their ranges, for `woz check` and the console."""
    return {
        name: Range(one.low, one.high, "mm" if name in _MILLIMETRES else "deg")
        for name, one in LIMITS.items()
    }


def wanted_joints(joints: Mapping[str, Any]) -> dict[str, float]:
    """What a command asks of the joints. Raises `RejectedError` for what is no joint or angle."""
    found: dict[str, float] = {}
    for name, wish in joints.items():
        if name not in LIMITS:
            raise RejectedError(f"there is no joint {name!r}", f"joints: {', '.join(LIMITS)}")
        angle = finite_number(wish)
        if angle is None:
            raise RejectedError(f"{name}: {repr(wish)[:60]} is no angle", "write a number")
        found[name] = angle
    return found


def reachable(wanted: Pose, present: Pose) -> dict[str, float]:
    """The whole pose that comes nearest to what is wanted; joints that are not named stay.

    The body follows a head that is turned too far from it, unless the body itself is named: then
    the head goes no further than it can.
    """
    pose = {name: one.clamp({**present, **wanted}[name]) for name, one in LIMITS.items()}
    follower, leader = ("pan", "body") if "body" in wanted else ("body", "pan")
    low, high = pose[leader] - MOST_TWIST, pose[leader] + MOST_TWIST
    pose[follower] = min(max(pose[follower], low), high)
    return pose


def aimed_at(x: float, y: float, z: float) -> dict[str, float]:
    """Pan and tilt that look at a point: metres forward, to its left and up from the middle of the
    head at home (the vendor's world frame). Raises `RejectedError` for the head's own place.
    """
    if math.hypot(x, y, z) < 0.01:
        raise RejectedError("that point is inside its head", "give metres: {x: 1, y: 0.5, z: 0}")
    return {
        "pan": math.degrees(math.atan2(y, x)),
        "tilt": -math.degrees(math.atan2(z, math.hypot(x, y))),
    }


# -- the wire --------------------------------------------------------------------------------------


def antennas_on_wire(pose: Pose) -> list[float]:
    """Right and left, in radians."""
    return [-math.radians(pose["right-antenna"]), math.radians(pose["left-antenna"])]


def goto_body(pose: Pose, seconds: float) -> dict[str, Any]:
    """What `POST /api/move/goto` takes."""
    return {
        "head_pose": {
            "x": pose["forward"] / 1000,
            "y": pose["side"] / 1000,
            "z": pose["lift"] / 1000,
            "roll": math.radians(pose["roll"]),
            "pitch": math.radians(pose["tilt"]),
            "yaw": math.radians(pose["pan"]),
        },
        "antennas": antennas_on_wire(pose),
        "body_yaw": math.radians(pose["body"]),
        "duration": seconds,
    }


def target_message(pose: Pose) -> dict[str, Any]:
    """What `/ws/sdk` takes as a setpoint for everything."""
    roll, pitch, yaw = (math.radians(pose[name]) for name in ("roll", "tilt", "pan"))
    sr, cr, sp, cp = math.sin(roll), math.cos(roll), math.sin(pitch), math.cos(pitch)
    sy, cy = math.sin(yaw), math.cos(yaw)
    x, y, z = (pose[name] / 1000 for name in _MILLIMETRES)
    return {
        "type": "set_full_target",
        "head": [
            *(cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, x),
            *(sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, y),
            *(-sp, cp * sr, cp * cr, z),
            *(0.0, 0.0, 0.0, 1.0),
        ],
        "antennas": antennas_on_wire(pose),
        "body_yaw": math.radians(pose["body"]),
    }


def head_from_matrix(matrix: Sequence[Sequence[float]]) -> dict[str, float]:
    """The head's joints from a 4 x 4 matrix. Raises `ValueError` for what is none."""
    try:
        (m00, _, _, x), (m10, _, _, y), (m20, m21, m22, z), _ = matrix
        values = {
            "pan": math.degrees(math.atan2(m10, m00)),
            "tilt": math.degrees(math.atan2(-m20, math.hypot(m21, m22))),
            "roll": math.degrees(math.atan2(m21, m22)),
            "forward": x * 1000,
            "side": y * 1000,
            "lift": z * 1000,
        }
    except (TypeError, ValueError):
        raise ValueError("a head pose that is no matrix") from None
    return _finite(values)


def body_from_joints(head: Sequence[float], antennas: Sequence[float]) -> dict[str, float]:
    """Body and antennas from the daemon's joint positions. Raises `ValueError` for what is none."""
    try:
        right, left = antennas
        values = {
            "body": math.degrees(head[0]),
            "right-antenna": -math.degrees(right),
            "left-antenna": math.degrees(left),
        }
    except (TypeError, ValueError, IndexError):
        raise ValueError("joint positions that are none") from None
    return _finite(values)


def _finite(values: dict[str, float]) -> dict[str, float]:
    wrong = [name for name, value in values.items() if not math.isfinite(value)]
    if wrong:
        raise ValueError(f"{', '.join(wrong)}: not a number")
    return values
