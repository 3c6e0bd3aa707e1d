"""A robot that is made of parts: each has its verbs, its sensors, its settings, its share of the
stop. The driver hands each verb to its part, stops all of them at once, and tells them when the
robot is there and when it is gone.

    class Lamp(RobotPart[LampLink, LampSettings]):
        name = "light"
        SETTINGS = (RobotSetting("Light", "light", "color", "a name or #rrggbb", "eyes", "color"),)
        ...

    class LampRobot(RobotOfParts[LampLink, LampSettings]):
        PARTS = (Lamp,)
        called = "a lamp"
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Mapping, Sequence
from types import TracebackType
from typing import Any, ClassVar, Generic, Protocol, TypeVar

from woz_tui.drivers import confirmed_stop
from woz_tui.drivers.background import Background, BackgroundTasks
from woz_tui.drivers.confirmed_stop import confirmed_within, succeeded
from woz_tui.drivers.contract import (
    DeviceLostError,
    Driver,
    DriverContext,
    DriverError,
    Forecast,
    Job,
    Offer,
    RejectedError,
    Scope,
    StopReport,
)
from woz_tui.drivers.robot_settings import RobotSetting
from woz_tui.protocol.messages import Json, SettingsShown
from woz_tui.protocol.robot_outline import RobotOutline
from woz_tui.system.tasks import wait_at_most


class RobotLink(Protocol):
    """The connection to a robot, as its driver sees it."""

    @property
    def ready(self) -> bool:
        """Whether the robot is there and took what was asked for."""

    def need(self) -> object:
        """Raise `DeviceLostError` with the present reason unless it is `ready`."""

    def start(self) -> None:
        """Begin to look for the robot; return at once."""

    async def close(self) -> None:
        """Let go of the robot."""


#: Parts have so long to end at the robot what goes on, in seconds.
PARTS_CLOSE_S = 1.5

log = logging.getLogger(__name__)

#: How parts reach the robot, and the settings of its section in the robot file.
L = TypeVar("L")
S = TypeVar("S")
LinkT = TypeVar("LinkT", bound=RobotLink)


#: What has to come before a part has stopped; None: there is nothing of it to stop, nor to report.
Pending = Sequence[asyncio.Future[Any]] | None


class RefusalAllowed:
    """`with RefusalAllowed():` goes on behind it where the robot does not take what is asked of it
    in there. A robot that is gone is `DeviceLostError` all the same.

    Args:
        tell: Warns of the refusal; None: nobody need know.
        what: Stands before the robot's words then.
    """

    def __init__(self, tell: DriverContext | None = None, what: str = "") -> None:
        self._tell = tell
        self._before = f"{what}: " if what else ""

    def __enter__(self) -> None:
        pass

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> bool:
        if not isinstance(error, DriverError) or isinstance(error, DeviceLostError):
            return False
        if self._tell is not None:
            self._tell.notice("warning", f"{self._before}{error.what}", error.remedy)
        return True


class RobotPart(Generic[L, S]):
    """One part. Made once a session, survives reconnections; by itself it offers nothing."""

    #: What the stop calls it; empty: it has nothing to stop.
    name: ClassVar[str] = ""
    #: Settings of the robot that it shows and changes.
    SETTINGS: ClassVar[tuple[RobotSetting, ...]] = ()

    def __init__(self, link: L, settings: S, context: DriverContext) -> None:
        self._link = link
        self._settings = settings
        self._context = context
        self._works: list[Background] = []

    def background(self, what: str) -> Background:
        """Work beside its commands, one task at a time; it ends when the part is closed."""
        work = Background(what, self._context)
        self._works.append(work)
        return work

    @classmethod
    def offer(cls, settings: S) -> Offer:
        """Its verbs, its sensors, its joints, what people may expect of it and it lacks."""
        return Offer()

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """How one of its verbs would go; by itself nothing is known."""
        return Forecast()

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Carry out one of its verbs."""
        raise RejectedError(f"{self.name or 'this part'} cannot {job.verb}")

    def hold(self, scope: Scope) -> None:
        """The stop, here: begin and send nothing more of what went on, also when it is back.

        `Scope.DRIVE` reaches parts with a verb that drives alone, and ends nothing but that.
        """

    async def halt(self, scope: Scope) -> Pending:
        """The stop, there: send what ends it; returns what has to come before it has ended, an
        empty list if nothing has to.
        """
        return None

    def resume(self) -> None:
        """The stop was released."""

    async def connected(self) -> None:
        """The robot is there, for the first time or again: apply what was asked for.

        Raises `DriverError` for what it did not take.
        """

    def lost(self) -> None:
        """The robot is gone."""

    def shown(self) -> Mapping[str, Json]:
        """Its settings by name, as far as they are known."""
        return {}

    async def rest(self) -> None:
        """Take the pose in which the robot may be left alone."""

    async def close(self) -> None:
        """End what goes on. Never raises."""
        for work in self._works:
            await work.close()


class RobotOfParts(Driver, Generic[LinkT, S]):
    """The driver; a robot's own says of what parts it is made, and makes them with its link.

    The link awaits `_connected` each time that the robot is there, and calls `_lost` each time that
    it is gone.
    """

    PARTS: ClassVar[tuple[type[RobotPart[Any, Any]], ...]]
    #: In a sentence: a Furhat.
    called: ClassVar[str]
    settings: S

    def __init__(
        self,
        name: str,
        settings: S,
        context: DriverContext,
        link: LinkT,
        parts: Sequence[RobotPart[Any, S]],
    ) -> None:
        super().__init__(name, settings, context)
        self._link = link
        self._parts = parts
        offered = [(part, part.offer(settings).verbs) for part in parts]
        self._by_verb: Mapping[str, RobotPart[Any, S]] = {
            verb.name: part for part, verbs in offered for verb in verbs
        }
        #: What a stop of driving reaches.
        self._drive: Sequence[RobotPart[Any, S]] = [
            part for part, verbs in offered if any(verb.drives for verb in verbs)
        ]
        self._stops = BackgroundTasks("a stop")
        self._shown: dict[str, Json] = {}
        self._closed = False

    @classmethod
    def offer(cls, settings: S) -> Offer:
        """What its parts offer, and for a console: settings that can be shown and changed, what
        `play` takes, whether there is a camera.
        """
        offers = [part.offer(settings) for part in cls.PARTS]
        verbs = {verb.name: verb for each in offers for verb in each.verbs}
        rows = (row for part in cls.PARTS for row in part.SETTINGS)
        return Offer(
            verbs=tuple(verb for each in offers for verb in each.verbs),
            sensors=tuple(sensor for each in offers for sensor in each.sensors),
            lacks={verb: why for each in offers for verb, why in each.lacks.items()},
            joints={name: span for each in offers for name, span in (each.joints or {}).items()}
            or None,
            outline=RobotOutline(
                settings=[row.line() for row in rows if not row.verb or row.verb in verbs],
                moves=list(verbs["play"].arguments[0].choices) if "play" in verbs else [],
                camera="picture" in verbs,
            ).as_json(),
        )

    async def open(self) -> None:
        """Begin to look for the robot."""
        self._link.start()

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """As its part says."""
        part = self._by_verb.get(verb)
        return Forecast() if part is None else await part.predict(verb, args)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Carry out a verb by its part. Raises `DeviceLostError` while no robot is connected."""
        if self._closed:
            raise DeviceLostError("the robot's driver is closed", "start the session again")
        if job.verb not in self._by_verb:
            raise RejectedError(f"{self.called} cannot {job.verb!r}")
        return await self._performed(job)

    async def _performed(self, job: Job) -> Mapping[str, Json]:
        """What its part makes of it; what it changed is shown."""
        self._link.need()
        try:
            return await self._by_verb[job.verb].perform(job)
        finally:
            self._show()

    async def stop(self, scope: Scope) -> StopReport | None:
        """Stop every part at once, or those that drive; each confirms when what it waits for has
        come. What is late goes on until the release.
        """
        parts = self._parts if scope is Scope.ALL else self._drive
        for part in parts:
            part.hold(scope)
        if not parts or not self._link.ready:
            return None
        if scope is Scope.ALL:
            self._stops.cancel()
        loop = asyncio.get_running_loop()
        until = loop.time() + confirmed_stop.STOP_S
        halts = [self._stops.start(part.halt(scope)) for part in parts]
        await wait_at_most(halts, until - loop.time(), confirmed_stop.AGAIN_S)
        taken = self._taken()
        unknown = loop.create_future()  # what would end a part that has not said it yet
        ends: dict[str, list[asyncio.Future[Any]]] = {}
        for part, halt in zip(parts, halts, strict=True):
            own = halt.result() if succeeded(halt) else (unknown,)
            if part.name and own is not None:
                ends[part.name] = [*taken, halt, *own]
        return await confirmed_within(until - loop.time(), ends) if ends else None

    def _taken(self) -> Sequence[asyncio.Future[Any]]:
        """Ends when the robot has taken what was sent so far, where that is asked for."""
        return ()

    async def resume(self) -> None:
        """The stop was released: what is asked for from now on must not end by it."""
        self._stops.cancel()
        for part in self._parts:
            part.resume()

    async def rest(self) -> None:
        """Have every part take the pose in which the robot may be left alone."""
        if self._link.ready:
            for part in self._parts:
                await part.rest()

    async def close(self) -> None:
        """End everything of this driver; the robot stays as it is."""
        if self._closed:
            return
        self._closed = True
        await self._end_own()
        await self._stops.close(0.0)
        closing = [asyncio.ensure_future(part.close()) for part in self._parts]
        _, late = await asyncio.wait(closing, timeout=PARTS_CLOSE_S)
        for end in late:
            end.cancel()
        if late:
            await asyncio.wait(late, timeout=PARTS_CLOSE_S)
        for end in closing:
            if end.done() and not end.cancelled() and end.exception() is not None:
                log.error("a part did not close", exc_info=end.exception())
        await self._farewell()
        await self._link.close()

    async def _end_own(self) -> None:
        """End what the driver itself has under way, before its parts."""

    async def _farewell(self) -> None:
        """What the robot is still told at the end."""

    async def _connected(self) -> None:
        """Have every part apply what was asked for; what the robot did not take is told."""
        for part in self._parts:
            with RefusalAllowed(self.context):
                await part.connected()
        self._show()

    def _lost(self) -> None:
        if not self._closed:
            for part in self._parts:
                part.lost()

    def _show(self) -> None:
        """The settings as the robot has them, if they have changed."""
        if self._closed:
            return
        shown: dict[str, Json] = {}
        for part in self._parts:
            shown |= part.shown()
        if shown != self._shown:
            self._shown = shown
            self.context.show(SettingsShown(values=shown))
