"""A planner that connects by TCP, as AsapRealizer's planners do."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.fakes.ports import free_port
from tests.host.rig import ServedSession, served_session
from woz_tui.bridge.xml_elements import LONGEST, LONGEST_TAG, XmlElements, XmlElementsError
from woz_tui.client import WozConnectionError, connect
from woz_tui.features.blocks.tcp_planner import PlannerPortError, PlannerPorts, TcpPlanner
from woz_tui.testing import until

PATIENCE_S = 40.0
BLOCK = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">'
    '<head id="n" lexeme="NOD"/></bml>\n'
)


@dataclass
class AsapPlanner:
    """A planner with its port for feedback, which is read line by line."""

    request: int
    feedback: int
    reads: bool = True
    lines: list[str] = field(default_factory=list)
    writer: asyncio.StreamWriter | None = None
    reader: asyncio.StreamReader | None = None
    server: asyncio.Server | None = None

    async def connect(self) -> None:
        """The port for feedback is opened after the connection, as ASAP's planners do."""
        self.reader, self.writer = await asyncio.open_connection("127.0.0.1", self.request)
        self.server = await asyncio.start_server(self._read, "127.0.0.1", self.feedback)

    async def _read(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await until(lambda: self.reads, PATIENCE_S)
        async for line in reader:
            self.lines.append(line.decode())
        writer.close()

    def send(self, text: str) -> None:
        assert self.writer is not None
        self.writer.write(text.encode())

    async def leave(self) -> None:
        for each in (self.writer, self.server):
            if each is not None:
                each.close()

    def feedback_tells(self, name: str) -> bool:
        """Whether the feedback tells of this."""
        return any(f'"{name}"' in line for line in self.lines)


@dataclass
class PlannerListener:
    """A session, and what listens for planners."""

    host: ServedSession
    ports: PlannerPorts
    sentences: list[str]
    planners: list[AsapPlanner] = field(default_factory=list)

    async def planner(self) -> AsapPlanner:
        """One more that connects."""
        self.planners.append(AsapPlanner(self.ports.request, self.ports.feedback))
        await self.planners[-1].connect()
        return self.planners[-1]

    async def sentence_published(self, words: str) -> None:
        await until(lambda: any(words in each for each in self.sentences), PATIENCE_S)


def _ports() -> PlannerPorts:
    """Two that nobody listens on."""
    return PlannerPorts(free_port(), free_port())


@contextlib.asynccontextmanager
async def listening(tmp_path: Path) -> AsyncIterator[PlannerListener]:
    async with served_session(tmp_path) as host, connect(host.path, name="planner") as client:
        listener = PlannerListener(host, _ports(), [])
        running = asyncio.create_task(
            TcpPlanner(client, listener.ports, listener.sentences.append).run()
        )
        try:
            await listener.sentence_published("connect to")
            yield listener
        finally:
            for planner in listener.planners:
                await planner.leave()
            running.cancel()
            await asyncio.gather(running, return_exceptions=True)


async def test_blocks_come_are_played_and_told_at_the_planners_port(tmp_path: Path) -> None:
    async with listening(tmp_path) as listener:
        planner = await listener.planner()
        planner.send(BLOCK.format("b1") + "<bml" + BLOCK.format("b2")[4:50])
        await until(lambda: planner.feedback_tells("b1:end"), PATIENCE_S)
        planner.send(BLOCK.format("b2")[50:])
        await until(lambda: planner.feedback_tells("b2:end"), PATIENCE_S)
        assert [verb for verb, _ in listener.host.driver().calls] == ["play", "play"]
        names = [Xml.fromstring(line).tag.rpartition("}")[2] for line in planner.lines]
        assert {*names} == {"predictionFeedback", "blockProgress", "syncPointProgress"}


async def test_what_is_no_xml_is_told_and_the_next_planner_is_served(tmp_path: Path) -> None:
    async with listening(tmp_path) as listener:
        planner, next_one = (
            await listener.planner(),
            AsapPlanner(listener.ports.request, listener.ports.feedback),
        )
        planner.send("<bml" + 'id="x"/>')
        await until(lambda: planner.feedback_tells("PARSING_FAILURE"), PATIENCE_S)
        planner.send("GET / HTTP/1.1\n")
        await listener.sentence_published("has gone")
        await until(
            lambda: sum("PARSING_FAILURE" in line for line in planner.lines) == 2, PATIENCE_S
        )
        await planner.leave()
        listener.planners.append(next_one)
        await next_one.connect()
        next_one.send(BLOCK.format("b1"))
        await until(lambda: next_one.feedback_tells("b1:end"), PATIENCE_S)


async def test_a_planner_hears_nothing_of_the_blocks_of_the_one_before(tmp_path: Path) -> None:
    async with listening(tmp_path) as listener:
        planner, next_one = (
            await listener.planner(),
            AsapPlanner(listener.ports.request, listener.ports.feedback),
        )
        planner.send('<bml id="b1"><wait id="w" end="999"/></bml>')
        await until(lambda: planner.feedback_tells("b1:start"), PATIENCE_S)
        await planner.leave()
        await listener.sentence_published("has gone")
        listener.planners.append(next_one)
        await next_one.connect()
        next_one.send(BLOCK.format("b2").replace(' id="b2"', ' id="b2" composition="REPLACE"'))
        await until(lambda: next_one.feedback_tells("b2:end"), PATIENCE_S)
        assert not [line for line in next_one.lines if "b1" in line]


async def test_a_planner_without_a_port_for_feedback_is_played(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_tui.features.blocks.tcp_planner._FEEDBACK_S", 0.01)
    async with listening(tmp_path) as listener:
        _, writer = await asyncio.open_connection("127.0.0.1", listener.ports.request)
        writer.write(BLOCK.format("b1").encode())
        await listener.sentence_published("no feedback")
        await until(lambda: bool(listener.host.driver().calls), PATIENCE_S)
        writer.close()


async def test_a_planner_that_does_not_read_gets_no_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_tui.features.blocks.tcp_planner._MOST_UNREAD", 0)
    async with listening(tmp_path) as listener:
        planner = AsapPlanner(listener.ports.request, listener.ports.feedback, reads=False)
        listener.planners.append(planner)
        await planner.connect()
        text = f'<bml id="{"x" * 60_000}"><head id="n" lexeme="NOD"/></bml>'
        while not any("does not read" in each for each in listener.sentences):
            planner.send(text)
            await asyncio.sleep(0)
        planner.send(BLOCK.format("b1"))
        await until(lambda: len(listener.host.driver().calls) > 1, PATIENCE_S)
        planner.reads = True


async def test_it_ends_with_the_session(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, connect(host.path) as client:
        sentences: list[str] = []
        running = asyncio.create_task(TcpPlanner(client, _ports(), sentences.append).run())
        await until(lambda: bool(sentences), PATIENCE_S)
        await host.host.close()
        with pytest.raises(WozConnectionError):
            async with asyncio.timeout(PATIENCE_S):
                await running


async def test_a_port_that_is_taken_is_told(tmp_path: Path) -> None:
    async with listening(tmp_path) as listener, connect(listener.host.path) as client:
        with pytest.raises(PlannerPortError, match=f"{listener.ports.request}"):
            await TcpPlanner(client, listener.ports, print).run()


# -- where a document ends ---------------------------------------------------------------------

DOCUMENTS = [
    b"<bml/>",
    b"<a><b x='>'/></a>",
    b"<?xml version='1.0'?><a>text &lt; <!-- </a> --><b><![CDATA[</a>]]></b></a>",
    b"""<a x="'/>" y='"'><b></b>\xc3\xa4</a >""",
    b"<!-- before --><a/>",
    b"<a><?p </a>?></a>",
]


@given(
    documents=st.lists(st.sampled_from(DOCUMENTS), max_size=5),
    between=st.sampled_from([b"", b"\n", b" \r\n\t", b"\xef\xbb\xbf"]),
    size=st.integers(1, 60),
)
def test_documents_are_found_however_they_are_cut(
    documents: list[bytes], between: bytes, size: int
) -> None:
    data = between.join([b"", *documents, b""])
    elements, found = XmlElements(), list[bytes]()
    for begin in range(0, len(data), size):
        found += elements.feed(data[begin : begin + size])
    assert found == documents


@pytest.mark.parametrize(
    "data",
    [
        b"hello",
        b"<bml/> hello",
        b"</bml>",
        b"<!DOCTYPE x [<!ENTITY a 'b'>]>",
        b"<a " + b"x" * LONGEST_TAG,
        b"<a '" + b"<>" * LONGEST_TAG,
        b"<a>" + b"x" * LONGEST,
        b"<a>" * (LONGEST // 3 + 1),
        b" " * (LONGEST + 1) + b"x",
        b"<!--" + b"-" * LONGEST,
    ],
)
def test_what_cannot_become_a_document_is_refused(data: bytes) -> None:
    elements = XmlElements()
    with pytest.raises(XmlElementsError):
        for begin in range(0, len(data), 1 << 16):
            list(elements.feed(data[begin : begin + (1 << 16)]))


@pytest.mark.hypothesis
@given(pieces=st.lists(st.one_of(st.sampled_from(DOCUMENTS), st.binary(max_size=20)), max_size=9))
def test_whatever_comes_is_a_document_or_refused(pieces: list[bytes]) -> None:
    elements = XmlElements()
    with contextlib.suppress(XmlElementsError):
        for piece in pieces:
            for document in elements.feed(piece):
                assert document.endswith(b">")
