"""How a Pepper's settings are asked for: one by one, and once for a burst of keys."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path
from typing import cast

from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.naoqi_robot.connection import SPACING_S, RobotConnection
from woz_drivers.naoqi_robot.parts import NaoqiPart
from woz_drivers.naoqi_robot.settings_reading import EVERY_S, LULL_S, RECENT_S, SettingsReader
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.published_messages import BusJob, PublishedMessages
from tests.fakes.virtual_time import LoopClock, run_virtual
from woz_tui.drivers.contract import DeviceLostError, RejectedError
from woz_tui.protocol.messages import Json, Notice, SettingsShown

NOWHERE = PepperSettings(robots=(), connect=False)


async def _went() -> None:
    """Nobody looks for a robot here."""


def _connection(published: PublishedMessages) -> RobotConnection:
    return RobotConnection(NOWHERE, published.context, on_connected=_went, on_lost=lambda: None)


@given(pauses=st.lists(st.sampled_from([0.0, 0.001, 0.01, 0.1]), min_size=1, max_size=30))
def test_questions_keep_their_distance_and_wait_for_nothing_else(pauses: list[float]) -> None:
    async def scene() -> None:
        loop = asyncio.get_running_loop()
        connection = _connection(PublishedMessages(Path("unused"), LoopClock(loop)))
        asked: list[float] = []
        put: list[float] = []

        async def ask() -> None:
            try:
                await connection.ask("ALTextToSpeech", "getVolume")
            except DeviceLostError:
                put.append(loop.time())

        async with asyncio.TaskGroup() as going:
            for pause in pauses:
                await asyncio.sleep(pause)
                asked.append(loop.time())
                going.create_task(ask())
        earliest = 0.0
        for wanted, sent in zip(asked, put, strict=True):
            assert abs(sent - max(wanted, earliest)) < SPACING_S / 10
            earliest = sent + SPACING_S

    run_virtual(scene())


class CountingPart:
    """A part that notes when its settings were asked for; these are `values`."""

    name = "clerk"

    def __init__(self, **values: Json) -> None:
        self.asked: list[float] = []
        self.values = values

    async def read(self) -> Mapping[str, Json]:
        self.asked.append(asyncio.get_running_loop().time())
        return self.values

    def conflicts(self) -> tuple[str, ...]:
        return ()


def test_a_burst_of_keys_is_read_back_once_it_is_over_and_meanwhile_now_and_then() -> None:
    async def scene() -> tuple[float, float, list[float]]:
        loop = asyncio.get_running_loop()
        published = PublishedMessages(Path("unused"), LoopClock(loop))
        part = CountingPart()
        reading = SettingsReader(
            _connection(published), [cast(NaoqiPart, part)], NOWHERE, published.context
        )
        reading.begin()
        await asyncio.sleep(EVERY_S / 2)
        begun = loop.time()
        for _ in range(40):
            reading.noticed(BusJob("nudge", {"pan": 5}))
            await asyncio.sleep(0.02)
        over = loop.time() - 0.02
        await asyncio.sleep(EVERY_S)
        await reading.close()
        return begun, over, part.asked

    begun, over, asked = run_virtual(scene())
    during = [at for at in asked if begun <= at <= over]
    assert 1 <= len(during) <= (over - begun) / LULL_S + 1
    assert any(over <= at <= over + LULL_S + 0.001 for at in asked)
    assert all(later - at <= EVERY_S + 0.001 for at, later in itertools.pairwise(asked))


def test_a_new_conflict_is_an_event_and_one_that_goes_on_is_none() -> None:
    async def scene() -> list[str]:
        published = PublishedMessages(Path("unused"), LoopClock(asyncio.get_running_loop()))
        part = CountingPart(state="disabled")
        reading = SettingsReader(
            _connection(published), [cast(NaoqiPart, part)], NOWHERE, published.context
        )
        reading.begin()
        await asyncio.sleep(3 * EVERY_S)
        for state in ("solitary", "disabled", "solitary"):
            part.values["state"] = state
            await asyncio.sleep(3 * EVERY_S)
        reading.end()
        reading.begin()
        await asyncio.sleep(3 * EVERY_S)
        del part.values["state"]  # one question without an answer
        await asyncio.sleep(2 * EVERY_S)
        part.values["state"] = "solitary"
        await asyncio.sleep(3 * EVERY_S)
        await reading.close()
        return [one.text for one in published.all(Notice)]

    told = run_virtual(scene())
    assert len(told) == 2
    assert all(
        "autonomous life is solitary: the robot moves and talks by itself" in t for t in told
    )


# -- conflicts with what the wizard does, and how long they count ----------------------------------

Scene = Callable[[SettingsReader], Awaitable[None]]


def conflicts_told(scene: Scene, **values: Json) -> list[tuple[float, int]]:
    """Seconds and number of the conflicts, whenever the wizard was told of other ones."""

    async def played() -> list[tuple[float, int]]:
        published = PublishedMessages(Path("unused"), LoopClock(asyncio.get_running_loop()))
        clerk = cast(NaoqiPart, CountingPart(**values))
        reading = SettingsReader(_connection(published), [clerk], NOWHERE, published.context)
        reading.begin()
        await asyncio.sleep(5.0)
        await scene(reading)
        await reading.close()
        return [(one.t / 1e6, len(one.conflicts)) for one in published.all(SettingsShown)]

    return run_virtual(played())


async def use(reading: SettingsReader, verb: str, seconds: float = 0.0) -> None:
    """A verb as the driver performs it."""
    with reading.using(verb):
        await asyncio.sleep(seconds)
    reading.noticed(BusJob(verb))


def test_a_conflict_with_a_verb_ages_out_once_and_comes_back_with_it() -> None:
    async def scene(reading: SettingsReader) -> None:
        await use(reading, "nudge")
        await asyncio.sleep(RECENT_S + 35.0)  # it is 100 s
        await use(reading, "gaze")
        await asyncio.sleep(1.0)

    told = conflicts_told(scene, awareness=True)
    assert [count for _, count in told] == [0, 1, 0, 1]
    begun, aged, again = (at for at, _ in told[1:])
    assert 5.0 <= begun <= 5.0 + LULL_S + 0.01
    assert 5.0 + RECENT_S <= aged <= 5.0 + RECENT_S + EVERY_S + 0.01
    assert 100.0 <= again <= 100.0 + LULL_S + 0.01


def test_what_the_wizard_does_again_and_again_leaves_the_status_line_alone() -> None:
    async def scene(reading: SettingsReader) -> None:
        for _ in range(30):
            await use(reading, "say", seconds=4.0)
            await asyncio.sleep(RECENT_S - 2 * EVERY_S)

    told = conflicts_told(scene, speaking_movement=True)
    assert [count for _, count in told] == [0, 1]


def test_what_takes_longer_than_a_minute_counts_from_its_beginning_to_a_minute_after() -> None:
    async def scene(reading: SettingsReader) -> None:
        await use(reading, "play", seconds=200.0)
        await asyncio.sleep(RECENT_S + 2.0)

    told = conflicts_told(scene, arms_breathing=True)
    assert [count for _, count in told] == [0, 1, 0]
    assert told[1][0] <= 5.0 + EVERY_S + 0.01
    assert told[2][0] >= 205.0 + RECENT_S


def test_dangers_never_age() -> None:
    async def scene(reading: SettingsReader) -> None:
        await asyncio.sleep(20 * RECENT_S)

    told = conflicts_told(scene, tangential=0.02, state="solitary", awareness=True)
    assert [count for _, count in told] == [2]


def test_what_was_refused_was_not_done() -> None:
    async def scene(reading: SettingsReader) -> None:
        for error in (RejectedError("nonsense"), DeviceLostError("gone")):
            with contextlib.suppress(RejectedError, DeviceLostError), reading.using("eyes"):
                raise error
        reading.soon()
        await asyncio.sleep(2.0)

    assert [count for _, count in conflicts_told(scene, blinking=True)] == [0]
