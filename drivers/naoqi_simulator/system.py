"""ALSystem and ALBattery."""

from __future__ import annotations

from naoqi_simulator.service_table import Service, offers
from naoqi_simulator.world import VERSIONS, SimulatedWorld

#: Percent that the battery loses in an hour awake: from 100 to 0 in the hours the maker names, 12
#: for Pepper, one and a half for NAO.
PER_HOUR = {"pepper": 100 / 12, "nao": 100 / 1.5}


CHARGE = "Device/SubDeviceList/Battery/Charge/Sensor/Value"


class System(Service):
    """Who the robot is."""

    name = "ALSystem"

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__()
        self._world = world
        self._robot_name = world.body.plan.robot

    @offers("systemVersion()s")
    def system_version(self) -> str:
        """As of NAOqi, for example, 2.5.10.7."""
        options = self._world.options
        return options.version or VERSIONS[options.robot]

    @offers("robotName()s")
    def robot_name(self) -> str:
        """The name it was given."""
        return self._robot_name

    @offers("setRobotName(s)b")
    def set_robot_name(self, name: str) -> bool:
        self._robot_name = name
        return True

    @offers("timezone()s")
    def timezone(self) -> str:
        """Of the robot's clock."""
        return "UTC"


class Battery(Service):
    """How full it is."""

    name = "ALBattery"

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__()
        self._world = world
        self.full = 87.0
        self._per_hour = PER_HOUR[world.options.robot]
        self._since = world.time.now()
        world.store.provide(CHARGE, self.share)

    @offers("getBatteryCharge()i")
    def get_battery_charge(self) -> int:
        """Percent."""
        return round(self.share() * 100)

    def share(self) -> float:
        """0 to 1."""
        hours = (self._world.time.now() - self._since) / 3600
        return max(0.0, self.full - hours * self._per_hour) / 100

    def fill(self, percent: float) -> None:
        """Let it be this full now."""
        self.full, self._since = float(percent), self._world.time.now()
