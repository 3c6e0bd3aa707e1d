"""A planner behind a message broker."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator
from dataclasses import dataclass, replace
from pathlib import Path
from urllib.parse import quote_plus

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.fakes.stomp_broker import StompBroker
from tests.host.rig import ServedSession, served_session
from woz_tui.bridge.stomp_connection import (
    StompError,
    StompFrame,
    StompPlace,
    StompRefusedError,
    connect_stomp,
    read_frame,
)
from woz_tui.client import connect
from woz_tui.features.blocks.bml_block import EYEPI
from woz_tui.features.blocks.stomp_planner import PlannerTopics, StompPlanner
from woz_tui.testing import until

PATIENCE_S = 40.0
TOPICS = PlannerTopics()
BLOCK = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">'
    '<head id="n" lexeme="NOD"/></bml>'
)


@dataclass
class Bridge:
    """A broker with a planner's topics, a session, and what plays between them."""

    broker: StompBroker
    host: ServedSession
    sentences: list[str]

    async def block_ended(self, block: str) -> None:
        """Until the planner was told that a block has ended."""
        await until(lambda: any(f"{block}:end" in text for text in self.feedback()), PATIENCE_S)

    def feedback(self) -> list[str]:
        """What the planner was told."""
        return self.broker.sent(TOPICS.feedback)


@contextlib.asynccontextmanager
async def bridged(tmp_path: Path) -> AsyncIterator[Bridge]:
    async with (
        StompBroker() as broker,
        served_session(tmp_path) as host,
        connect(host.path, name="planner") as client,
    ):
        sentences: list[str] = []
        place = StompPlace("127.0.0.1", broker.port)
        planner = StompPlanner(client, place, TOPICS, sentences.append)
        running = asyncio.create_task(planner.run())
        try:
            await until(lambda: broker.subscribed, PATIENCE_S)
            yield Bridge(broker, host, sentences)
        finally:
            running.cancel()
            await asyncio.gather(running, return_exceptions=True)


async def test_a_block_comes_is_played_and_the_planner_is_told(tmp_path: Path) -> None:
    async with bridged(tmp_path) as bridge:
        bridge.broker.publish(TOPICS.request, BLOCK.format("b1"))
        await bridge.block_ended("b1")
        assert [verb for verb, _ in bridge.host.driver().calls] == ["play"]
        assert any("b1:n:stroke" in text for text in bridge.feedback())
        sends = [frame for frame in bridge.broker.frames if frame.startswith(b"SEND")]
        assert not any(b"content-length" in frame for frame in sends)


async def test_a_planner_that_wraps_its_blocks_is_answered_likewise(tmp_path: Path) -> None:
    async with bridged(tmp_path) as bridge:
        wrapped = json.dumps({"bml": {"content": quote_plus(BLOCK.format("b1"))}})
        bridge.broker.publish(TOPICS.request, wrapped)
        await until(lambda: bool(bridge.feedback()), PATIENCE_S)
        assert "content" in json.loads(bridge.feedback()[0])["feedback"]


async def test_nonsense_is_refused_and_the_next_block_is_played(tmp_path: Path) -> None:
    async with bridged(tmp_path) as bridge:
        nested = f'<directRosMessage xmlns="{EYEPI}" id="d" topic="t">{"<a>" * 3000}'
        nested = f'<bml id="b0">{nested}{"</a>" * 3000}</directRosMessage></bml>'
        wrapped = ("{}", '{"bml": 3}', '{"a":' * 5000, '{"bml": {"content": "\\ud800"}}')
        for nonsense in ("", "<bml", "\x01", nested, *wrapped):
            bridge.broker.publish(TOPICS.request, nonsense)
        bridge.broker.publish(TOPICS.request, BLOCK.format("b1"))
        await bridge.block_ended("b1")
        assert sum("warningFeedback" in text for text in bridge.feedback()) == 8


async def test_a_broker_that_comes_back_is_used_again(tmp_path: Path) -> None:
    async with bridged(tmp_path) as bridge:
        await bridge.broker.stop()
        await until(lambda: any("tried again" in each for each in bridge.sentences), PATIENCE_S)
        await bridge.broker.start()
        await until(lambda: bridge.broker.subscribed, PATIENCE_S)
        bridge.broker.publish(TOPICS.request, BLOCK.format("b1"))
        await bridge.block_ended("b1")


async def test_who_is_not_let_in_is_told_and_does_not_try_again(tmp_path: Path) -> None:
    async with (
        StompBroker() as broker,
        served_session(tmp_path) as host,
        connect(host.path) as client,
    ):
        broker.passcode = "secret"
        place = StompPlace("127.0.0.1", broker.port, "me", "wrong")
        with pytest.raises(StompRefusedError, match=r"Bad CONNECT.*Access refused") as caught:
            await StompPlanner(client, place, TOPICS, print).run()
        assert "wrong" not in str(caught.value)
        connection = await connect_stomp(replace(place, passcode="secret"))
        await connection.close()


async def test_what_is_no_broker_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    async with StompBroker() as broker:
        place = StompPlace("127.0.0.1", broker.port)
    with pytest.raises(StompError, match="cannot be reached"):
        await connect_stomp(place)
    monkeypatch.setattr("woz_tui.bridge.stomp_connection._CONNECT_S", 0.1)
    async with StompBroker() as broker:
        broker.silent = True
        with pytest.raises(StompError, match="does not answer"):
            await connect_stomp(StompPlace("127.0.0.1", broker.port))


async def test_a_broker_that_reads_no_more_is_left() -> None:
    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.readuntil(b"\0")
        writer.write(StompFrame("CONNECTED", {"version": "1.2", "heart-beat": "0,0"}).encode())
        writer.transport.pause_reading()  # type: ignore[attr-defined]

    server = await asyncio.start_server(serve, "127.0.0.1", 0)
    try:
        port = server.sockets[0].getsockname()[1]
        connection = await connect_stomp(StompPlace("127.0.0.1", port))
        reading = asyncio.ensure_future(anext(connection.messages()))
        for _ in range(400):  # 25 MB: more than the kernel takes
            connection.send("/topic/a", 65536 * "x")
            await asyncio.sleep(0)
        await asyncio.wait([reading], timeout=PATIENCE_S)
        assert reading.done()
        with pytest.raises(StompError):
            await reading
    finally:
        server.close()
        await connection.close()


async def _of(data: bytes) -> StompFrame | None:
    reader = asyncio.StreamReader(limit=1 << 16)
    reader.feed_data(data)
    reader.feed_eof()
    return await read_frame(reader)


@given(
    headers=st.dictionaries(st.text(min_size=1), st.text(), max_size=4),
    body=st.binary().map(lambda data: data.replace(b"\0", b"")),
)
def test_a_frame_is_read_as_it_was_written(headers: dict[str, str], body: bytes) -> None:
    headers.pop("content-length", None)
    frame = StompFrame("MESSAGE", {"id": "1", **headers}, body)
    with contextlib.suppress(UnicodeEncodeError):  # half of a pair of surrogates
        assert asyncio.run(_of(frame.encode())) == frame


@pytest.mark.hypothesis
@given(data=st.binary(max_size=200))
def test_whatever_a_broker_sends_is_a_frame_or_refused(data: bytes) -> None:
    with contextlib.suppress(StompError, asyncio.IncompleteReadError):
        asyncio.run(_of(b"MESSAGE\n" + data))
