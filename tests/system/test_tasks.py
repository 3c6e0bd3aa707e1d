"""Tasks that run beside others: the first end ends all, and no error is lost."""

from __future__ import annotations

import asyncio
import logging

import pytest

from woz_tui.system.tasks import TaskSet, end_tasks, until_first_ends


async def for_ever(ended: list[str]) -> None:
    try:
        await asyncio.Event().wait()
    finally:
        ended.append("cancelled")


async def at_once(result: int) -> int:
    return result


async def fails() -> None:
    raise ValueError("no light")


async def test_the_first_end_ends_all_and_is_the_result() -> None:
    ended: list[str] = []
    assert await until_first_ends(for_ever(ended), at_once(3)) == 3
    assert ended == ["cancelled"]


@pytest.mark.parametrize("count", range(4))
async def test_of_several_that_end_at_once_an_error_counts(count: int) -> None:
    with pytest.raises(ValueError, match="no light"):
        await until_first_ends(*(at_once(n) for n in range(count)), fails(), at_once(9))


async def test_whoever_is_cancelled_ends_all() -> None:
    ended: list[str] = []
    running = asyncio.create_task(until_first_ends(for_ever(ended), for_ever(ended)))
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    running.cancel()
    with pytest.raises(asyncio.CancelledError):
        await running
    assert ended == ["cancelled", "cancelled"]


async def test_what_a_task_had_failed_with_is_in_the_log(caplog: pytest.LogCaptureFixture) -> None:
    task, ended = asyncio.create_task(fails(), name="the light"), list[str]()
    await asyncio.wait([task])
    await end_tasks(task, None, asyncio.create_task(for_ever(ended)))
    assert [record.message for record in caplog.records] == ["the light had failed"]


async def test_what_nobody_waits_for_is_in_the_log_too(caplog: pytest.LogCaptureFixture) -> None:
    tasks = TaskSet("the light")
    with caplog.at_level(logging.ERROR):
        tasks.start(fails())
        await tasks.settled()
    assert not tasks
    assert [record.message for record in caplog.records] == ["the light failed"]
