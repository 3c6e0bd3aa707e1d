"""What a NAO feels: its touch sensors, and how warm its motors are; ALBodyTemperature."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from typing import Any

from naoqi_simulator.service_table import Service, offers
from naoqi_simulator.world import SimulatedWorld

_DEVICE = "Device/SubDeviceList/{}/Sensor/Value"
#: Where somebody may touch it: head, hands, bumpers of the feet, the button on the chest.
TOUCHES = (
    *(f"Head/Touch/{part}" for part in ("Front", "Middle", "Rear")),
    *(f"{side}Hand/Touch/{part}" for side in "LR" for part in ("Left", "Back", "Right")),
    *(f"{side}Foot/Bumper/{part}" for side in "LR" for part in ("Left", "Right")),
    "ChestBoard/Button",
)
#: Of a motor that has rested, in degrees Celsius.
COOL_C = 38.0
#: From here on a motor's stiffness is reduced: status 1, 2 and 3.
HOT_C = (75.0, 80.0, 85.0)


class BodySensors:
    """Fills ALMemory."""

    def __init__(self, world: SimulatedWorld) -> None:
        self._touched: set[str] = set()
        self.temperatures = {
            joint: COOL_C for joint in world.body.plan.joints if not joint.endswith("Hand")
        }
        provide = world.store.provide
        for part in TOUCHES:
            provide(_DEVICE.format(part), partial(self._touch_of, part))
        for joint in self.temperatures:
            key = f"Device/SubDeviceList/{joint}/Temperature/Sensor"
            provide(f"{key}/Value", partial(self.temperatures.__getitem__, joint))
            provide(f"{key}/Status", partial(self.status, joint))

    def _touch_of(self, part: str) -> float:
        return float(part in self._touched)

    @property
    def touched(self) -> list[str]:
        return sorted(self._touched)

    def touch(self, parts: Iterable[str]) -> None:
        """Touch these and no others. Raises KeyError for what there is not."""
        asked = set(parts)
        if unknown := asked - set(TOUCHES):
            raise KeyError(f"no {', '.join(sorted(unknown))}; there is {', '.join(TOUCHES)}")
        self._touched = asked

    def heat(self, celsius: Mapping[str, float]) -> None:
        """Let these joints be so warm. Raises KeyError for one that there is not."""
        for joint, degrees in celsius.items():
            self.temperatures[joint]
            self.temperatures[joint] = float(degrees)

    def status(self, joint: str) -> int:
        """0: as it should be; 1: hot; 2: very hot; 3: critical, the motor is off."""
        return sum(self.temperatures[joint] >= limit for limit in HOT_C)


class BodyTemperature(Service):
    name = "ALBodyTemperature"

    def __init__(self, sensors: BodySensors) -> None:
        super().__init__()
        self._sensors = sensors

    @offers("getTemperatureDiagnosis()m")
    def get_temperature_diagnosis(self) -> list[Any]:
        """The highest status with the joints that have it; nothing while all are well."""
        by_joint = {joint: self._sensors.status(joint) for joint in self._sensors.temperatures}
        worst = max(by_joint.values())
        joints = [joint for joint, status in by_joint.items() if status == worst]
        return [worst, joints] if worst else []
