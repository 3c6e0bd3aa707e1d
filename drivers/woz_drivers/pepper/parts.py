"""What a Pepper is made of for its driver: parts, each with its verbs, its settings, its stop.

The driver (`driver.py`) hands each verb to its part, asks every part to stop at once, and tells all
of them when the robot is there again with fresh services.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

from woz_drivers.pepper.naoqi_link import Methods, Unsubscribe
from woz_drivers.pepper.settings import PepperSettings
from woz_tui.drivers.contract import DriverContext, DriverError, Job, RejectedError, Scope, Verb
from woz_tui.protocol.messages import Json

if TYPE_CHECKING:
    from woz_drivers.pepper.served_files import ServedFiles

#: Seconds that an ordinary call may take; what takes its time (speech, a move) says so itself.
WITHIN_S = 2.0
#: A question about the robot's settings may take so long.
LOOK_S = 0.9


class ServiceAbsentError(DriverError):
    """The robot has no such service now."""


class RobotCalls(Protocol):
    """The robot as its parts see it: `connection.Connection` implements it.

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

    async def listen(self, service: str, signal: str, heard: Callable[..., None]) -> Unsubscribe:
        """Hear a signal until the connection is lost (a part listens again in `connected`)."""
        ...

    async def serve(self, name: str, methods: Methods) -> Unsubscribe:
        """Offer the robot a service of ours (`Link.serve`) until the connection is lost."""
        ...

    @property
    def there(self) -> bool:
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


class PepperPart:
    """One part. Made once a session; survives reconnections. By itself it offers nothing, and
    has nothing to stop, to set, to forget, to read back, to let go of.
    """

    #: What the stop calls it: speech, motion, animations, tablet ...
    name: ClassVar[str]

    def __init__(self, robot: RobotCalls, settings: PepperSettings, context: DriverContext) -> None:
        self._robot = robot
        self._settings = settings
        self._context = context

    @classmethod
    def verbs(cls, settings: PepperSettings) -> tuple[Verb, ...]:
        """What it offers."""
        return ()

    @classmethod
    def sensors(cls, settings: PepperSettings) -> tuple[str, ...]:
        """What it publishes."""
        return ()

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Carry out one of its verbs; cancelled by the stop: then end it on the robot, too, but do
        not wait for that (the part's `stop` does).
        """
        raise RejectedError(f"{self.name} cannot {job.verb}")

    async def stop(self, scope: Scope) -> tuple[str, ...]:
        """Stand still; return what confirmed, in words (`speech`, `motion` ...). Raises if nothing
        did. Nothing to stop: return at once with nothing.
        """
        return ()

    async def connected(self) -> None:
        """The robot is there, for the first time or again: apply what the settings say."""

    def lost(self) -> None:
        """The robot is gone: forget ids and subscriptions, sensors are stale."""

    async def read(self) -> Mapping[str, Json]:
        """Settings as the robot has them now, by name; called once a second or more."""
        return {}

    async def rest(self) -> None:
        """Take the pose in which the robot may be left alone."""

    async def close(self) -> None:
        """Let go: end tasks, close files, unsubscribe. Never raises."""


async def together(*calls: Any) -> list[Any]:
    """All at once; the first failure is raised when all have ended."""
    done = await asyncio.gather(*calls, return_exceptions=True)
    for one in done:
        if isinstance(one, BaseException):
            raise one
    return done
