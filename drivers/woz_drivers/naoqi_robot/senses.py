"""Publishes what the robot senses: distance, people, loudness, direction of sounds, battery.

ALMemory is polled, for the signals of ALMemory do not work with NAOqi 2.5 ("Invalid signature").
One question a round brings all keys; what belongs to a person is asked for from the round after
they were first seen.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from woz_drivers.naoqi_robot import memory
from woz_drivers.naoqi_robot.memory import item, items, number, within
from woz_drivers.naoqi_robot.parts import NaoqiPart, RobotCalls, together
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.argument_values import text
from woz_tui.drivers.contract import (
    FACE_CONSENT,
    LEARN_FACE,
    DeviceLostError,
    DriverContext,
    DriverError,
    Job,
    Offer,
    RejectedError,
)
from woz_tui.drivers.face_store import key_of
from woz_tui.drivers.robot_parts import RefusalAllowed
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.protocol.messages import Json

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


def sonar_sensors(settings: NaoqiSettings) -> tuple[str, ...]:
    """One for each sonar, and `distance` as the nearest of them."""
    return tuple(dict.fromkeys((*settings.model.sonars, "distance")))


def modules_for(settings: NaoqiSettings) -> tuple[SensorModule, ...]:
    """The modules for what is to be read."""
    senses = settings.senses
    return (
        *((SensorModule("ALSonar", sonar_sensors(settings)),) if senses.sonar else ()),
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
        self._link = robot
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
        """Begin what does not run; what the robot does not have is reported, the others go on."""
        missing = list(self._missing)
        answers = await asyncio.gather(
            *(self._link.call(one.service, *one.begin) for one in missing), return_exceptions=True
        )
        for module, answer in zip(missing, answers, strict=True):
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
        if self._link.ready:
            await asyncio.gather(*(self._end(module) for module in running))

    async def _end(self, module: SensorModule) -> None:
        with contextlib.suppress(DriverError):  # it goes on measuring, which disturbs nobody
            await self._link.call(module.service, *module.end, within=_FAREWELL_S)


# -- many values at once ---------------------------------------------------------------------------


class MemoryQuery:
    """All keys by one question; key by key at a robot that refuses all of it for one of them."""

    def __init__(self, robot: RobotCalls) -> None:
        self._link = robot
        self._key_by_key = False

    def forget(self) -> None:
        """It may be another robot."""
        self._key_by_key = False

    async def values(self, keys: Sequence[str]) -> dict[str, Any]:
        """What the robot holds, by key; None for what it does not have. Raises
        `DeviceLostError`.
        """
        if not self._key_by_key:
            raw = await self._refusable("getListData", list(keys))
            if len(items(raw)) == len(keys):
                return dict(zip(keys, raw, strict=True))
            self._key_by_key = True
        raw = await together(*(self._refusable("getData", key) for key in keys))
        return dict(zip(keys, raw, strict=True))

    async def _refusable(self, method: str, words: str | list[str]) -> Any:
        """What the robot says; None if it says no. Raises `DeviceLostError`."""
        with RefusalAllowed():
            return await self._link.call("ALMemory", method, words)
        return None


#: A missing module is asked for again after so long: at its start a robot has them one by one.
_AGAIN_US = 10_000_000
#: It takes the robot some seconds to learn a face.
LEARN_S = 20.0


class SensesPart(NaoqiPart):
    """Readings of the robot's own sensors, `senses.rate` times a second."""

    name = "senses"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        self._rate = settings.senses.rate
        self._sonars = settings.model.sonars
        self._sensors = self.offer(settings).sensors
        self._modules = SensorModules(robot, modules_for(settings), self._silent)
        self._begun_us = 0
        self._query = MemoryQuery(robot)
        self._report = RoundReport(context)
        self._ids: tuple[int, ...] = ()
        self._battery: float | None = None
        self._polling = self.background("reading the robot's sensors")

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """What the robot senses; where it sees people it gives a name to a face, and forgets it."""
        named = [sensor for module in modules_for(settings) for sensor in module.sensors]
        learning = (
            common_verb(FACE_CONSENT, lane="senses"),
            common_verb(
                LEARN_FACE,
                "recognise the face before it by this name from now on",
                lane="senses",
                limit_s=LEARN_S + 5.0,
            ),
        )
        return Offer(
            verbs=learning if settings.senses.people else (),
            sensors=(*dict.fromkeys(named), "battery"),
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Learn a face, or forget it; ends when the robot has done so."""
        name = text(job.args, "name").strip()
        if not name:
            raise RejectedError("a face needs a name", "give a code, such as V7")
        if job.verb == FACE_CONSENT:
            return await self._consent(name, given=bool(job.args["given"]))
        if await self._link.call("ALFaceDetection", "learnFace", name, within=LEARN_S) is False:
            raise DriverError(
                f"the robot has not learnt the face of {name}",
                "let one person look at it from one metre in good light, then try again",
            )
        return {"name": name}

    async def _consent(self, name: str, *, given: bool) -> Mapping[str, Json]:
        if given:
            return {"name": name, "given": True}
        # The robot takes letter case as it is, and has a face under the name as it was learnt.
        learnt = await self._link.call("ALFaceDetection", "getLearnedFacesList")
        names = [str(one) for one in learnt] if isinstance(learnt, list | tuple) else [name]
        kept = [one for one in names if key_of(one) == key_of(name)]
        for one in kept:
            if await self._link.call("ALFaceDetection", "forgetPerson", one) is False:
                raise DriverError(f"the robot has not forgotten the face of {one}", "try again")
        return {"name": name, "given": False, "deleted": bool(kept)}

    async def connected(self) -> None:
        """Have the robot's modules run, and begin to read."""
        await self._polling.close()
        self._ids = ()
        self._modules.forget()
        self._query.forget()
        self._report.forget()
        await self._begin()
        self._polling.start(self._poll())

    def lost(self) -> None:
        """Nothing is known any more."""
        self._polling.cancel()
        self._all_silent("the robot is not connected")

    async def read(self) -> Mapping[str, Json]:
        """The battery's charge, 0 to 1, as it was read last."""
        return {} if self._battery is None else {"battery": self._battery}

    async def close(self) -> None:
        """End reading; the robot's modules need not run for us any more."""
        await super().close()
        await self._modules.end()

    async def _begin(self) -> None:
        self._begun_us = self._context.clock.now_us()
        await self._modules.begin()

    def _silent(self, sensor: str, why: str) -> None:
        self._context.sensor(sensor, "stale", why)

    def _all_silent(self, why: str) -> None:
        self._battery = None
        for sensor in self._sensors:
            self._silent(sensor, why)

    # -- reading -------------------------------------------------------------------------------

    async def _poll(self) -> None:
        loop = asyncio.get_running_loop()
        due = loop.time()
        while True:
            try:
                await self._round()
            except DeviceLostError as error:  # the connection says when it is there again
                self._all_silent(error.what)
            due = max(due + 1 / self._rate, loop.time())
            await asyncio.sleep(due - loop.time())

    async def _round(self) -> None:
        """Ask once, and publish what came. Raises `DeviceLostError`."""
        if (
            not self._modules.complete
            and self._context.clock.now_us() - self._begun_us >= _AGAIN_US
        ):
            await self._begin()
        values, energy = await together(self._query.values(self._keys()), self._energy())
        self._publish(values)
        if self._modules.runs("loudness"):
            self._report.plain("loudness", memory.loudness(energy), energy)

    def _keys(self) -> list[str]:
        """What is asked for this time, by what runs."""
        runs = self._modules.runs
        keys = [memory.BATTERY]
        keys += self._sonars.values() if runs("distance") else ()
        keys += [memory.SOUND] if runs("direction") else []
        keys += [FACES] if runs("identity") else []
        if runs("presence"):
            keys.append(VISIBLE)
            for person in self._ids:
                keys += [distance_key(person), looking_key(person)]
        return keys

    async def _energy(self) -> Any:
        """What the front microphone hears, or what the robot says instead. Raises
        `DeviceLostError`.
        """
        if not self._modules.runs("loudness"):
            return None
        try:
            return await self._link.call("ALAudioDevice", "getFrontMicEnergy")
        except DeviceLostError:
            raise
        except DriverError as error:
            return ValueRefusal(error.what)

    def _publish(self, values: Mapping[str, Any]) -> None:
        self._battery = memory.battery(values[memory.BATTERY])
        self._report.battery(values[memory.BATTERY])
        self._publish_distances(
            {name: values[key] for name, key in self._sonars.items() if key in values}
        )
        if memory.SOUND in values:
            self._report.sound(values[memory.SOUND])
        if FACES in values:
            self._report.identity(values[FACES])
        if VISIBLE in values:
            self._publish_people(values)

    def _publish_distances(self, raws: Mapping[str, Any]) -> None:
        for sensor, raw in raws.items():
            self._report.plain(sensor, memory.sonar(raw), raw, "m")
        if raws and "distance" not in raws:
            measured = [found for raw in raws.values() if (found := memory.sonar(raw)) is not None]
            self._report.plain("distance", min(measured, default=None), list(raws.values()), "m")

    def _publish_people(self, values: Mapping[str, Any]) -> None:
        raw = values[VISIBLE]
        ids = visible(raw)
        self._ids = ids or ()
        sensors = [sensor for sensor in self._sensors if self._modules.runs(sensor)]
        if ids is not None:
            self._report.people(ids, values, sensors)
            return
        for sensor in ("presence", "people", "nearest", "gaze"):
            if sensor in sensors:
                self._report.nothing(sensor, raw)


# -- from values to readings -----------------------------------------------------------------------

#: What stays the same for hours is told this often: seldom, but not so that it looks stale.
CALM_US = 1_000_000


@dataclass(frozen=True, slots=True)
class ValueRefusal:
    """Instead of a value: why the robot gives none."""

    why: str


class RoundReport:
    """Publishes the readings of each round."""

    def __init__(self, context: DriverContext) -> None:
        self._context = context
        self._last_stamp: tuple[float, float] | None = None
        self._begun = False
        self._charge: float | None = None
        self._charged_us = context.clock.now_us() - CALM_US

    def forget(self) -> None:
        """It may be another robot, with another clock."""
        self._last_stamp, self._begun = None, False
        self._charged_us = self._context.clock.now_us() - CALM_US

    def plain(self, sensor: str, value: float | None, raw: Any, unit: str = "") -> None:
        """One number, as it was decoded from `said`."""
        if value is None:
            self.nothing(sensor, raw)
        else:
            self._context.sensor(sensor, "ok")
            self._context.reading(sensor, value, unit=unit)

    def nothing(self, sensor: str, raw: Any) -> None:
        """The robot has no value, or one that makes no sense."""
        self._context.sensor(sensor, "stale", _why(raw))
        self._context.reading(sensor, None)

    def battery(self, raw: Any) -> None:
        """The charge to the hundredth; while it stays the same, now and then."""
        charge = memory.battery(raw)
        share = None if charge is None else round(charge, 2)
        now_us = self._context.clock.now_us()
        if share != self._charge or now_us - self._charged_us >= CALM_US:
            self._charge, self._charged_us = share, now_us
            self.plain("battery", share, raw)

    def sound(self, raw: Any) -> None:
        """Where a sound came from, once for each; the first one found may be of yesterday."""
        if raw is None or raw in ([], ()):
            self._context.sensor("direction", "ok")
            self._begun = True
            return
        found = memory.sound(raw)
        if found is None:
            self.nothing("direction", raw)
            return
        self._context.sensor("direction", "ok")
        if found.stamp != self._last_stamp and self._begun:
            self._context.reading("direction", round(found.degrees, 1), unit="deg")
        self._last_stamp, self._begun = found.stamp, True

    def identity(self, raw: Any) -> None:
        """Whose face it is: the name as text, the recognition's score as value."""
        found = face(raw)
        if found is None:
            self.nothing("identity", raw)
            return
        self._context.sensor("identity", "ok")
        score = found.score if found.name else 0.0
        self._context.reading("identity", score, text=found.name)

    def people(self, ids: Sequence[int], values: Mapping[str, Any], sensors: Sequence[str]) -> None:
        """How many there are, how far the nearest is, and whether they look at the robot; of
        somebody of whom nothing is known yet, only that they are there.
        """
        for sensor in ("presence", "people"):
            self._context.sensor(sensor, "ok")
        self._context.reading("presence", float(bool(ids)))
        self._context.reading("people", float(len(ids)))
        who = nearest(ids, values)
        if who is not None:
            raw = values.get(distance_key(who.id))
            self.plain("nearest", who.distance, raw, "m")
            looking = None if who.looking is None else float(who.looking)
            if "gaze" in sensors:
                self.plain("gaze", looking, values.get(looking_key(who.id)))
        elif not ids:
            self._context.sensor("nearest", "ok")
            self._context.reading("nearest", None, unit="m")
            if "gaze" in sensors:
                self.plain("gaze", 0.0, None)


def _why(raw: Any) -> str:
    if raw is None:
        return "the robot has no value for it"
    if isinstance(raw, ValueRefusal):
        return raw.why
    return f"is not a valid value: {memory.brief(raw)}"


# -- people ----------------------------------------------------------------------------------------
# Nothing in here raises, whatever the robot says. Shapes are those of NAOqi 2.4 to 2.9
# (doc.aldebaran.com, "naoqi/peopleperception/alpeopleperception-api", "alfacedetection-api").

VISIBLE = "PeoplePerception/VisiblePeopleList"
FACES = "FaceDetected"

#: Nobody measures farther than this; the robot's own reach is about 3.5 m.
REACH_M = 30.0
#: So many people are asked about; a robot sees a handful.
_MOST = 20
_LARGEST_ID = 2**53
#: A name is looked at up to here, in characters.
_READABLE = 1000


def distance_key(person: int) -> str:
    """Where a person's distance in metres stands."""
    return f"PeoplePerception/Person/{person}/Distance"


def looking_key(person: int) -> str:
    """Where it stands whether a person looks at the robot."""
    return f"PeoplePerception/Person/{person}/IsLookingAtRobot"


def visible(value: Any) -> tuple[int, ...] | None:
    """Ids of the people whom the robot sees now; None if the value is no list of ids."""
    if not isinstance(value, (list, tuple)):
        return None
    ids: list[int] = []
    for one in value:
        found = within(one, 0, _LARGEST_ID)
        if found is None or found != int(found):
            return None
        ids.append(int(found))
    return tuple(dict.fromkeys(ids))[:_MOST]


@dataclass(frozen=True, slots=True)
class VisiblePerson:
    """Somebody visible: metres and whether they look at the robot, None where it does not say."""

    id: int
    distance: float | None
    looking: bool | None


def nearest(ids: Sequence[int], values: Mapping[str, Any]) -> VisiblePerson | None:
    """The nearest of `ids` whose values were read; who has no distance comes last."""
    people = [
        VisiblePerson(
            one, metres(values.get(distance_key(one))), looks(values.get(looking_key(one)))
        )
        for one in ids
        if distance_key(one) in values
    ]
    return min(people, key=lambda one: one.distance or REACH_M + 1.0, default=None)


def metres(value: Any) -> float | None:
    """A person's distance, above 0."""
    return within(value, 0.0, REACH_M) or None


def looks(value: Any) -> bool | None:
    """Whether a person looks at the robot; NAOqi versions say it as a flag or as a number."""
    if isinstance(value, bool):
        return value
    share = within(value, 0.0, 1.0)
    return None if share is None else share >= 0.5


@dataclass(frozen=True, slots=True)
class RecognisedFace:
    """A face: `name` is empty if nobody knows it, `score` of the recognition if there is one."""

    name: str
    score: float | None


NOBODY = RecognisedFace("", None)


def face(value: Any) -> RecognisedFace | None:
    """The largest face of `FaceDetected`; a `RecognisedFace` without a name where there is none.

    `[]`, or `[time, [face, ..., recognised], ...]` with faces `[[0, alpha, beta, width, height],
    [id, score, name, ...]]`; in some versions the second part holds a list of such lists. The last
    entry, who has been recognised over time, is `[]`, `[4]`, `[2, [name]]` or `[3, [names]]`. None
    if the value is something else.
    """
    if value is None or value in ([], ()):
        return NOBODY
    entries = item(value, 1)
    if not isinstance(entries, (list, tuple)):
        return None
    faces = [one for one in entries if _size(one) is not None]
    if not faces:
        return None if entries else NOBODY
    known = _face_of(max(faces, key=lambda one: _size(one) or 0.0))
    if known is not None and not known.name and len(faces) == 1:
        return RecognisedFace(_over_time(entries[-1]), known.score)
    return known


def _over_time(entry: Any) -> str:
    """Who was recognised over time, if it is one."""
    return (_name(item(entry, 1, 0)) or "") if item(entry, 0) == 2 else ""


def _size(entry: Any) -> float | None:
    """How large a face is in the picture; None for what is no face."""
    width, height = number(item(entry, 0, 3)), number(item(entry, 0, 4))
    return None if width is None or height is None else abs(width * height)


def _face_of(entry: Any) -> RecognisedFace | None:
    extra = item(entry, 1)
    if isinstance(item(extra, 0), (list, tuple)):
        extra = item(extra, 0)
    if not items(extra):
        return NOBODY
    name = _name(item(extra, 2))
    return None if name is None else RecognisedFace(name, within(item(extra, 1), 0.0, 1.0))


def _name(value: Any) -> str | None:
    if not isinstance(value, str) or len(value) > _READABLE:
        return None
    return value.strip()
