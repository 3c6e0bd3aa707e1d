"""What a NAO differs in from other robots with NAOqi."""

from __future__ import annotations

from woz_drivers.nao.animations import MOVES
from woz_drivers.nao.joints import JOINTS, UPPER
from woz_drivers.naoqi_robot.animation_names import AnimationNames
from woz_drivers.naoqi_robot.line import COMMON_SERVICES
from woz_drivers.naoqi_robot.model import RobotModel
from woz_drivers.naoqi_robot.robot_settings import NaoqiSetting, played_and_recorded, with_own

#: What ends every movement but those of the legs: a walk that is killed ends in a fall, so it is
#: stopped (naoqi/motion/control-walk of NAOqi 2.8).
HALT_UPPER = ("ALMotion", "killTasksUsingResources", list(UPPER))
#: Its cameras, in the order of their numbers.
CAMERAS = ("top", "bottom")

NAO = RobotModel(
    name="NAO",
    simulator="nao",
    joints=JOINTS,
    animations=AnimationNames("NAO", MOVES),
    settings=with_own(
        *(("Stand", "StandInit", "StandZero", "Crouch", "Sit", "SitRelax", "LyingBack"),),
        NaoqiSetting(
            *("Camera", "camera", "choice", "which one is looked through", "camera", "which"),
            file="camera",
            choices=CAMERAS,
        ),
        *played_and_recorded("Sound"),
    ),
    services=COMMON_SERVICES,
    sonars={
        f"distance.{side.lower()}": f"Device/SubDeviceList/US/{side}/Sensor/Value"
        for side in ("Left", "Right")
    },
    silence=(
        ("ALMotion", "stopMove"),
        ("ALRobotPosture", "stopMove"),
        HALT_UPPER,
        ("ALTextToSpeech", "stopAll"),
        ("ALAudioPlayer", "stopAll"),
    ),
)
