"""What one kind of robot with NAOqi differs in from another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from woz_drivers.naoqi_robot.animation_names import AnimationNames
from woz_drivers.naoqi_robot.joint_table import JointTable
from woz_drivers.naoqi_robot.robot_settings import NaoqiSetting


@dataclass(frozen=True, slots=True)
class RobotModel:
    """One kind of robot.

    Attributes:
        name: What it is called in sentences.
        simulator: What the simulator calls it (`python -m naoqi_simulator --robot`).
        joints: Its joints.
        animations: Those that every robot of this kind has.
        settings: All that it has set, by name.
        services: What the driver uses of it; a robot may be without some of them.
        sonars: Sensor to key of ALMemory.
        silence: Calls that end speech, sound and motion, whoever began them.
    """

    name: str
    simulator: str
    joints: JointTable
    animations: AnimationNames
    settings: Mapping[str, NaoqiSetting]
    services: frozenset[str]
    sonars: Mapping[str, str]
    silence: tuple[tuple[Any, ...], ...]

    @property
    def postures(self) -> tuple[str, ...]:
        """Those that the screen offers; a robot may have more."""
        return self.settings["posture"].choices
