"""A stand-in for a driver's hardware, and what it can say."""

from __future__ import annotations

import inspect
import unittest
from collections.abc import Awaitable, Callable, Mapping
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from typing import Any

from woz_tui.drivers.contract import SHOWN
from woz_tui.testing.recording_context import PlainJob

_NEEDS = {
    "return": "plug=",
    "errors": "command=, fail=",
    "units": "command=, received= or senses=",
}


@dataclass(frozen=True, slots=True)
class Device:
    """A stand-in for the hardware, at the other end of the driver's wire.

    Only `settings` and `unplug` are necessary; each of the others shows something more. All but
    `settings` and `command` may be coroutines.

    Attributes:
        settings: With which the driver finds it.
        unplug: Pulls its cable.
        plug: Puts the cable back: the driver finds its device again, and nothing moves by itself.
        command: One that goes on for at least 20 s; None for a driver that offers no such verb.
        still: Whether what `command` moves stands still now: a stop is over only then.
        received: What has reached it of `command`, as numbers by name, in the units of the
            contract: m, s, degrees. Compared with `expected`.
        expected: None: the numbers among the command's arguments, joints by their names.
        senses: Has it sense something, and gives the readings that must come of it, by sensor, in
            the units of the contract. Called again until they have come.
        fail: Has it answer the next command with an error.
    """

    settings: Any
    unplug: Callable[[], object]
    plug: Callable[[], object] | None = None
    command: PlainJob | None = None
    still: Callable[[], bool | Awaitable[bool]] | None = None
    received: Callable[[], Mapping[str, float] | Awaitable[Mapping[str, float]]] | None = None
    expected: Mapping[str, float] | None = None
    senses: Callable[[], Mapping[str, float] | Awaitable[Mapping[str, float]]] | None = None
    fail: Callable[[], object] | None = None

    @property
    def shows(self) -> list[str]:
        """Which of `SHOWN` it can show of a driver."""
        moves = self.command is not None
        can = {
            "stop": moves and self.still is not None,
            "loss": True,
            "return": self.plug is not None,
            "errors": moves and self.fail is not None,
            "units": (moves and self.received is not None) or self.senses is not None,
        }
        return [word for word in SHOWN if can[word]]

    def needs(self, word: str) -> None:
        """Skip a test that shows this, and say so, if it cannot. Raises `unittest.SkipTest`."""
        if word not in self.shows:
            raise unittest.SkipTest(f"not shown: {SHOWN[word]}; give Device({_NEEDS[word]})")

    async def stands_still(self) -> bool:
        """What `still` says; True where nothing can be said."""
        return self.still is None or bool(await answer(self.still))


async def answer(asked: Callable[[], Any]) -> Any:
    """What a function or coroutine of the device says."""
    said = asked()
    return await said if inspect.isawaitable(said) else said


Devices = AbstractAsyncContextManager[Device]
