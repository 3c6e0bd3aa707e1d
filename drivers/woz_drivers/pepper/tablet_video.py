"""Whether a video on the tablet has ended, asked for where no signal tells it."""

from __future__ import annotations

import asyncio

from woz_drivers.pepper.memory import number
from woz_drivers.pepper.parts import Robot
from woz_tui.core.driver import DriverError, Lost

#: How often it is asked, and how soon a video has to begin, in seconds.
_LOOK_S = 1.0
_BEGINS_WITHIN_S = 20.0
#: So near to its end it has ended, in milliseconds.
_NEAR_MS = 300.0


async def played(robot: Robot) -> bool:
    """Return when the video is over: True if it has played, False if it never began.

    A tablet that does not tell is never over here. Raises `Lost`.
    """
    loop = asyncio.get_running_loop()
    until = loop.time() + _BEGINS_WITHIN_S
    began = False
    while True:
        await asyncio.sleep(_LOOK_S)
        position, length = await _asked(robot, "Position"), await _asked(robot, "Length")
        if position is None:
            await loop.create_future()  # the signal will tell
        elif position > 0:
            began = True
            if length is not None and length > 0 and position >= length - _NEAR_MS:
                return True
        elif began:
            return True
        elif loop.time() >= until:
            return False


async def _asked(robot: Robot, what: str) -> float | None:
    """Milliseconds; None if the tablet does not tell."""
    try:
        return number(await robot.call("ALTabletService", f"getVideo{what}"))
    except Lost:
        raise
    except DriverError:
        return None
