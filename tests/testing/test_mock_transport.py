"""A stand-in for a library takes what the library takes, and nothing else."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from woz_tui.testing import MockTransport


class ArmLibrary:
    """A maker's class."""

    def __init__(self, port: str) -> None:
        raise OSError(port)

    def turn(self, degrees: float) -> None:
        """Begin to turn."""

    async def reach(self, metres: float) -> bool:
        """Reach out, to the end."""
        return True

    def halt(self) -> None:
        """Stand still."""


class Arm:
    """As much of a driver as counts here."""

    transport: Any = ArmLibrary


async def test_calls_are_kept_and_movements_last_until_a_halt() -> None:
    with MockTransport(Arm, moves=["turn", "reach"], halts=["halt"]) as mock:
        arm = Arm.transport("/dev/arm")
        arm.turn(30.0)
        assert (mock.received(), mock.still()) == ({"degrees": 30.0}, False)
        arm.halt()
        assert mock.still()
        mock.answers["reach"] = True
        reaching = asyncio.create_task(arm.reach(metres=0.4))
        await asyncio.sleep(0)
        assert not mock.still()
        arm.halt()
        assert await reaching
        assert mock.calls == [
            ("turn", {"degrees": 30.0}),
            ("halt", {}),
            ("reach", {"metres": 0.4}),
            ("halt", {}),
        ]
    assert Arm.transport is ArmLibrary


async def test_a_wrong_call_is_as_wrong_as_without_it() -> None:
    with MockTransport(Arm):
        with pytest.raises(TypeError):
            Arm.transport()
        with pytest.raises(TypeError):
            Arm.transport("/dev/arm").turn(30.0, "left")
        with pytest.raises(AttributeError):
            Arm.transport("/dev/arm").fly()


async def test_a_pulled_cable_ends_what_moves_and_an_error_comes_once() -> None:
    with MockTransport(Arm, moves=["turn", "reach"], lost=OSError("unplugged")) as mock:
        arm = Arm.transport("/dev/arm")
        reaching = asyncio.create_task(arm.reach(0.4))
        await asyncio.sleep(0)
        mock.unplug()
        for lost in (reaching, arm.reach(0.4)):
            with pytest.raises(OSError, match="unplugged"):
                await lost
        with pytest.raises(OSError, match="unplugged"):
            Arm.transport("/dev/arm")
        mock.plug()
        mock.fail(ValueError("too hot"))
        with pytest.raises(ValueError, match="too hot"):
            arm.turn(30.0)
        arm.turn(30.0)
