"""Clients that ask too much, read too little, or stop in the middle: nobody else notices."""

from __future__ import annotations

import asyncio
import re
import threading
from collections.abc import Callable
from pathlib import Path
from typing import get_args

import pytest

from tests.host.rig import Peer, ServedSession, served_session
from tests.session.rig import WAIT_S, experiment
from tools import ROOT
from woz_tui.config.experiment import Experiment
from woz_tui.feature import pieces
from woz_tui.host import client_connection, request_handlers
from woz_tui.protocol import messages as m

FLOOD = b'{"kind":"action","ref":1,"action":"Hello"}\n' * 3000


def deaf(peer: Peer) -> Peer:
    """It never reads again."""
    peer.writer.transport.pause_reading()  # type: ignore[attr-defined]
    return peer


async def lost(host: ServedSession, why: str) -> None:
    gone = await host.published(lambda line: isinstance(line, m.ConsoleLost))
    assert isinstance(gone, m.ConsoleLost)
    assert gone.why == why


async def turns(what: Callable[[], object], times: int) -> None:
    for _ in range(times):
        what()
        await asyncio.sleep(0)


async def test_who_reads_no_acks_is_let_go_of(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = deaf(await host.connect())
        await peer.say(kind="hello", role="program")
        await host.published(lambda line: isinstance(line, m.ConsoleAttached))
        await turns(lambda: host.session.mark("x" * 200, "program"), 20_000)
        await lost(host, "the client reads too slowly")
        peer.leave()


async def test_who_asks_and_never_reads_is_let_go_of(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        deaf(peer)
        misspelt = b'{"kind":"%b"}\n' % (b"x" * 900)

        async def ask() -> None:
            while True:
                peer.writer.write(misspelt * 100)
                await peer.writer.drain()

        asking = asyncio.ensure_future(ask())
        await lost(host, "the client reads too slowly")
        asking.cancel()
        await asyncio.wait([asking])


async def test_a_closed_connection_to_somebody_frozen_does_not_linger(tmp_path: Path) -> None:
    """Otherwise a console that hangs would keep the session from being abandoned."""
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        deaf(peer)
        for client_connection in host.host._clients:
            for _ in range(1000):
                client_connection.send(m.Note(text="x" * 1000))
            client_connection.close("silent")
        await lost(host, "silent")


async def test_a_flood_of_one_disturbs_no_other(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        wizard, program = await host.connect(), await host.connect()
        await wizard.hello("wizard")
        await program.hello(stream="nothing")
        program.writer.write(FLOOD)
        assert (await wizard.ask("marker", text="still here"))["ok"]
        marker = await host.published(lambda line: isinstance(line, m.Marker))
        asked = host.of(m.ActionRequested)
        assert len([line for line in asked if line.seq < marker.seq]) < 3000
        for _ in range(3000):
            await program.kind("reply")
        assert host.host.wizards


@pytest.mark.parametrize("end", [b"", b'{"kind":"marker","te'])
async def test_what_was_asked_before_leaving_is_done(tmp_path: Path, end: bytes) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        peer.writer.write(b'{"kind":"marker","text":"a"}\n' * 200 + b'{"kind":"stop"}\n' + end)
        peer.writer.write_eof()
        await host.published(lambda line: isinstance(line, m.StopPressed))
        await lost(host, "closed")


async def test_the_last_line_of_the_log_reaches_everybody(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello()
        await peer.say(kind="end", reason="enough")
        reason = await host.host.serve()
        await host.session.close(reason, rest=False)
        await host.host.close()
        assert (await peer.kind("session.end"))["reason"] == "enough"


async def test_no_request_is_too_deep_to_be_answered(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        for depth in range(880, 1000, 4):
            text = b"[" * depth + b"]" * depth
            peer.writer.write(
                b'{"kind":"verb","ref":%d,"verb":"say","args":{"text":%b}}\n' % (depth, text)
            )
            reply = await peer.kind("reply")
            assert reply["ref"] in {depth, 0}


# -- the stop is looked for first ----------------------------------------------------------------


async def test_a_stop_overtakes_what_its_connection_asked_before(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        markers = b'{"kind":"marker","text":"no \\"stop\\""}\n' * 1000
        peer.writer.write(markers + b'{"kind":"stop","ref":7}\n' + markers)
        stop = await host.published(lambda line: isinstance(line, m.StopPressed))
        replies = [(await peer.kind("reply")).get("ref", 0) for _ in range(2001)]
        assert replies.index(7) == 1000  # answers come in the order of the requests
        markers_before = host.of(m.Marker)
        assert len(markers_before) == 2000
        assert not [line for line in markers_before if line.seq < stop.seq]


async def test_a_stop_that_came_in_pieces_overtakes_too(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        peer.writer.write(b'{"kind":"marker"}\n' * 1000 + b'{"kind":"st')
        await turns(lambda: None, 5)
        peer.writer.write(b'op"}\n')
        stop = await host.published(lambda line: isinstance(line, m.StopPressed))
        assert len([line for line in host.lines[: stop.seq] if isinstance(line, m.Marker)]) < 1000


@pytest.mark.parametrize(
    ("asked", "pressed"),
    [
        (["stop", "release"], False),
        (["release", "stop"], True),
        (["stop", "release", "stop"], True),
        (["release", "marker", "stop", "marker"], True),
        (["release", "stop", "release"], False),
    ],
)
async def test_no_release_that_was_sent_before_a_stop_releases_it(
    tmp_path: Path, asked: list[str], pressed: bool
) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        lines = {kind: b'{"kind":"%b"}\n' % kind.encode() for kind in asked}
        lines["release"] = b'{"kind":"release","missing":["robot"]}\n'  # it need not be confirmed
        peer.writer.write(b"".join(lines[kind] for kind in asked))
        for _ in asked:
            await peer.kind("reply")
        assert host.session.bus.latched is pressed


# -- requests are rated --------------------------------------------------------------------------


async def test_one_turn_has_few_requests_however_many_ask(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peers = [await host.connect() for _ in range(10)]
        for peer in peers:
            await peer.hello(stream="nothing")
        for peer in peers:
            peer.writer.write(b'{"kind":"marker"}\n' * 100)
        marked = 0
        while marked < 1000:
            await asyncio.sleep(0)
            now = len(host.of(m.Marker))
            assert now - marked <= client_connection.REQUESTS_A_TURN
            marked = now


async def test_who_asks_one_thing_waits_for_no_flood(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        floods, one = [await host.connect() for _ in range(5)], await host.connect()
        for peer in [*floods, one]:
            await peer.hello(stream="nothing")
        for peer in floods:
            peer.writer.write(b'{"kind":"marker","text":"flood"}\n' * 2000)
        one.writer.write(b'{"kind":"marker","text":"one"}\n')
        await host.published(lambda line: isinstance(line, m.Marker) and line.text == "one")
        assert len(host.of(m.Marker)) < 10_000


class CountedFile:
    """An experiment file that counts how often it is read, each time until it is told."""

    def __init__(self, tmp_path: Path) -> None:
        self._made = experiment(tmp_path)
        self._read = threading.Semaphore(0)
        self.reading = threading.Event()
        self.times = 0

    def load(self) -> Experiment:
        self.times += 1
        self.reading.set()
        assert self._read.acquire(timeout=WAIT_S)
        return self._made

    def finish(self, times: int = 1) -> None:
        self._read.release(times)


async def test_reloads_of_one_client_that_wait_are_one_reading(tmp_path: Path) -> None:
    file = CountedFile(tmp_path)
    async with served_session(tmp_path, load=file.load) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        peer.writer.write(b'{"kind":"reload","ref":1}\n')
        await asyncio.to_thread(file.reading.wait, WAIT_S)
        peer.writer.write(b"".join(b'{"kind":"reload","ref":%d}\n' % ref for ref in range(2, 1000)))
        replies = [await peer.kind("reply") for _ in range(998 - request_handlers.SLOW_WAITING)]
        assert not any(reply["ok"] for reply in replies)
        file.finish(2)
        replies = [await peer.kind("reply") for _ in range(request_handlers.SLOW_WAITING + 1)]
        assert [reply["ref"] for reply in replies if reply["ok"]] == [*range(1, 18)]
        assert file.times == 2


async def test_what_waits_for_a_client_that_left_is_not_worked_on(tmp_path: Path) -> None:
    file = CountedFile(tmp_path)
    async with served_session(tmp_path, load=file.load) as host:
        peer, other = await host.connect(), await host.connect()
        await peer.hello(stream="nothing")
        await other.hello(stream="nothing")
        peer.writer.write(b'{"kind":"reload"}\n{"kind":"reload","dry_run":true}\n' * 20)
        await asyncio.to_thread(file.reading.wait, WAIT_S)
        peer.leave()
        await lost(host, "closed")
        file.finish(3)
        assert (await other.ask("reload"))["ok"]
        assert file.times == 2


async def test_of_a_client_that_left_only_what_the_log_is_for_is_done(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        one = b'{"kind":"action","action":"Hello"}\n{"kind":"marker"}\n'
        peer.writer.write(one * 1000 + b'{"kind":"note","text":"the last"}\n')
        peer.leave()
        await host.published(lambda line: isinstance(line, m.Note))
        assert len(host.of(m.Marker)) == 1000
        assert len(host.of(m.ActionRequested)) < 1000


async def test_a_stop_counts_whose_sender_left_before_it_was_read(tmp_path: Path) -> None:
    """It is noticed by writing to it; what it sent is still to be read then."""
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        made = host.host._clients[0]
        assert made._transport is not None
        made._transport.pause_reading()
        await peer.say(kind="stop")
        peer.leave()
        await peer.writer.wait_closed()
        made.send(m.Note(text="are you there?"))
        await host.published(lambda line: isinstance(line, m.StopPressed))


async def test_who_is_closed_and_then_reads_leaves_no_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(client_connection, "LINGER_S", 60.0)
    loop, errors = asyncio.get_running_loop(), list[str]()
    loop.set_exception_handler(lambda _, context: errors.append(str(context)))
    async with served_session(tmp_path) as host:
        peer = deaf(await host.connect())
        await peer.say(kind="hello", role="program", stream="nothing")
        await host.published(lambda line: isinstance(line, m.ConsoleAttached))
        for _ in range(1000):
            host.host._clients[0].send(m.Note(text="x" * 1000))
        leaving = host.host._clients[0]
        leaving.close("silent")
        peer.writer.transport.resume_reading()  # type: ignore[attr-defined]
        assert len(await peer.reader.read(-1)) > 1_000_000
        await lost(host, "silent")
        leaving._abort()  # as when it has lingered
    assert not errors


def test_the_page_of_the_protocol_names_all_that_takes_long() -> None:
    page = (ROOT / "docs" / "reference" / "protocol.md").read_text(encoding="utf-8")
    [named] = re.findall(r"notice\.\n *((?:`[a-z.-]+`(?:, | and )?)+) take long", page)
    slow = [*get_args(request_handlers.Slow)]
    slow += (kind for each in pieces("session", type).values() for kind in each.lookups)
    kinds = {str(kind.__struct_config__.tag) for kind in slow}
    assert {*re.findall("`([a-z.-]+)`", named)} == kinds
