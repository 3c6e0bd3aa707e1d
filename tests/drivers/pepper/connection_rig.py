"""A connection as its driver has it, and what became of the calls that went through it."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.nao.settings import NaoSettings
from woz_drivers.naoqi_robot import autonomy, base, connection, line, link, parts
from woz_drivers.naoqi_robot.connection import RobotConnection
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.published_messages import PublishedMessages
from woz_tui.drivers.contract import DeviceLostError, DriverError, Health
from woz_tui.protocol.messages import DriverHealth

WITHIN_S = 20.0
SETTINGS = PepperSettings(robots=())


#: How long the driver waits for an answer, and how long it does so in `patience`.
LIMITS = {
    (line, "SILENT_S"): (line.SILENT_S, WITHIN_S),
    (line, "ANSWER_S"): (line.ANSWER_S, WITHIN_S),
    (link, "_LISTENS_WITHIN_S"): (link._LISTENS_WITHIN_S, WITHIN_S),
    (line, "NOTICED_S"): (line.NOTICED_S, 2 * WITHIN_S),
    **{(module, "LOOK_S"): (parts.LOOK_S, WITHIN_S) for module in (connection, base, autonomy)},
}


@contextmanager
def patience(*, hurried: bool = False) -> Iterator[None]:
    """A robot on a busy machine takes its time; that a silent one is soon known is shown by those
    tests that are about it: `hurried`, also inside of another patience.
    """
    with pytest.MonkeyPatch.context() as patch:
        for (module, name), (short, long) in LIMITS.items():
            patch.setattr(module, name, short if hurried else long)
        within = parts.WITHIN_S if hurried else WITHIN_S
        patch.setattr(RobotConnection.call, "__kwdefaults__", {"within": within})
        yield


@dataclass
class Outcome:
    """One call: when it was made and when its end was known (monotonic, ns), and how it ended."""

    name: str
    begun_ns: int
    ended_ns: int = 0
    error: DriverError | None = None
    ends: int = 0


@dataclass
class ConnectionRig:
    """One connection with what it told, and the calls made by `call`."""

    connection: RobotConnection
    published: PublishedMessages
    came: int = 0
    went: int = 0
    outcomes: list[Outcome] = field(default_factory=list)

    def health(self) -> tuple[str, str, str]:
        """The newest: state, detail, remedy."""
        told = self.published.all(DriverHealth)
        if not told:
            return "", "", ""
        state = type(told[-1]).__name__.removeprefix("Driver").lower()
        return state, told[-1].detail, told[-1].remedy

    async def is_so(self, health: Health, *words: str) -> None:
        """Return once the wizard is told this."""
        await self.published.until(
            lambda: (
                self.health()[0] == health.value
                and all(word in " ".join(self.health()[1:]) for word in words)
            )
        )

    async def until(self, holds: Callable[[], bool]) -> None:
        """Return when this is true; for what no message tells."""
        try:
            async with asyncio.timeout(WITHIN_S):
                while not holds():  # noqa: ASYNC110 - see above
                    await asyncio.sleep(0.005)
        except TimeoutError:
            told = [
                f"{type(one).__name__} {one.detail}" for one in self.published.all(DriverHealth)
            ]
            raise AssertionError(f"never; told last: {told[-8:]}") from None

    async def call(self, service: str, method: str, *args: Any, within: float = 10.0) -> Outcome:
        """Make a call and write down how it ends; raises nothing of the robot's."""
        outcome = Outcome(f"{service}.{method}", time.monotonic_ns())
        self.outcomes.append(outcome)
        try:
            await self.connection.call(service, method, *args, within=within)
        except DriverError as error:
            outcome.error = error
        outcome.ended_ns = time.monotonic_ns()
        outcome.ends += 1
        return outcome

    def begin(self, service: str, method: str, *args: Any, within: float = 10.0) -> Any:
        """The same in the background."""
        return asyncio.create_task(self.call(service, method, *args, within=within))


@asynccontextmanager
async def started_connection(
    folder: Path, *robots: str, kind: str = "pepper", **settings: Any
) -> AsyncIterator[ConnectionRig]:
    """A connection that has been started, to a robot of this kind."""
    published = PublishedMessages(folder)

    async def came() -> None:
        rig.came += 1

    def went() -> None:
        rig.went += 1

    naoqi_settings: NaoqiSettings = NaoSettings(address=next(iter(robots), ""), **settings)
    if kind == "pepper":
        naoqi_settings = replace(SETTINGS, robots=robots, **settings)
    rig = ConnectionRig(
        RobotConnection(naoqi_settings, published.context, on_connected=came, on_lost=went),
        published,
    )
    rig.connection.start()
    try:
        yield rig
    finally:
        await rig.connection.close()


def is_lost(outcome: Outcome) -> bool:
    """Whether the wizard was told that the robot is not connected."""
    return isinstance(outcome.error, DeviceLostError)


def threads_now() -> int:
    """How many threads there are, but for those that asyncio keeps for later."""
    return sum(not thread.name.startswith("asyncio") for thread in threading.enumerate())
