"""What the robot has set, read back from it all the time and told on a change."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Mapping, Sequence

from woz_drivers.pepper.address import parse
from woz_drivers.pepper.conflicts import Uses, conflicts
from woz_drivers.pepper.connection import Connection
from woz_drivers.pepper.parts import Part
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.pepper.wanted import Wanted
from woz_tui.core.driver import DriverError, Job, Outlet, Rejected
from woz_tui.core.messages import Json, SettingsShown

#: At most so long from one reading to the next.
EVERY_S = 0.9
#: After a verb so long passes before its settings are read: in a burst of keys they are read once,
#: and the next key does not wait behind the questions that the last one raised.
LULL_S = 0.1

log = logging.getLogger(__name__)


class Reading:
    """A loop while the robot is there. A part whose robot does not answer hides no other."""

    def __init__(
        self,
        connection: Connection,
        parts: Sequence[Part],
        settings: PepperSettings,
        outlet: Outlet,
    ) -> None:
        self._connection = connection
        self._parts = parts
        self._outlet = outlet
        self._wanted = Wanted(settings)
        self._names = _names(settings)
        self._uses = Uses(outlet.clock)
        self._soon = asyncio.Event()
        self._loop: asyncio.Task[None] | None = None
        self._told: SettingsShown | None = None
        self._broken: set[str] = set()

    def begin(self) -> None:
        """The robot is there: read."""
        self.end()
        self._loop = asyncio.get_running_loop().create_task(self._run(), name="pepper settings")

    def end(self) -> None:
        """The robot is gone: nothing is known of its settings."""
        if self._loop is not None:
            self._loop.cancel()
            self._loop = None
            self._tell({"robot": self._robot()}, {}, [])

    def soon(self) -> None:
        """Something has just changed: read after a lull, not at the end of the pause."""
        self._soon.set()

    def using(self, verb: str) -> contextlib.AbstractContextManager[None]:
        """While a verb is performed: it counts for what may be in conflict, and a while longer."""
        return self._uses.of(verb)

    def noticed(self, job: Job) -> None:
        """A verb was performed: what it set is wanted, and looked at soon."""
        self._wanted.note(job.verb, job.args)
        self._soon.set()

    async def close(self) -> None:
        """Read no more."""
        loop, self._loop = self._loop, None
        if loop is not None:
            loop.cancel()
            await asyncio.wait([loop])

    async def _run(self) -> None:
        while self._loop is asyncio.current_task():
            self._soon.clear()
            values = await self._values()
            against = conflicts(values, self._uses.now(), self._wanted.asked)
            self._tell(values, self._wanted.differing(values), against)
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(EVERY_S):
                    await self._soon.wait()
                    await asyncio.sleep(LULL_S)

    async def _values(self) -> dict[str, Json]:
        values: dict[str, Json] = {"robot": self._robot()}
        read = await asyncio.gather(*(part.read() for part in self._parts), return_exceptions=True)
        for part, found in zip(self._parts, read, strict=True):
            if isinstance(found, Mapping):
                values |= found
            elif not isinstance(found, DriverError):
                self._complain(part.name, found)
        return {name: _steady(name, value) for name, value in values.items()}

    def _robot(self) -> str:
        """As the robot file writes it, where it does."""
        return self._names.get(self._connection.robot, self._connection.robot)

    def _complain(self, part: str, error: BaseException) -> None:
        """A mistake of ours: told once, and the others are still read."""
        if part not in self._broken:
            self._broken.add(part)
            log.error("reading the settings of %s failed", part, exc_info=error)
            self._outlet.notice(
                "error",
                f"settings of {part} cannot be read: {error!r}",
                "this is a bug of the driver; the robot process's own log has its traceback",
            )

    def _tell(self, values: dict[str, Json], wanted: dict[str, Json], against: list[str]) -> None:
        shown = SettingsShown(values=values, wanted=wanted, conflicts=against)
        if shown != self._told:
            self._told = shown
            self._outlet.show(shown)


def _names(settings: PepperSettings) -> dict[str, str]:
    """How the connection calls each robot of the file, and how the file does."""
    names = {}
    for text in settings.robots:
        with contextlib.suppress(Rejected):
            names[parse(text).shown] = text
    return names


def _steady(name: str, value: Json) -> Json:
    """Without digits that nobody wants to be told of: a battery never stands still."""
    if not isinstance(value, float):
        return value
    return round(value, 2 if name == "battery" else 3)
