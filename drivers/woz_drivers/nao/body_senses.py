"""What a NAO feels: touches, falls, the warmth of its motors. ALMemory is polled for it."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator, Mapping
from typing import Any

from woz_drivers.nao import falls, hot_motors
from woz_drivers.nao.falls import FallWatch
from woz_drivers.nao.hot_motors import MotorWatch
from woz_drivers.naoqi_robot import memory
from woz_drivers.naoqi_robot.parts import NaoqiPart, RobotCalls
from woz_drivers.naoqi_robot.senses import CALM_US, MemoryQuery
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.contract import DeviceLostError, DriverContext, Offer

#: From one question to the next, in seconds: a fall and a touch are known after so long.
POLL_S = 0.1
#: Motors warm up slowly: they are asked about with every so many questions.
WARMTH_EVERY = round(hot_motors.EVERY_S / POLL_S)

_SIDES = ("Left", "Right")
#: Sensor to what it is: 1 while one of these is touched (family/nao_technical/contact-sensors).
TOUCHES: Mapping[str, tuple[str, ...]] = {
    **{
        f"touch.head.{part.lower()}": (f"Head/Touch/{part}",)
        for part in ("Front", "Middle", "Rear")
    },
    **{
        f"touch.hand.{side.lower()}": tuple(
            f"{side[0]}Hand/Touch/{part}" for part in (*_SIDES, "Back")
        )
        for side in _SIDES
    },
    **{
        f"bumper.{side.lower()}": tuple(f"{side[0]}Foot/Bumper/{part}" for part in _SIDES)
        for side in _SIDES
    },
    "button": ("ChestBoard/Button",),
}


def _key(device: str) -> str:
    return f"Device/SubDeviceList/{device}/Sensor/Value"


class BodySensesPart(NaoqiPart):
    """Readings of what the body feels; a fall also guards the robot (`falls.FallWatch`)."""

    name = "body senses"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        self._touches = TOUCHES if settings.senses.touch else {}
        self._query = MemoryQuery(robot)
        self._falls = FallWatch(robot, context)
        self._motors = MotorWatch(context)
        #: By sensor: what was told last, and when.
        self._felt: dict[str, tuple[float | None, int]] = {}
        self._polling = self.background("reading what the robot feels")

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """Touches where they are wanted; falls and warmth in any case."""
        touches = TOUCHES if settings.senses.touch else ()
        return Offer(sensors=(*touches, falls.SENSOR, hot_motors.SENSOR))

    async def look(self) -> None:
        """See whether it lies, before anything else is done with it. Raises `DeviceLostError`."""
        self._query.forget()
        self._falls.forget()
        self._motors.forget()
        self._felt.clear()
        await self._falls.take(await self._query.values(falls.KEYS), first=True)

    async def connected(self) -> None:
        """Begin to read."""
        await self._polling.close()
        self._polling.start(self._poll())

    def lost(self) -> None:
        """Nothing is known any more."""
        self._polling.cancel()
        self._falls.forget()
        for sensor in self.offer(self._settings).sensors:
            self._context.sensor(sensor, "stale", "the robot is not connected")

    def conflicts(self) -> Iterator[str]:
        """A fall, and motors that get weaker."""
        if self._falls.fallen:
            yield "it has fallen: no motion is sent to it until it is up again"
        yield from self._motors.conflicts()

    async def _poll(self) -> None:
        loop, due, turn = asyncio.get_running_loop(), 0.0, 0
        while True:
            due = loop.time() + POLL_S
            try:
                await self._round(warmth=turn % WARMTH_EVERY == 0)
                turn += 1
            except DeviceLostError as error:  # the connection says when it is there again
                for sensor in self.offer(self._settings).sensors:
                    self._context.sensor(sensor, "stale", error.what)
            await asyncio.sleep(max(0.0, due - loop.time()))

    async def _round(self, *, warmth: bool) -> None:
        """Ask once, and publish what came. Raises `DeviceLostError`."""
        devices = [_key(device) for devices in self._touches.values() for device in devices]
        asked = [*falls.KEYS, *devices, *(hot_motors.keys() if warmth else ())]
        values = await self._query.values(asked)
        await self._falls.take(values)
        for sensor, parts in self._touches.items():
            self._feel(sensor, [values[_key(part)] for part in parts])
        if warmth:
            self._motors.take(values)

    def _feel(self, sensor: str, raws: list[Any]) -> None:
        """1 while any of them is touched; told when it changes, else now and then."""
        touched = [memory.flag(raw) for raw in raws]
        known = [flag for flag in touched if flag is not None]
        value = float(any(known)) if known else None
        now_us = self._context.clock.now_us()
        before, told_us = self._felt.get(sensor, (None, -CALM_US))
        if value == before and now_us - told_us < CALM_US:
            return
        self._felt[sensor] = value, now_us
        if value is None:
            self._context.sensor(sensor, "stale", "the robot does not say whether it is touched")
        else:
            self._context.sensor(sensor, "ok")
        self._context.reading(sensor, value)
