"""Tasks beside a driver's commands, and a stop whose parts confirm in time or not."""

from __future__ import annotations

import asyncio

import pytest

from tests.fakes.virtual_time import run_virtual, stand_still
from woz_tui.drivers.background import BackgroundTasks
from woz_tui.drivers.confirmed_stop import Ends, confirmed_within
from woz_tui.drivers.contract import DriverError, StopReport


async def fails(error: Exception) -> None:
    raise error


async def test_what_comes_next_waits_until_nothing_is_left() -> None:
    tasks, gate, done = BackgroundTasks("a sound"), asyncio.Event(), list[str]()

    async def work(name: str) -> None:
        await gate.wait()
        done.append(name)
        if name == "first":
            tasks.start(work("begun meanwhile"))

    tasks.start(work("first"))
    await tasks.settled(0.0)
    assert tasks and done == []
    gate.set()
    await tasks.settled()
    assert not tasks and done == ["first", "begun meanwhile"]


async def test_what_never_ends_is_given_up_at_the_end() -> None:
    tasks = BackgroundTasks("a sound")
    endless = tasks.start(asyncio.Event().wait())
    await tasks.close(0.0)
    assert endless.cancelled() and not tasks


async def test_a_mistake_is_logged_and_a_robots_refusal_is_not(
    caplog: pytest.LogCaptureFixture,
) -> None:
    tasks = BackgroundTasks("a sound")
    for error in (DriverError("refused"), TimeoutError(), KeyError("mistake")):
        tasks.start(fails(error))
    await tasks.settled()
    await asyncio.sleep(0)
    assert [record.getMessage() for record in caplog.records] == ["a sound failed"]


@pytest.mark.parametrize(("takes", "confirmed"), [(0.4, True), (0.8, False)])
def test_what_ended_while_the_process_stood_still_has_confirmed(
    takes: float, confirmed: bool
) -> None:
    async def stop() -> StopReport:
        stand_still(after=0.1, seconds=0.5)

        async def answers() -> None:
            await asyncio.sleep(takes)
            for _ in range(5):  # it is read, handed on, understood ...
                await asyncio.sleep(0)

        return await confirmed_within(0.45, {"driving": [asyncio.ensure_future(answers())]})

    assert (run_virtual(stop()).missing == ()) is confirmed


async def test_a_part_has_confirmed_when_all_that_belongs_to_it_has_ended_well() -> None:
    tasks, gate = BackgroundTasks("a stop"), asyncio.Event()
    well, late = tasks.start(asyncio.sleep(0)), tasks.start(gate.wait())
    refused = tasks.start(fails(DriverError("refused")))
    ends: Ends = {"speech": [well], "motion": [well, refused], "driving": [well, late]}
    assert await confirmed_within(0.05, ends) == StopReport(("speech",), ("driving", "motion"))
    gate.set()  # what is late goes on
    assert await late
