"""The parts of a robot with NAOqi for its driver: each has its verbs, its settings and its stop.

The driver (`driver.py`) hands each verb to its part, asks every part to stop at once, and tells all
of them when the robot is there again with fresh services.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Protocol

from woz_drivers.naoqi_robot import memory
from woz_drivers.naoqi_robot.link import Methods, Unsubscribe
from woz_drivers.naoqi_robot.robot_settings import NaoqiSetting
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.background import BackgroundTasks
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverContext,
    DriverError,
    Job,
)
from woz_tui.drivers.robot_parts import RobotPart
from woz_tui.protocol.messages import Json

#: Seconds that an ordinary call may take; what takes its time (speech, a move) says so itself.
WITHIN_S = 2.0
#: A question about the robot's settings may take so long.
LOOK_S = 0.9


class ServiceAbsentError(DriverError):
    """The robot has no such service now."""


#: Why a call must not be made now; None: it may.
Refusal = Callable[[str, tuple[Any, ...]], DriverError | None]


class RobotCalls(Protocol):
    """The robot as its parts see it: `RobotConnection` implements it.

    All raise `drivers.contract` errors: `DeviceLostError` when the robot is not connected or silent
    (nothing is sent while it is silent), `DriverError` with the robot's own words when it says no,
    `ServiceAbsentError` where it has no such service.
    """

    async def call(self, service: str, method: str, *args: Any, within: float = WITHIN_S) -> Any:
        """Call a method of a service of the robot."""
        ...

    async def ask(self, service: str, method: str, *args: Any) -> Any:
        """A question about a setting: not in a hurry, and never in the way of a command."""
        ...

    async def probe(self) -> None:
        """Return when the robot has answered a question asked now: do this before anything that
        must not happen late, such as driving.
        """
        ...

    async def listen(self, service: str, signal: str, listener: Callable[..., None]) -> Unsubscribe:
        """Hear a signal until the connection is lost (a part listens again in `connected`)."""
        ...

    async def serve(self, name: str, methods: Methods) -> Unsubscribe:
        """Offer the robot a service of ours (`NaoqiLink.serve`) until the connection is lost."""
        ...

    def guard(self, refused: Refusal) -> None:
        """From now on each call is refused for which `refused` gives an error: `(what, args)`."""
        ...

    def refused(self, what: str, *args: Any) -> DriverError | None:
        """Why this call would be refused now: `ALMotion.moveTo`; None: it would be sent."""
        ...

    def unwell(self, what: str, remedy: str = "") -> None:
        """The robot is there, and a part of it is not well: `what`; empty: it is well again."""
        ...

    @property
    def ready(self) -> bool:
        """Whether it is connected and answers."""
        ...

    @property
    def local_host(self) -> str:
        """This machine's address as the robot reaches it; empty while not connected."""
        ...

    @property
    def files(self) -> ServedFiles:
        """What the robot and its tablet may fetch from this machine."""
        ...


class NaoqiPart(RobotPart[RobotCalls, NaoqiSettings]):
    """One part of a robot with NAOqi. Where a verb is cancelled by the stop it ends on the robot,
    too, but `perform` does not wait for that: `stop` does.
    """

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        #: What must still be said to the robot after a job was cut short, without the job waiting.
        #: The next job of the same kind waits for it: an ending that came late would end that one.
        self._clean_up = BackgroundTasks(f"{self.name}: ending it on the robot")

    async def _cleaned_up(self) -> None:
        """Return when nothing of that is on its way, or the robot does not answer."""
        await self._clean_up.settled(WITHIN_S)

    def implied(self, job: Job) -> Mapping[str, Json]:
        """Settings that the wizard wants since this verb, by name, besides those that it names."""
        return {}

    async def read(self) -> Mapping[str, Json]:
        """Settings as the robot has them now, by name; called once a second or more."""
        return {}

    def conflicts(self) -> Iterable[str]:
        """What keeps the robot from obeying, the gravest first: a short clause, a colon, why."""
        return ()

    async def close(self) -> None:
        """Let go: end tasks, close files, unsubscribe. Never raises."""
        await super().close()
        await self._clean_up.close()


async def together(*calls: Any) -> list[Any]:
    """All at once; the first failure is raised when all have ended."""
    done = await asyncio.gather(*calls, return_exceptions=True)
    for result in done:
        if isinstance(result, BaseException):
            raise result
    return done


# -- calls to the robot ----------------------------------------------------------------------------

#: For calls that end when something has ended on the robot: longer than any of that takes. A robot
#: that falls silent meanwhile is noticed by the connection.
LONG_S = 3600.0

Call = Coroutine[Any, Any, Any]


async def answers(calls: Mapping[str, Call]) -> dict[str, Any]:
    """Await everything at once; what the robot did not answer is left out.

    Raises `DeviceLostError` when nothing at all was answered because the robot is gone.
    """
    results = await asyncio.gather(*calls.values(), return_exceptions=True)
    answered = {}
    for name, answer in zip(calls, results, strict=True):
        if not isinstance(answer, BaseException):
            answered[name] = answer
        elif not isinstance(answer, DriverError):
            raise answer
    if not answered and results and all(isinstance(answer, DeviceLostError) for answer in results):
        raise DeviceLostError(str(results[0]))
    return answered


async def read_back(robot: RobotCalls, settings: Iterable[NaoqiSetting]) -> dict[str, Json]:
    """These settings as the robot has them, by name; what makes no sense is left out."""
    readable_settings = {setting.name: setting for setting in settings if setting.get}
    results = await answers(
        {name: robot.ask(*setting.get) for name, setting in readable_settings.items()}
    )
    understood = {
        name: _UNDERSTOOD[readable_settings[name].kind](value) for name, value in results.items()
    }
    return {name: value for name, value in understood.items() if value is not None}


def write_setting(robot: RobotCalls, setting: NaoqiSetting, value: Json) -> Call:
    """Set it on the robot."""
    if setting.kind == "number":
        value = float(str(value))
    return robot.call(*setting.put, value, within=setting.within)


def _number(value: Any) -> float | None:
    number = memory.number(value)
    return None if number is None else round(number, 3)


_UNDERSTOOD: Mapping[str, Callable[[Any], Json]] = {
    "flag": memory.flag,
    "number": _number,
    "choice": memory.word,
}


async def apply(context: DriverContext, calls: Mapping[str, Call]) -> list[str]:
    """Set everything at once; what the robot refuses is a warning that names it.

    Returns what was set. Raises `DeviceLostError` if the robot went away meanwhile.
    """
    results = await asyncio.gather(*calls.values(), return_exceptions=True)
    done = []
    for name, answer in zip(calls, results, strict=True):
        if isinstance(answer, DriverError) and not isinstance(answer, DeviceLostError):
            context.notice("warning", f"{name} could not be set: {answer.what}", answer.remedy)
        elif isinstance(answer, BaseException):
            raise answer
        else:
            done.append(name)
    return done


if TYPE_CHECKING:
    from woz_drivers.naoqi_robot.served_files import ServedFiles
