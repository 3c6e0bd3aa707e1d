"""What the robot makes of the looks of whoever is nearest: age, gender, smile, expression, mood.

It guesses, and guesses change from picture to picture: the middle of the last ones is told. Off
unless the robot file asks for it; docs/how-to/pepper.md says what the law says of it. Sensors named
`looks.` are never in a redacted export.

Source: "naoqi/peopleperception/alfacecharacteristics-api" and "naoqi/emotion/almood-api" of 2.5.
"""

from __future__ import annotations

import asyncio
import statistics
from collections import Counter, deque
from collections.abc import Mapping, Sequence
from typing import Any

from woz_drivers.naoqi_robot.memory import item, items, within
from woz_drivers.naoqi_robot.parts import NaoqiPart, RobotCalls
from woz_drivers.naoqi_robot.senses import (
    VISIBLE,
    MemoryQuery,
    SensorModule,
    SensorModules,
    distance_key,
    nearest,
    visible,
)
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.contract import DeviceLostError, DriverContext, Offer
from woz_tui.drivers.robot_parts import RefusalAllowed

#: How the robot knows this part; the other senses have a name of their own.
NAME = "woz-tui looks"
#: The robot looks at a face two or three times a second.
EVERY_S = 0.5
#: So many guesses are one reading.
GUESSES = 5
#: What a guess has to be at least, as far as the robot says how sure it is.
SURE = 0.3
OLDEST = 75.0
GENDERS = ("female", "male")
EXPRESSIONS = ("neutral", "happy", "surprised", "angry", "sad")
_FACE = ("looks.age", "looks.gender", "looks.smile", "looks.expression")
_MOOD = ("looks.valence", "looks.attention")
_OF_FACE = {
    "looks.age": "AgeProperties",
    "looks.gender": "GenderProperties",
    "looks.smile": "SmileProperties",
    "looks.expression": "ExpressionProperties",
}


def looks_modules(settings: NaoqiSettings) -> tuple[SensorModule, ...]:
    """The robot's modules for what the file asks for."""
    begin, end = ("subscribe", NAME), ("unsubscribe", NAME)
    face = (
        SensorModule("ALPeoplePerception", _FACE, begin, end),
        SensorModule("ALFaceCharacteristics", _FACE, begin, end),
    )
    mood = SensorModule("ALMood", _MOOD, (*begin, "Active"), end)
    senses = settings.senses
    return (*(face if senses.face else ()), *((mood,) if senses.mood else ()))


class LooksPart(NaoqiPart):
    """Readings `looks.` of the nearest person."""

    name = "looks"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        self._sensors = self.offer(settings).sensors
        self._modules = SensorModules(robot, looks_modules(settings), self._silent)
        self._query = MemoryQuery(robot)
        self._who: int | None = None
        self._guesses: dict[str, deque[float]] = {}
        self._polling = self.background("reading what people look like")

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """Nothing, unless the file asks for it."""
        named = [sensor for module in looks_modules(settings) for sensor in module.sensors]
        return Offer(sensors=tuple(dict.fromkeys(named)))

    async def connected(self) -> None:
        """Have the robot look, and begin to read."""
        if not self._sensors:
            return
        await self._polling.close()
        self._modules.forget()
        self._query.forget()
        self._forget(None)
        await self._modules.begin()
        self._polling.start(self._poll())

    def lost(self) -> None:
        """Nothing is known any more."""
        self._polling.cancel()
        for sensor in self._sensors:
            self._silent(sensor, "the robot is not connected")

    async def close(self) -> None:
        """End reading; the robot need not look for us any more."""
        await super().close()
        await self._modules.end()

    def _silent(self, sensor: str, why: str) -> None:
        self._context.sensor(sensor, "stale", why)

    def _forget(self, who: int | None) -> None:
        self._who = who
        self._guesses = {}

    # -- reading -------------------------------------------------------------------------------

    async def _poll(self) -> None:
        while True:
            try:
                if self._modules.runs("looks.age"):
                    await self._read_face()
                if self._modules.runs("looks.valence"):
                    await self._read_mood()
            except DeviceLostError:
                return  # the next connection begins anew
            await asyncio.sleep(EVERY_S)

    async def _read_face(self) -> None:
        values = await self._query.values([VISIBLE])
        ids = visible(values[VISIBLE]) or ()
        keys = {
            sensor: [f"PeoplePerception/Person/{one}/{last}" for one in ids]
            for sensor, last in _OF_FACE.items()
        }
        asked = [
            *(distance_key(one) for one in ids),
            *(key for each in keys.values() for key in each),
        ]
        values = await self._query.values(asked) if asked else {}
        who = nearest(ids, values)
        if who is None:
            self._nobody(_FACE)
            return
        if who.id != self._who:
            self._forget(who.id)
        said = {
            sensor: values.get(f"PeoplePerception/Person/{who.id}/{last}")
            for sensor, last in _OF_FACE.items()
        }
        self._number("looks.age", _guess(said["looks.age"], OLDEST), "years")
        self._number("looks.smile", _guess(said["looks.smile"], 1.0))
        self._word("looks.gender", _guess(said["looks.gender"], 1.0), GENDERS)
        self._word("looks.expression", _strongest(said["looks.expression"]), EXPRESSIONS)

    async def _read_mood(self) -> None:
        state: Any = None
        with RefusalAllowed():
            state = await self._link.call("ALMood", "currentPersonState")
        if not items(state):
            self._nobody(_MOOD)
            return
        self._number("looks.valence", within(item(state, 0, 0), -1.0, 1.0))
        self._number("looks.attention", within(item(state, 1, 0), 0.0, 1.0))

    def _nobody(self, sensors: Sequence[str]) -> None:
        """Nobody is there: no fault, and no value."""
        if sensors is _FACE:
            self._forget(None)
        for sensor in sensors:
            self._context.sensor(sensor, "ok")
            self._context.reading(sensor, None)

    def _number(self, sensor: str, guess: float | None, unit: str = "") -> None:
        kept = self._kept(sensor, guess)
        if kept:
            self._context.sensor(sensor, "ok")
            middle = round(statistics.median(kept), 2)
            self._context.reading(sensor, middle, unit=unit, raw=guess)

    def _word(self, sensor: str, guess: float | None, words: Sequence[str]) -> None:
        kept = self._kept(sensor, guess)
        if kept:
            [(commonest, times)] = Counter(map(round, kept)).most_common(1)
            self._context.sensor(sensor, "ok")
            self._context.reading(sensor, round(times / len(kept), 2), text=words[commonest])

    def _kept(self, sensor: str, guess: float | None) -> deque[float]:
        """The last guesses, with this one if it is one."""
        kept = self._guesses.setdefault(sensor, deque(maxlen=GUESSES))
        if guess is not None:
            kept.append(guess)
        return kept


def _guess(value: Any, most: float) -> float | None:
    """The first of `[guess, how sure]`; None if it is none, or not sure."""
    sure = within(item(value, 1), 0.0, 1.0)
    return None if sure is None or sure < SURE else within(item(value, 0), 0.0, most)


def _strongest(value: Any) -> float | None:
    """The place of the largest share."""
    shares: Mapping[int, float | None] = {
        place: within(item(value, place), 0.0, 1.0) for place in range(len(EXPRESSIONS))
    }
    known = {place: share for place, share in shares.items() if share is not None}
    return float(max(known, key=known.__getitem__)) if len(known) == len(EXPRESSIONS) else None
