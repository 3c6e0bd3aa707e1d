"""What the robot senses all the time: distance, people, loudness, direction of sounds, battery.

ALMemory is polled, for the signals of ALMemory do not work with NAOqi 2.5 ("Invalid signature").
One question a round brings all keys; what belongs to a person is asked for from the round after
they were first seen.
"""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import Any

from woz_drivers.pepper import memory, people
from woz_drivers.pepper.parts import Part, Robot, together
from woz_drivers.pepper.parts_task import Background
from woz_drivers.pepper.senses_asking import Asking
from woz_drivers.pepper.senses_modules import Modules, wanted
from woz_drivers.pepper.senses_told import Refusal, Told
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.simulated.values import text
from woz_tui.core.driver import Argument, DriverError, Job, Lost, Outlet, Rejected, Verb
from woz_tui.core.messages import Json

#: A missing module is asked for again after so long: at its start a robot has them one by one.
_AGAIN_US = 10_000_000
#: It takes the robot some seconds to learn a face.
LEARN_S = 20.0


class Senses(Part):
    """Readings of the robot's own sensors, `senses.rate` times a second."""

    name = "senses"

    def __init__(self, robot: Robot, settings: PepperSettings, outlet: Outlet) -> None:
        super().__init__(robot, settings, outlet)
        self._rate = settings.senses.rate
        self._sensors = self.sensors(settings)
        self._modules = Modules(robot, wanted(settings), self._silent)
        self._begun_us = 0
        self._asking = Asking(robot)
        self._told = Told(outlet)
        self._ids: tuple[int, ...] = ()
        self._battery: float | None = None
        self._polling = Background("reading the robot's sensors", outlet)

    @classmethod
    def verbs(cls, settings: PepperSettings) -> tuple[Verb, ...]:
        """It gives a name to the face that it sees."""
        if not settings.senses.people:
            return ()
        return (
            Verb(
                "learn_face",
                "recognise the face before it by this name from now on",
                (Argument("name", "text", "a code or a pseudonym", required=True),),
                lane="senses",
                limit_s=LEARN_S + 5.0,
            ),
        )

    @classmethod
    def sensors(cls, settings: PepperSettings) -> tuple[str, ...]:
        """What it publishes with these settings."""
        named = [sensor for module in wanted(settings) for sensor in module.sensors]
        return (*dict.fromkeys(named), "battery")

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Learn a face; ends when the robot has learnt it."""
        if job.verb != "learn_face":
            raise Rejected(f"the senses cannot {job.verb}")
        name = text(job.args, "name").strip()
        if not name:
            raise Rejected("a face needs a name", "give a code, such as V7")
        if await self._robot.call("ALFaceDetection", "learnFace", name, within=LEARN_S) is False:
            raise DriverError(
                f"the robot has not learnt the face of {name}",
                "one person alone looks at it, from a metre away, in good light; then try again",
            )
        return {"name": name}

    async def connected(self) -> None:
        """Have the robot's modules run, and begin to read."""
        await self._polling.close()
        self._ids = ()
        self._modules.forget()
        self._asking.forget()
        self._told.forget()
        await self._begin()
        self._polling.start(self._poll())

    def lost(self) -> None:
        """Nothing is known any more."""
        self._polling.cancel()
        self._battery = None
        self._all_silent("the robot is not there")

    async def read(self) -> Mapping[str, Json]:
        """The battery's charge, 0 to 1, as it was read last."""
        return {} if self._battery is None else {"battery": self._battery}

    async def close(self) -> None:
        """End reading; the robot's modules need not run for us any more."""
        await self._polling.close()
        await self._modules.end()

    async def _begin(self) -> None:
        self._begun_us = self._outlet.clock.now_us()
        await self._modules.begin()

    def _silent(self, sensor: str, why: str) -> None:
        self._outlet.sensor(sensor, "stale", why)

    def _all_silent(self, why: str) -> None:
        for sensor in self._sensors:
            self._silent(sensor, why)

    # -- reading -------------------------------------------------------------------------------

    async def _poll(self) -> None:
        loop = asyncio.get_running_loop()
        due = loop.time()
        while True:
            try:
                await self._round()
            except Lost as error:  # the connection says when it is there again
                self._all_silent(error.what)
            due = max(due + 1 / self._rate, loop.time())
            await asyncio.sleep(due - loop.time())

    async def _round(self) -> None:
        """Ask once, and say what came. Raises `Lost`."""
        if not self._modules.complete and self._outlet.clock.now_us() - self._begun_us >= _AGAIN_US:
            await self._begin()
        values, energy = await together(self._asking.values(self._keys()), self._energy())
        self._say(values)
        if self._modules.runs("loudness"):
            self._told.plain("loudness", memory.loudness(energy), energy)

    def _keys(self) -> list[str]:
        """What is asked for this time, by what runs."""
        runs = self._modules.runs
        keys = [memory.BATTERY]
        keys += [memory.SONAR] if runs("distance") else []
        keys += [memory.SOUND] if runs("direction") else []
        keys += [people.FACES] if runs("identity") else []
        if runs("presence"):
            keys.append(people.VISIBLE)
            for person in self._ids:
                keys += [people.distance_key(person), people.looking_key(person)]
        return keys

    async def _energy(self) -> Any:
        """What the front microphone hears, or what the robot says instead. Raises `Lost`."""
        if not self._modules.runs("loudness"):
            return None
        try:
            return await self._robot.call("ALAudioDevice", "getFrontMicEnergy")
        except Lost:
            raise
        except DriverError as error:
            return Refusal(error.what)

    def _say(self, values: Mapping[str, Any]) -> None:
        self._battery = memory.battery(values[memory.BATTERY])
        self._told.battery(values[memory.BATTERY])
        if memory.SONAR in values:
            said = values[memory.SONAR]
            self._told.plain("distance", memory.sonar(said), said, "m")
        if memory.SOUND in values:
            self._told.sound(values[memory.SOUND])
        if people.FACES in values:
            self._told.identity(values[people.FACES])
        if people.VISIBLE in values:
            self._say_people(values)

    def _say_people(self, values: Mapping[str, Any]) -> None:
        said = values[people.VISIBLE]
        ids = people.visible(said)
        self._ids = ids or ()
        sensors = [sensor for sensor in self._sensors if self._modules.runs(sensor)]
        if ids is not None:
            self._told.people(ids, values, sensors)
            return
        for sensor in ("presence", "people", "nearest", "gaze"):
            if sensor in sensors:
                self._told.nothing(sensor, said)
