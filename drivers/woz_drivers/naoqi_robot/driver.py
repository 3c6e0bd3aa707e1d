"""The driver of a robot with NAOqi: hands verbs to parts, stops all of them at once, and tells what
the robot has.
"""

from __future__ import annotations

import asyncio
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import ClassVar

from woz_drivers.naoqi_robot import address, doctor, tags, text_remarks
from woz_drivers.naoqi_robot.autonomy import AutonomyPart
from woz_drivers.naoqi_robot.base import BasePart
from woz_drivers.naoqi_robot.body import BodyPart
from woz_drivers.naoqi_robot.connection import RobotConnection
from woz_drivers.naoqi_robot.eyes import EyesPart
from woz_drivers.naoqi_robot.parts import NaoqiPart
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_drivers.naoqi_robot.settings_reading import SettingsReader
from woz_drivers.naoqi_robot.sounds import SoundsPart
from woz_drivers.programs.simulated_process import SIMULATED
from woz_tui.drivers import confirmed_stop
from woz_tui.drivers.argument_values import text
from woz_tui.drivers.background import Background, BackgroundTasks
from woz_tui.drivers.confirmed_stop import confirmed_within, succeeded
from woz_tui.drivers.contract import (
    KEPT,
    Argument,
    DeviceLostError,
    DriverContext,
    DriverError,
    Finding,
    HeardSound,
    Job,
    Offer,
    Probe,
    RejectedError,
    Scope,
    StopReport,
    Verb,
    Written,
)
from woz_tui.drivers.robot_parts import Pending, RobotOfParts
from woz_tui.drivers.robot_verbs import known_by
from woz_tui.protocol.messages import Json
from woz_tui.protocol.requesters import requester
from woz_tui.protocol.robot_outline import RobotOutline
from woz_tui.system.tasks import wait_at_most

#: A robot that has just been switched on takes its time before it answers.
CONNECT_LIMIT_S = 180.0
#: Of `connect` and `disconnect` alone: nothing that waits for the robot stands before them.
LANE = "line"

LINE = (
    Verb(
        "connect",
        "connect to a robot",
        (
            Argument(
                "robot",
                "text",
                "an address or a host name; empty: the first",
                default="",
                hide=address.without_password,
            ),
        ),
        lane=LANE,
        limit_s=CONNECT_LIMIT_S,
    ),
    Verb("disconnect", "disconnect the robot until `connect`", lane=LANE, limit_s=10.0),
)


class NaoqiRobot(RobotOfParts[RobotConnection, NaoqiSettings]):
    """What a kind of robot is made of, says its own class."""

    #: What a stop reaches first stands first.
    PARTS: ClassVar[tuple[type[NaoqiPart], ...]]
    _parts: Sequence[NaoqiPart]
    _by_verb: Mapping[str, NaoqiPart]
    _drive: Sequence[NaoqiPart]
    #: What can be said of commands that are only written.
    CHECKS: ClassVar[dict[str, Mapping[str, text_remarks.Check]]] = text_remarks.CHECKS

    def __init__(self, name: str, settings: NaoqiSettings, context: DriverContext) -> None:
        link = RobotConnection(settings, context, on_connected=self._connected, on_lost=self._lost)
        parts = tuple(kind(link, settings, context) for kind in self.PARTS)
        super().__init__(name, settings, context, link, parts)
        for sounds in parts:
            if isinstance(sounds, SoundsPart):
                for eyes in parts:
                    if isinstance(eyes, EyesPart):
                        sounds.light_up(eyes)
        self._reading = SettingsReader(link, parts, settings, context)
        #: Whether it was there and went without being asked to: nobody knows what it does now.
        self._lost_unasked = False
        self._present = False
        #: While the settings are being applied after a connection, verbs wait: what the wizard
        #: wants must not be undone by what the file wants.
        self._settling = BackgroundTasks("applying the settings")
        #: While the stop is pressed no robot is told to live by itself: what was to be applied to
        #: one that was found meanwhile, or was being applied, waits for the release.
        self._stopped = self._waits = False
        self._living: asyncio.Task[None] | None = None
        self._later = Background("applying the settings", context)

    @classmethod
    def people_data(cls, settings: NaoqiSettings) -> Iterable[tuple[str, str]]:
        if settings.recognition.phrases:
            yield (
                KEPT,
                "which phrases of a list people say, as the robot understands them, in the log",
            )

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """What its parts offer, and the line; NAOqi answers each verb when it is over, but for what
        moves in small steps: that is only told.
        """
        offered = super().offer(settings)
        verbs = known_by("reported", (*offered.verbs, *LINE))
        robots = tuple(dict.fromkeys((*settings.addresses.values(), SIMULATED)))
        known = settings.model.settings
        named = {**known, "robot": replace(known["robot"], choices=robots)}
        return replace(
            offered,
            verbs=tuple(known_by("timed", verbs, "gaze", "nudge", "hip")),
            outline=RobotOutline(
                settings=[setting.line() for setting in named.values()],
                robots=list(robots),
                moves=list(settings.model.animations.moves),
                tags=tags.offered(),
                camera=True,
            ).as_json(),
        )

    @classmethod
    def remarks(cls, settings: NaoqiSettings, written: Written) -> Iterable[Finding]:
        """What is odd about a command of an experiment file."""
        return text_remarks.remarks(settings, written, cls.CHECKS)

    @classmethod
    async def hear(cls, probe: Probe, seconds: float) -> HeardSound | None:
        """Its front microphone."""
        return await doctor.hear(probe, seconds)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Carry out a verb by its part; what was asked for is compared with the robot from now on.

        Raises `DeviceLostError` while no robot is connected, but for the verbs of the line.
        """
        if not self._closed:
            match job.verb:
                case "connect":
                    return await self._connect(text(job.args, "robot"))
                case "disconnect":
                    return await self._disconnect(requester(job.source))
        return await super().perform(job)

    async def _performed(self, job: Job) -> Mapping[str, Json]:
        part = self._by_verb[job.verb]
        await self._settling.settled()
        self._link.alert()
        try:
            with self._reading.using(job.verb):
                sent = await part.perform(job)
        except (RejectedError, DeviceLostError):
            raise
        except DriverError:
            # Perhaps it was done in part: what is missing shows as wanted.
            self._reading.noticed(job, part.implied(job))
            raise
        self._reading.noticed(job, part.implied(job))
        return sent

    async def stop(self, scope: Scope) -> StopReport | None:
        """Ask every part at once to stand still; return which of them confirmed in time.

        A robot that was lost cannot confirm anything. Nothing is stopped where none was connected.
        """
        if scope is Scope.ALL:
            self._stopped = True
            if self._living is not None and not self._living.done():
                self._waits = self._living.cancel()
        return await self._halt(scope)

    async def _halt(self, scope: Scope) -> StopReport | None:
        """Stand still, as for a stop, but nobody need release it: a robot is let go."""
        parts = self._parts if scope is Scope.ALL else self._drive
        if not self._present:
            moving = [part.name for part in parts if isinstance(part, BasePart | BodyPart)]
            return StopReport(missing=tuple(moving)) if self._lost_unasked else None
        loop = asyncio.get_running_loop()
        until = loop.time() + confirmed_stop.STOP_S
        first = self._stop_all(parts, scope)
        report = await confirmed_within(until - loop.time(), {n: [end] for n, end in first.items()})
        late = [end for end in first.values() if not end.done()]
        if not late:
            # NAOqi's services do not keep to one order among each other: what was sent just before
            # the stop may have begun behind it. What is sent on its answer comes behind both.
            again = self._stop_all(parts, scope)
            left = until - loop.time()
            await wait_at_most(again.values(), left, confirmed_stop.AGAIN_S)
            # A line that is too slow for both has confirmed the first.
            both = {n: [end for end in (first[n], again[n]) if end.done()] for n in first}
            report = await confirmed_within(0.0, both)
        for end in late:
            end.add_done_callback(self._report_late)
        confirmed = (name for name in report.confirmed if first[name].result() is not None)
        return StopReport(tuple(confirmed), report.missing)

    def _stop_all(
        self, parts: Sequence[NaoqiPart], scope: Scope
    ) -> dict[str, asyncio.Task[Pending]]:
        """Ask all at once, by name. Each returns when it stands still: nothing else has to come."""
        for part in parts:
            part.hold(scope)
        return {part.name: self._stops.start(part.halt(scope), part.name) for part in parts}

    def _report_late(self, stop: asyncio.Task[Pending]) -> None:
        """What was missing when the stop was reported ended after all: a step, on a slow line."""
        if succeeded(stop) and stop.result() is not None:
            name = stop.get_name()
            self.context.notice("info", f"{name}: confirmed late, it is stopped now")

    async def resume(self) -> None:
        """The stop was released: what could not be applied while it was pressed is applied now."""
        self._stopped = False
        for part in self._parts:
            part.resume()
        if self._waits and self._present:
            self._waits = False
            self._later.start(self._live())

    async def _live(self) -> None:
        try:
            await self._apply([part for part in self._parts if isinstance(part, AutonomyPart)])
        except DeviceLostError as error:
            if self._present:  # else the next connection does it
                what = f"what it does by itself could not be set: {error.what}"
                self.context.notice("warning", what, "set it on the robot's screen")

    async def _end_own(self) -> None:
        await self._later.close()
        await self._reading.close()

    async def _farewell(self) -> None:
        self._present = self._lost_unasked = False  # not before: a stop must reach it until then

    # -- the line --------------------------------------------------------------------------------

    async def _connect(self, robot: str) -> dict[str, Json]:
        self._link.named(robot)  # what is no address must not cost the robot that is there
        await self._let_go()
        await self._link.connect(robot)
        return {"robot": self._link.robot}

    async def _disconnect(self, by: str) -> dict[str, Json]:
        robot = self._link.robot
        await self._let_go()
        await self._link.disconnect(by)
        return {"robot": robot}

    async def _let_go(self) -> None:
        """The robot of before goes because the wizard wants it; it must not be left driving."""
        if self._present:
            robot = self._link.robot
            self._link.leaving(True)
            try:
                report = await self._halt(Scope.ALL)
            except BaseException:
                self._link.leaving(False)
                raise
            if report is not None and report.missing:
                missing = ", ".join(report.missing)
                self.context.notice(
                    "warning",
                    f"{robot} was disconnected, but did not confirm its stop: {missing}",
                    "check the robot: its last movement may continue",
                )
            self._lost()
        self._lost_unasked = False

    async def _connected(self) -> None:
        """The robot is there, for the first time or again."""
        self._present, self._lost_unasked = True, False
        self._reading.begin()
        self._waits = self._stopped
        await self._apply(
            [part for part in self._parts if not (self._stopped and isinstance(part, AutonomyPart))]
        )

    async def _apply(self, parts: Sequence[NaoqiPart]) -> None:
        """Let these parts set what the file says, or the wizard since."""
        tasks = {part: self._settling.start(part.connected()) for part in parts}
        for part, task in tasks.items():
            if isinstance(part, AutonomyPart):
                self._living = task
        done = await asyncio.gather(*tasks.values(), return_exceptions=True)
        self._reading.soon()
        for part, error in zip(parts, done, strict=True):
            if isinstance(error, DriverError) and not isinstance(error, DeviceLostError):
                self.context.notice("warning", f"{part.name}: {error.what}", error.remedy)
            elif isinstance(error, Exception):  # what a stop has cancelled waits for the release
                raise error

    def _lost(self) -> None:
        if not self._present:
            return
        self._present, self._lost_unasked = False, True
        super()._lost()
        self._reading.end()
