"""What the parts have in common when they call the robot."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Coroutine, Iterable, Mapping
from typing import Any

from woz_drivers.pepper import memory
from woz_drivers.pepper.parts import WITHIN_S, RobotCalls
from woz_drivers.pepper.robot_settings import RobotSetting
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError
from woz_tui.protocol.messages import Json

#: For calls that end when something has ended on the robot: longer than any of that takes. A robot
#: that falls silent meanwhile is noticed by the connection.
LONG_S = 3600.0
#: What a job's end still has to say may take so long when the session is over.
FAREWELL_S = 0.5

Call = Coroutine[Any, Any, Any]


async def answers(calls: Mapping[str, Call]) -> dict[str, Any]:
    """Ask everything at once; whatever the robot did not say is left out.

    Raises `DeviceLostError` when nothing at all was answered because the robot is gone.
    """
    said = await asyncio.gather(*calls.values(), return_exceptions=True)
    found = {}
    for name, answer in zip(calls, said, strict=True):
        if not isinstance(answer, BaseException):
            found[name] = answer
        elif not isinstance(answer, DriverError):
            raise answer
    if not found and said and all(isinstance(answer, DeviceLostError) for answer in said):
        raise DeviceLostError(str(said[0]))
    return found


async def read_back(robot: RobotCalls, settings: Iterable[RobotSetting]) -> dict[str, Json]:
    """These settings as the robot has them, by name; what makes no sense is left out."""
    asked = {one.name: one for one in settings if one.get}
    said = await answers({name: robot.ask(*one.get) for name, one in asked.items()})
    understood = {name: _UNDERSTOOD[asked[name].kind](value) for name, value in said.items()}
    return {name: value for name, value in understood.items() if value is not None}


def put_setting(robot: RobotCalls, setting: RobotSetting, value: Json) -> Call:
    """Set it on the robot."""
    if setting.kind == "number":
        value = float(str(value))
    return robot.call(*setting.put, value, within=setting.within)


def _number(value: Any) -> float | None:
    found = memory.number(value)
    return None if found is None else round(found, 3)


_UNDERSTOOD: Mapping[str, Callable[[Any], Json]] = {
    "flag": memory.flag,
    "number": _number,
    "choice": memory.word,
}


async def apply(context: DriverContext, calls: Mapping[str, Call]) -> list[str]:
    """Set everything at once; what the robot refuses is a warning that names it.

    Returns what was set. Raises `DeviceLostError` if the robot went away meanwhile.
    """
    said = await asyncio.gather(*calls.values(), return_exceptions=True)
    done = []
    for name, answer in zip(calls, said, strict=True):
        if isinstance(answer, DriverError) and not isinstance(answer, DeviceLostError):
            context.notice("warning", f"{name} could not be set: {answer.what}", answer.remedy)
        elif isinstance(answer, BaseException):
            raise answer
        else:
            done.append(name)
    return done


class CleanUpCalls:
    """What must still be said to the robot after a job was cut short, without the job waiting.

    The next job of the same kind waits for it: an ending that arrives late would end that one.
    """

    def __init__(self) -> None:
        self._tasks: set[asyncio.Task[None]] = set()

    def send(self, call: Call) -> None:
        """Send it now; a robot that is gone needs no ending."""
        task = asyncio.get_running_loop().create_task(_quietly(call), name="pepper ending")
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def settled(self) -> None:
        """Return when nothing is on its way, or the robot does not answer."""
        if self._tasks:
            await asyncio.wait(self._tasks, timeout=WITHIN_S)

    async def close(self) -> None:
        """Let it arrive if the robot is quick; give up what is left."""
        if self._tasks:
            await asyncio.wait(self._tasks, timeout=FAREWELL_S)
        for task in list(self._tasks):
            task.cancel()
        if self._tasks:
            await asyncio.wait(self._tasks)


async def _quietly(call: Call) -> None:
    with contextlib.suppress(DriverError):
        await call
