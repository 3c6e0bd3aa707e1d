"""Asking a robot for many values of ALMemory at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from woz_drivers.pepper.memory import items
from woz_drivers.pepper.parts import Robot, together
from woz_tui.core.driver import DriverError, Lost


class Asking:
    """All keys by one question; key by key at a robot that refuses all of it for one of them."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._key_by_key = False

    def forget(self) -> None:
        """It may be another robot."""
        self._key_by_key = False

    async def values(self, keys: Sequence[str]) -> dict[str, Any]:
        """What the robot holds, by key; None for what it does not have. Raises `Lost`."""
        if not self._key_by_key:
            said = await self._refusable("getListData", list(keys))
            if len(items(said)) == len(keys):
                return dict(zip(keys, said, strict=True))
            self._key_by_key = True
        said = await together(*(self._refusable("getData", key) for key in keys))
        return dict(zip(keys, said, strict=True))

    async def _refusable(self, method: str, words: str | list[str]) -> Any:
        """What the robot says; None if it says no. Raises `Lost`."""
        try:
            return await self._robot.call("ALMemory", method, words)
        except Lost:
            raise
        except DriverError:
            return None
