"""Our STOMP client, and a planner's blocks, over ActiveMQ."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from tests.bml.test_stomp import BLOCK, PATIENCE_S, TOPICS
from tests.host.rig import served
from tests.peers.places import place
from woz_tui.bml.stomp_connection import StompConnection, StompError, StompPlace, connect_stomp
from woz_tui.bml.stomp_planner import StompPlanner
from woz_tui.client import connect

pytestmark = pytest.mark.peers


@pytest.fixture
async def broker(tmp_path: Path) -> AsyncIterator[StompPlace]:
    """ActiveMQ at a port of its own."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    process = await asyncio.create_subprocess_exec(
        place("activemq") / "run", str(port), str(tmp_path), stdout=-3, stderr=-3
    )
    try:
        there = StompPlace("127.0.0.1", port)
        await (await _connected(there)).close()
        yield there
    finally:
        process.kill()
        await process.wait()


async def _connected(there: StompPlace) -> StompConnection:
    """As soon as it takes connections."""
    async with asyncio.timeout(PATIENCE_S):
        while True:
            try:
                return await connect_stomp(there)
            except StompError:
                await asyncio.sleep(0.2)


async def test_texts_come_unharmed_and_as_texts(broker: StompPlace) -> None:
    one, other = await _connected(broker), await _connected(broker)
    one.subscribe("/topic/x")
    text = "<bml>h\u00e9llo : \\ \n end</bml>"
    messages = one.messages()
    received = asyncio.ensure_future(anext(messages))
    async with asyncio.timeout(PATIENCE_S):
        while not received.done():  # the subscription may come after the first
            other.send("/topic/x", text)
            await asyncio.wait([received], timeout=0.2)
    assert received.result() == ("/topic/x", text)
    await one.close()
    await other.close()


async def test_a_planner_plays_the_robot(broker: StompPlace, tmp_path: Path) -> None:
    planner = await _connected(broker)
    planner.subscribe(TOPICS.feedback)
    async with served(tmp_path) as host, connect(host.path) as client:
        running = asyncio.create_task(StompPlanner(client, broker, TOPICS, print).run())
        feedback, told = planner.messages(), ""
        async with asyncio.timeout(PATIENCE_S):
            heard = asyncio.ensure_future(anext(feedback))
            while not heard.done():
                planner.send(TOPICS.request, BLOCK.format("b1"))
                await asyncio.wait([heard], timeout=0.5)
            told = heard.result()[1]
            while "b1:end" not in told:
                told = (await anext(feedback))[1]
        assert {verb for verb, _ in host.puppet().calls} == {"play"}
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)
    await planner.close()
