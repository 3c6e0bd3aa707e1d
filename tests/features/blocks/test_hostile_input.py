"""Whatever a planner or a broker sends: a block, a frame, or a refusal in words."""

from __future__ import annotations

import asyncio
import contextlib
import math
from pathlib import Path
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.fakes.stomp_broker import StompBroker
from tests.features.blocks.hostile_input import HostileBlock, hostile_frames
from tests.host.rig import served_session
from tests.session.rig import ScriptedDriver
from woz_tui.bridge.stomp_connection import (
    LONGEST_HEADERS,
    StompError,
    StompPlace,
    connect_stomp,
    read_frame,
)
from woz_tui.bridge.xml_elements import XmlElements, XmlElementsError
from woz_tui.client import connect
from woz_tui.features.blocks.behaviour_calls import BehaviourCalls
from woz_tui.features.blocks.block_plan import plan
from woz_tui.features.blocks.bml_block import MOST_SHOWN, BmlError, read_block
from woz_tui.features.blocks.realizer import BmlRealizer, Feedback
from woz_tui.testing import until

PATIENCE_S = 40.0
SEEDS = st.integers(0, 1 << 32)
CALLS = BehaviourCalls([("robot", verb) for verb in ScriptedDriver.offer(None).verbs])


@given(seed=SEEDS)
def test_a_block_is_planned_or_refused_in_words(seed: int) -> None:
    try:
        text = HostileBlock(Random(seed)).data().decode("utf-8", "replace")
        block_plan = plan(read_block(text), CALLS)
    except BmlError as error:
        assert 0 < len(str(error)) <= MOST_SHOWN
        return
    assert all(math.isfinite(time) and time >= 0 for time in block_plan.schedule.times.values())
    assert all(len(warning.text) <= MOST_SHOWN for warning in block_plan.schedule.warnings)


@given(seed=SEEDS, size=st.integers(100, 5000))
def test_what_comes_by_tcp_is_cut_into_documents_or_refused(seed: int, size: int) -> None:
    data = HostileBlock(Random(seed)).data() * 2
    elements = XmlElements()
    with contextlib.suppress(XmlElementsError):
        for begin in range(0, len(data), size):
            for document in elements.feed(data[begin : begin + size]):
                assert document.startswith(b"<")


@given(seed=SEEDS)
def test_frames_are_read_or_refused(seed: int) -> None:
    async def read() -> None:
        reader = asyncio.StreamReader(limit=1 << 16)
        reader.feed_data(hostile_frames(Random(seed)))
        reader.feed_eof()
        while True:
            await read_frame(reader)

    with contextlib.suppress(StompError, asyncio.IncompleteReadError):
        asyncio.run(read())


@pytest.mark.parametrize(
    "headers", [b"a:" + b"x" * LONGEST_HEADERS, b"a:b\n" * 101, b"no colon", b"a:\\q"]
)
async def test_headers_that_are_none_end_the_connection(headers: bytes) -> None:
    reader = asyncio.StreamReader(limit=1 << 20)
    reader.feed_data(b"MESSAGE\n" + headers + b"\n\nbody\0")
    with pytest.raises(StompError):
        await read_frame(reader)


@pytest.mark.parametrize("beat", ["9" * 5000 + ",1", "\u00b2,\u00b2", "1e9,-1", "", "5"])
async def test_a_broker_with_an_odd_heart_beat_is_used_without_one(beat: str) -> None:
    async with StompBroker() as broker:
        broker.heart_beat = beat
        connection = await connect_stomp(StompPlace("127.0.0.1", broker.port))
        await connection.close()


async def test_a_session_plays_the_next_block_and_stops_after_hostile_ones(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, connect(host.path, name="planner") as client:
        told: list[Feedback] = []
        realizer = BmlRealizer(client, told.append)
        for seed in range(60):
            await realizer.perform(HostileBlock(Random(seed)).data().decode("utf-8", "replace"))
        last = '<bml id="last" composition="REPLACE"><head id="n" lexeme="NOD"/></bml>'
        await realizer.perform(last)
        await until(
            lambda: any(each.attributes.get("id") == "last:end" for each in told), PATIENCE_S
        )
        assert (await client.stop()).confirmed == ["robot"]
        await realizer.close()
