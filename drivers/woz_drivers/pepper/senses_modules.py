"""The robot's modules that have to run so that its sensors say something."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from woz_drivers.pepper.memory import items
from woz_drivers.pepper.parts import RobotCalls, together
from woz_drivers.pepper.settings import PepperSettings
from woz_tui.drivers.contract import DeviceLostError, DriverError

#: How the robot knows this program: whatever it left behind has this name.
NAME = "woz-tui"
#: Unsubscribing at the end may take so long, in seconds.
_FAREWELL_S = 0.5


@dataclass(frozen=True, slots=True)
class SensorModule:
    """A module that has to run, and the sensors that are nothing without it."""

    service: str
    sensors: tuple[str, ...]
    begin: tuple[str, ...] = ("subscribe", NAME)
    end: tuple[str, ...] = ("unsubscribe", NAME)


_SONAR = (SensorModule("ALSonar", ("distance",)),)
_PEOPLE = (
    SensorModule("ALPeoplePerception", ("presence", "people", "nearest", "gaze")),
    SensorModule("ALGazeAnalysis", ("gaze",)),
    SensorModule("ALFaceDetection", ("identity",)),
)
_SOUND = (
    SensorModule("ALSoundLocalization", ("direction",)),
    SensorModule(
        "ALAudioDevice", ("loudness",), ("enableEnergyComputation",), ("disableEnergyComputation",)
    ),
)


def modules_for(settings: PepperSettings) -> tuple[SensorModule, ...]:
    """The modules for what is to be read."""
    senses = settings.senses
    return (
        *(_SONAR if senses.sonar else ()),
        *(_PEOPLE if senses.people else ()),
        *(_SOUND if senses.loudness else ()),
    )


class SensorModules:
    """Those modules of a robot: which run, and why the others do not.

    `silent(sensor, why)` hears of each sensor whose module does not run.
    """

    def __init__(
        self, robot: RobotCalls, modules: Sequence[SensorModule], silent: Callable[[str, str], None]
    ) -> None:
        self._robot = robot
        self._modules = modules
        self._silent = silent
        self._missing: dict[SensorModule, str] = dict.fromkeys(modules, "")

    @property
    def complete(self) -> bool:
        """Whether all run."""
        return not self._missing

    def runs(self, sensor: str) -> bool:
        """Whether all run that this sensor needs."""
        needed = [one for one in self._modules if sensor in one.sensors]
        return bool(needed) and not any(one in self._missing for one in needed)

    def forget(self) -> None:
        """The robot is gone, or another one: nothing runs."""
        self._missing = dict.fromkeys(self._modules, "")

    async def begin(self) -> None:
        """Begin whatever does not run; what the robot does not have is told, the others go on."""
        missing = list(self._missing)
        said = await asyncio.gather(
            *(self._robot.call(one.service, *one.begin) for one in missing), return_exceptions=True
        )
        for module, answer in zip(missing, said, strict=True):
            if isinstance(answer, DriverError):
                self._missing[module] = answer.what
            elif isinstance(answer, BaseException):
                raise answer
            else:
                del self._missing[module]
        for module, why in self._missing.items():
            for sensor in module.sensors:
                self._silent(sensor, f"{module.service} does not run: {why}")

    async def end(self) -> None:
        """They need not run for us any more."""
        running = [one for one in self._modules if one not in self._missing]
        self.forget()
        if self._robot.there:
            await asyncio.gather(*(self._end(module) for module in running))

    async def _end(self, module: SensorModule) -> None:
        with contextlib.suppress(DriverError):  # it goes on measuring, which disturbs nobody
            await self._robot.call(module.service, *module.end, within=_FAREWELL_S)


# -- many values at once ---------------------------------------------------------------------------


class MemoryQuery:
    """All keys by one question; key by key at a robot that refuses all of it for one of them."""

    def __init__(self, robot: RobotCalls) -> None:
        self._robot = robot
        self._key_by_key = False

    def forget(self) -> None:
        """It may be another robot."""
        self._key_by_key = False

    async def values(self, keys: Sequence[str]) -> dict[str, Any]:
        """What the robot holds, by key; None for what it does not have. Raises
        `DeviceLostError`.
        """
        if not self._key_by_key:
            said = await self._refusable("getListData", list(keys))
            if len(items(said)) == len(keys):
                return dict(zip(keys, said, strict=True))
            self._key_by_key = True
        said = await together(*(self._refusable("getData", key) for key in keys))
        return dict(zip(keys, said, strict=True))

    async def _refusable(self, method: str, words: str | list[str]) -> Any:
        """What the robot says; None if it says no. Raises `DeviceLostError`."""
        try:
            return await self._robot.call("ALMemory", method, words)
        except DeviceLostError:
            raise
        except DriverError:
            return None
