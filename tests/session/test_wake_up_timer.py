"""One alarm rings once, at the moment that was set last."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from tests.fakes.virtual_time import LoopClock, run_virtual
from woz_tui.bus.hub import Hub
from woz_tui.session.engagement_robot import WakeUpTimer

SECOND = 1_000_000


def rings(scenario: Callable[[WakeUpTimer], Awaitable[None]]) -> list[float]:
    """When it rang, in seconds of a minute."""

    async def go() -> list[float]:
        loop = asyncio.get_running_loop()
        rang: list[float] = []
        hub = Hub(LoopClock(loop), lambda message, line: None)
        await scenario(WakeUpTimer(hub, lambda: rang.append(round(loop.time(), 2))))
        await asyncio.sleep(60 - loop.time())
        return rang

    return run_virtual(go())


def test_only_the_moment_that_was_set_last_counts() -> None:
    async def scenario(alarm: WakeUpTimer) -> None:
        for seconds in (5, 2, 9, 7):
            alarm.set(seconds * SECOND)

    assert rings(scenario) == [7.0]


def test_no_moment_is_no_alarm() -> None:
    async def scenario(alarm: WakeUpTimer) -> None:
        alarm.set(5 * SECOND)
        alarm.set(None)

    assert rings(scenario) == []


def test_it_can_be_cancelled_and_set_again() -> None:
    async def scenario(alarm: WakeUpTimer) -> None:
        alarm.set(5 * SECOND)
        alarm.cancel()
        alarm.cancel()
        await asyncio.sleep(10)
        alarm.set(12 * SECOND)

    assert rings(scenario) == [12.0]


def test_a_moment_that_has_passed_is_soon_and_not_within_the_call() -> None:
    async def scenario(alarm: WakeUpTimer) -> None:
        await asyncio.sleep(10)
        alarm.set(3 * SECOND)

    assert rings(scenario) == [10.0]
