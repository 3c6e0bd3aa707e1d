"""What a Pepper differs in from other robots with NAOqi."""

from __future__ import annotations

from woz_drivers.naoqi_robot.animation_names import AnimationNames
from woz_drivers.naoqi_robot.line import COMMON_SERVICES
from woz_drivers.naoqi_robot.model import RobotModel
from woz_drivers.naoqi_robot.robot_settings import NaoqiSetting, played_and_recorded, with_own
from woz_drivers.pepper.animations import MOVES
from woz_drivers.pepper.joints import JOINTS

PEPPER = RobotModel(
    name="Pepper",
    simulator="pepper",
    joints=JOINTS,
    animations=AnimationNames("Pepper", MOVES),
    settings=with_own(
        ("Stand", "StandInit", "StandZero", "Crouch"),
        NaoqiSetting(
            *("Tablet", "tablet", "text", "a file, an address, or off: the default again"),
            *("screen", "file"),
            label="shows",
        ),
        *played_and_recorded("Tablet"),
    ),
    services=COMMON_SERVICES | {"ALTabletService"},
    sonars={"distance": "Device/SubDeviceList/Platform/Front/Sonar/Sensor/Value"},
    silence=(
        ("ALMotion", "stopMove"),
        ("ALMotion", "killAll"),
        ("ALTextToSpeech", "stopAll"),
        ("ALAudioPlayer", "stopAll"),
    ),
)
