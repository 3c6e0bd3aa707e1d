"""Clients that ask too much, read too little, or stop in the middle: nobody else notices."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.host.rig import Peer, Served, served
from woz_tui.core import messages as m

FLOOD = b'{"kind":"action","ref":1,"action":"Hello"}\n' * 3000


def deaf(peer: Peer) -> Peer:
    """It never reads again."""
    peer.writer.transport.pause_reading()  # type: ignore[attr-defined]
    return peer


async def lost(host: Served, why: str) -> None:
    gone = await host.published(lambda line: isinstance(line, m.ConsoleLost))
    assert isinstance(gone, m.ConsoleLost)
    assert gone.why == why


async def turns(what: Callable[[], object], times: int) -> None:
    for _ in range(times):
        what()
        await asyncio.sleep(0)


async def test_who_reads_no_acks_is_let_go_of(tmp_path: Path) -> None:
    async with served(tmp_path) as host:
        peer = deaf(await host.connect())
        await peer.say(kind="hello", role="program")
        await host.published(lambda line: isinstance(line, m.ConsoleAttached))
        await turns(lambda: host.session.mark("x" * 200, "program"), 20_000)
        await lost(host, "too slow")
        peer.leave()


async def test_who_asks_and_never_reads_is_let_go_of(tmp_path: Path) -> None:
    async with served(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        deaf(peer)
        misspelt = b'{"kind":"%b"}\n' % (b"x" * 900)

        async def ask() -> None:
            while True:
                peer.writer.write(misspelt * 100)
                await peer.writer.drain()

        asking = asyncio.ensure_future(ask())
        await lost(host, "too slow")
        asking.cancel()
        await asyncio.wait([asking])


async def test_a_closed_connection_to_somebody_frozen_does_not_linger(tmp_path: Path) -> None:
    """Otherwise a console that hangs would keep the session from being abandoned."""
    async with served(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        deaf(peer)
        for client in host.host._clients:
            for _ in range(1000):
                client.send(m.Note(text="x" * 1000))
            client.close("silent")
        await lost(host, "silent")


async def test_a_flood_of_one_disturbs_no_other(tmp_path: Path) -> None:
    async with served(tmp_path) as host:
        wizard, program = await host.connect(), await host.connect()
        await wizard.hello("wizard")
        await program.hello(stream="nothing")
        program.writer.write(FLOOD)
        assert (await wizard.ask("marker", text="still here"))["ok"]
        marker = await host.published(lambda line: isinstance(line, m.Marker))
        asked = [line for line in host.lines if isinstance(line, m.ActionRequested)]
        assert len([line for line in asked if line.seq < marker.seq]) < 3000
        for _ in range(3000):
            await program.kind("reply")
        assert host.host.wizard is not None


@pytest.mark.parametrize("end", [b"", b'{"kind":"marker","te'])
async def test_what_was_asked_before_leaving_is_done(tmp_path: Path, end: bytes) -> None:
    async with served(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        peer.writer.write(b'{"kind":"marker","text":"a"}\n' * 200 + b'{"kind":"stop"}\n' + end)
        peer.writer.write_eof()
        await host.published(lambda line: isinstance(line, m.StopPressed))
        await lost(host, "closed")


async def test_the_last_line_of_the_log_reaches_everybody(tmp_path: Path) -> None:
    async with served(tmp_path) as host:
        peer = await host.connect()
        await peer.hello()
        await peer.say(kind="end", reason="enough")
        reason = await host.host.serve()
        await host.session.close(reason, rest=False)
        await host.host.close()
        assert (await peer.kind("session.end"))["reason"] == "enough"


async def test_no_request_is_too_deep_to_be_answered(tmp_path: Path) -> None:
    async with served(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        for depth in range(880, 1000, 4):
            text = b"[" * depth + b"]" * depth
            peer.writer.write(
                b'{"kind":"verb","ref":%d,"verb":"say","args":{"text":%b}}\n' % (depth, text)
            )
            reply = await peer.kind("reply")
            assert reply["ref"] in {depth, 0}
