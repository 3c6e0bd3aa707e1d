"""How a Pepper's settings are asked for: one by one, and once for a burst of keys."""

from __future__ import annotations

import asyncio
import itertools
from collections.abc import Mapping
from pathlib import Path
from typing import cast

from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.pepper.connection import SPACING_S, Connection
from woz_drivers.pepper.driver_reading import EVERY_S, LULL_S, Reading
from woz_drivers.pepper.parts import Part
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.heard import Heard, Ordered
from tests.fakes.virtual_time import LoopClock, run_virtual
from woz_tui.core.driver import Lost
from woz_tui.core.messages import Json

NOWHERE = PepperSettings(robots=(), connect=False)


async def _went() -> None:
    """Nobody looks for a robot here."""


def _connection(heard: Heard) -> Connection:
    return Connection(NOWHERE, heard.outlet, on_connected=_went, on_lost=lambda: None)


@given(pauses=st.lists(st.sampled_from([0.0, 0.001, 0.01, 0.1]), min_size=1, max_size=30))
def test_questions_keep_their_distance_and_wait_for_nothing_else(pauses: list[float]) -> None:
    async def scene() -> None:
        loop = asyncio.get_running_loop()
        connection = _connection(Heard(Path("unused"), LoopClock(loop)))
        asked: list[float] = []
        put: list[float] = []

        async def ask() -> None:
            try:
                await connection.ask("ALTextToSpeech", "getVolume")
            except Lost:
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


class Clerk:
    """A part that notes when its settings were asked for."""

    name = "clerk"

    def __init__(self) -> None:
        self.asked: list[float] = []

    async def read(self) -> Mapping[str, Json]:
        self.asked.append(asyncio.get_running_loop().time())
        return {}


def test_a_burst_of_keys_is_read_back_once_it_is_over_and_meanwhile_now_and_then() -> None:
    async def scene() -> tuple[float, float, list[float]]:
        loop = asyncio.get_running_loop()
        heard = Heard(Path("unused"), LoopClock(loop))
        clerk = Clerk()
        reading = Reading(_connection(heard), [cast(Part, clerk)], NOWHERE, heard.outlet)
        reading.begin()
        await asyncio.sleep(EVERY_S / 2)
        begun = loop.time()
        for _ in range(40):
            reading.noticed(Ordered("nudge", {"pan": 5}))
            await asyncio.sleep(0.02)
        over = loop.time() - 0.02
        await asyncio.sleep(EVERY_S)
        await reading.close()
        return begun, over, clerk.asked

    begun, over, asked = run_virtual(scene())
    during = [at for at in asked if begun <= at <= over]
    assert 1 <= len(during) <= (over - begun) / LULL_S + 1
    assert any(over <= at <= over + LULL_S + 0.001 for at in asked)
    assert all(later - at <= EVERY_S + 0.001 for at, later in itertools.pairwise(asked))
