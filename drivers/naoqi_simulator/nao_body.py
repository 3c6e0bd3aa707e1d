"""A NAO's body: 26 joints, chains and postures.

Ranges are those of the manufacturer's page "H25 - Joints" (family/nao_h25/joints_h25 of NAOqi 2.5,
V4 and later), in radians; speeds are about those that `ALMotion.getLimits` gives. Postures are
round figures of ours: the real ones lie in the robot.

Not shared with the driver's table (`woz_drivers.nao.joints`), on purpose: this is the far end
of the wire.
"""

from __future__ import annotations

from naoqi_simulator.joints import BREATHING, BodyPlan, chains, posture

_LEG = ("HipYawPitch", "HipRoll", "HipPitch", "KneePitch", "AnklePitch", "AnkleRoll")
_L_LEG, _R_LEG = (tuple(f"{side}{joint}" for joint in _LEG) for side in "LR")

_JOINTS = {
    "HeadYaw": (-2.0857, 2.0857, 8.26797),
    "HeadPitch": (-0.6720, 0.5149, 7.19407),
    "LShoulderPitch": (-2.0857, 2.0857, 8.26797),
    "LShoulderRoll": (-0.3142, 1.3265, 7.19407),
    "LElbowYaw": (-2.0857, 2.0857, 8.26797),
    "LElbowRoll": (-1.5446, -0.0349, 7.19407),
    "LWristYaw": (-1.8238, 1.8238, 24.6229),
    "LHand": (0.0, 1.0, 8.33),
    "LHipYawPitch": (-1.145303, 0.740810, 4.16174),
    "LHipRoll": (-0.379472, 0.790477, 4.16174),
    "LHipPitch": (-1.535889, 0.484090, 6.40239),
    "LKneePitch": (-0.092346, 2.112528, 6.40239),
    "LAnklePitch": (-1.189516, 0.922747, 6.40239),
    "LAnkleRoll": (-0.397880, 0.769001, 4.16174),
    "RHipYawPitch": (-1.145303, 0.740810, 4.16174),
    "RHipRoll": (-0.790477, 0.379472, 4.16174),
    "RHipPitch": (-1.535889, 0.484090, 6.40239),
    "RKneePitch": (-0.103083, 2.120198, 6.40239),
    "RAnklePitch": (-1.186448, 0.932056, 6.40239),
    "RAnkleRoll": (-0.768992, 0.397935, 4.16174),
    "RShoulderPitch": (-2.0857, 2.0857, 8.26797),
    "RShoulderRoll": (-1.3265, 0.3142, 7.19407),
    "RElbowYaw": (-2.0857, 2.0857, 8.26797),
    "RElbowRoll": (0.0349, 1.5446, 7.19407),
    "RWristYaw": (-1.8238, 1.8238, 24.6229),
    "RHand": (0.0, 1.0, 8.33),
}


def _posture(**angles: float) -> dict[str, float]:
    return posture(_JOINTS, Hand=0.3, **angles)


_ARMS_DOWN = {
    **{"ShoulderPitch": 1.45, "ShoulderRoll": 0.2, "ElbowYaw": -1.2, "ElbowRoll": -0.42},
}
_ARMS_BENT = {"ShoulderPitch": 0.9, "ShoulderRoll": 0.3, "ElbowYaw": -0.4, "ElbowRoll": -1.2}
_SITTING = {"HipPitch": -1.53, "KneePitch": 1.4, "AnklePitch": 0.8, "HipYawPitch": -0.55}

NAO = BodyPlan(
    robot="NAO",
    joints=_JOINTS,
    chains=chains(_JOINTS, LLeg=_L_LEG, RLeg=_R_LEG, Legs=_L_LEG + _R_LEG),
    stiffened=None,
    breathing=BREATHING,
    postures={
        "Stand": _posture(HeadPitch=-0.17, HipYawPitch=-0.17, HipPitch=0.13, **_ARMS_DOWN),
        "StandInit": _posture(HipPitch=-0.44, KneePitch=0.7, AnklePitch=-0.35, **_ARMS_DOWN),
        "StandZero": _posture(),
        "Crouch": _posture(HipPitch=-0.7, KneePitch=2.1, AnklePitch=-1.18, **_ARMS_DOWN),
        "Sit": _posture(**_SITTING, **_ARMS_BENT),
        "SitRelax": _posture(HipPitch=-0.8, KneePitch=0.8, AnklePitch=0.4, ShoulderPitch=2.0),
        "LyingBack": _posture(**_ARMS_DOWN),
        "LyingBelly": _posture(ShoulderPitch=-0.9, HipPitch=0.1),
    },
    families={
        "Crouch": "Crouching",
        "Sit": "Sitting",
        "SitRelax": "Sitting",
        "LyingBack": "LyingBack",
        "LyingBelly": "LyingBelly",
    },
    # About what NAOqi walks with when nothing is set.
    speed=(0.08, 0.4),
    step_s=0.3,
    walks=True,
)
