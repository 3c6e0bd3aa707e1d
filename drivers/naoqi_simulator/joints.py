"""A robot's body: joints with ranges and speeds, chains, postures. Here is Pepper's.

Ranges and speeds are those of the robot's published description (radians, radians a second); hands
go from closed to open.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

#: Lowest and highest angle (rad), highest speed (rad/s) by joint.
Ranges = Mapping[str, tuple[float, float, float]]


@dataclass(frozen=True, slots=True)
class BodyPlan:
    """What the body of one kind of robot is like.

    Attributes:
        robot: Its name in sentences.
        joints: Lowest and highest angle (rad), highest speed (rad/s).
        chains: Names that stand for several joints.
        stiffened: What may be stiffened by itself; None: everything.
        breathing: Chains that can breathe, and which single ones they stand for.
        postures: Angles (rad) by joint.
        families: Posture to its family, where that is not Standing.
        speed: Highest speeds of the way it goes by itself: m/s, rad/s.
        step_s: Seconds until it stands after `stopMove`: a foot in the air comes down first.
        walks: Whether it goes on legs: then it can fall.
    """

    robot: str
    joints: Ranges
    chains: Mapping[str, tuple[str, ...]]
    stiffened: frozenset[str] | None
    breathing: Mapping[str, tuple[str, ...]]
    postures: Mapping[str, Mapping[str, float]]
    families: Mapping[str, str]
    speed: tuple[float, float]
    step_s: float = 0.0
    walks: bool = False

    def expand(self, name: str) -> tuple[str, ...]:
        """The joints that a name of a joint or a chain stands for. Raises KeyError."""
        if name in self.chains:
            return self.chains[name]
        if name in self.joints:
            return (name,)
        raise KeyError(name)

    def clip(self, joint: str, angle: float) -> float:
        """The angle that the joint can really take, in radians."""
        low, high, _ = self.joints[joint]
        return min(high, max(low, angle))

    def family(self, posture: str) -> str:
        """Of a posture."""
        return self.families.get(posture, "Standing")


# -- what bodies with two arms have in common ------------------------------------------------------

_ARM = ("ShoulderPitch", "ShoulderRoll", "ElbowYaw", "ElbowRoll", "WristYaw", "Hand")
_L_ARM, _R_ARM = (tuple(f"{side}{joint}" for joint in _ARM) for side in "LR")
#: Chains that can breathe, and which single ones they stand for.
BREATHING: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "Head": ("Head",),
        "LArm": ("LArm",),
        "RArm": ("RArm",),
        "Arms": ("LArm", "RArm"),
        "Legs": ("Legs",),
        "Body": ("Head", "LArm", "RArm", "Legs"),
    }
)
#: On the right these turn the other way.
_MIRRORED = ("Roll", "Yaw")


def chains(joints: Ranges, **legs: tuple[str, ...]) -> dict[str, tuple[str, ...]]:
    """Names for several joints; `legs` are those that differ."""
    whole = dict.fromkeys(("Body", "JointActuators", "Joints"), tuple(joints))
    arms = {"LArm": _L_ARM, "RArm": _R_ARM, "Arms": _L_ARM + _R_ARM}
    return {"Head": ("HeadYaw", "HeadPitch"), **arms, **legs, **whole}


def posture(joints: Ranges, **angles: float) -> dict[str, float]:
    """All joints, in radians, within their ranges; 0 where nothing is said. What is there twice is
    named without its side: both are alike.
    """
    found = dict.fromkeys(joints, 0.0)
    for joint, angle in angles.items():
        if joint in joints:
            found[joint] = angle
        else:
            turns = -angle if joint.endswith(_MIRRORED) else angle
            found |= {f"L{joint}": angle, f"R{joint}": turns}
    return {
        joint: min(joints[joint][1], max(joints[joint][0], angle)) for joint, angle in found.items()
    }


# -- Pepper's --------------------------------------------------------------------------------------

JOINTS: Ranges = MappingProxyType(
    {
        "HeadYaw": (-2.0857, 2.0857, 7.33998),
        "HeadPitch": (-0.7068, 0.4451, 9.22756),
        "LShoulderPitch": (-2.0857, 2.0857, 7.33998),
        "LShoulderRoll": (0.0087, 1.5620, 9.22756),
        "LElbowYaw": (-2.0857, 2.0857, 7.33998),
        "LElbowRoll": (-1.5620, -0.0087, 9.22756),
        "LWristYaw": (-1.8239, 1.8239, 17.3835),
        "LHand": (0.0, 1.0, 8.0),
        "HipRoll": (-0.5149, 0.5149, 2.27032),
        "HipPitch": (-1.0385, 1.0385, 2.93276),
        "KneePitch": (-0.5149, 0.5149, 2.93276),
        "RShoulderPitch": (-2.0857, 2.0857, 7.33998),
        "RShoulderRoll": (-1.5620, -0.0087, 9.22756),
        "RElbowYaw": (-2.0857, 2.0857, 7.33998),
        "RElbowRoll": (0.0087, 1.5620, 9.22756),
        "RWristYaw": (-1.8239, 1.8239, 17.3835),
        "RHand": (0.0, 1.0, 8.0),
    }
)
_WHEELS = ("WheelFL", "WheelFR", "WheelB")
_LEG = ("HipRoll", "HipPitch", "KneePitch")

CHAINS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {**chains(JOINTS, Leg=_LEG, Legs=_LEG), "Wheels": (), **dict.fromkeys(_WHEELS, ())}
)

_STANDS = {
    **{"HeadPitch": -0.21, "HipPitch": -0.04, "Hand": 0.6},
    **{"ShoulderPitch": 1.57, "ShoulderRoll": 0.12, "ElbowYaw": -1.22, "ElbowRoll": -0.52},
}
_CROUCHES = {"HeadPitch": 0.4, "HipPitch": -1.0, "KneePitch": 0.5}
POSTURES: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "Stand": posture(JOINTS, **_STANDS),
        "StandInit": posture(JOINTS, **_STANDS | {"HeadPitch": 0.0}),
        "StandZero": posture(JOINTS),
        "Crouch": posture(JOINTS, **_STANDS | _CROUCHES),
    }
)


PEPPER = BodyPlan(
    robot="Pepper",
    joints=JOINTS,
    chains=CHAINS,
    stiffened=frozenset({"Head", "LArm", "RArm", "LHand", "RHand"}),
    breathing=BREATHING,
    postures=POSTURES,
    families={"Crouch": "Crouching"},
    # NAOqi's own figures for MaxVelXY (m/s) and MaxVelTheta (rad/s), when nothing is set.
    speed=(0.35, 1.0),
)
