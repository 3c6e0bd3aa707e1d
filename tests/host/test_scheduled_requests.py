"""Requests for a moment: they begin then, and only if they still may."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.host.rig import Peer, ServedSession, served_session
from tests.host.test_programs import program, with_profile
from woz_tui.gate.table import MOST_SCHEDULED
from woz_tui.protocol import messages as m

REQUESTS: list[tuple[str, dict[str, Any]]] = [
    ("action", {"action": "Hello"}),
    ("verb", {"verb": "say", "args": {"text": "Hello"}}),
]
#: Further ahead than any test takes, in microseconds.
FAR_US = 600_000_000


def soon(host: ServedSession, seconds: float) -> int:
    return host.session.hub.now() + round(seconds * 1e6)


@pytest.mark.parametrize(("kind", "fields"), REQUESTS)
async def test_it_begins_at_its_moment(tmp_path: Path, kind: str, fields: dict[str, Any]) -> None:
    async with served_session(tmp_path) as host:
        peer = await program(host)
        at = soon(host, 1.0)
        reply = await peer.ask(kind, **fields, at=at)
        assert reply["ok"]
        [scheduled] = [line for line in peer.seen if line["kind"] == "action.scheduled"]
        assert (scheduled["run"], scheduled["at"]) == (reply["run"], at)
        dispatched = await peer.kind("command.dispatched")
        assert dispatched["t"] >= at
        assert host.driver().calls == [
            ("say", {"text": "Hello P07" if kind == "action" else "Hello"})
        ]


@pytest.mark.parametrize(("kind", "fields"), REQUESTS)
async def test_a_moment_that_has_passed_is_refused_with_how_late_it_is(
    tmp_path: Path, kind: str, fields: dict[str, Any]
) -> None:
    async with served_session(tmp_path) as host:
        peer = await program(host)
        reply = await peer.ask(kind, **fields, at=max(1, soon(host, -0.25)))
        assert not reply["ok"]
        assert "too late" in reply["reason"]
        ends = [line for line in peer.seen if line["kind"].endswith(".refused")]
        assert len(ends) == 1, "it is in the log, too"
        assert not host.driver().calls


async def stop(peer: Peer, run: str) -> None:
    await peer.ask("stop")


async def cancel(peer: Peer, run: str) -> None:
    assert (await peer.ask("cancel", run=run))["ok"]


async def empty(peer: Peer, run: str) -> None:
    assert (await peer.ask("empty-queue"))["ok"]


@pytest.mark.parametrize(("kind", "fields"), REQUESTS)
@pytest.mark.parametrize("end", [stop, cancel, empty])
async def test_what_waits_can_be_ended(
    tmp_path: Path, kind: str, fields: dict[str, Any], end: Any
) -> None:
    async with served_session(tmp_path) as host:
        peer = await program(host)
        run = (await peer.ask(kind, **fields, at=soon(host, FAR_US / 1e6)))["run"]
        await end(peer, run)
        over = [
            line
            for line in peer.seen
            if run in (line.get("run"), line.get("command"))
            and line["kind"].endswith((".stopped", ".refused"))
        ]
        assert len(over) == 1
        assert all(verb == "stop" for verb, _ in host.driver().calls)


@pytest.mark.parametrize(("kind", "fields"), REQUESTS)
async def test_what_was_locked_in_the_meantime_does_not_begin(
    tmp_path: Path, kind: str, fields: dict[str, Any]
) -> None:
    experiment = with_profile(tmp_path)
    async with served_session(tmp_path, made=experiment) as host:
        peer = await program(host)
        run = (await peer.ask(kind, **fields, at=soon(host, 1.5)))["run"]
        await peer.ask("profile", profile="child")
        await peer.ask("lock", panel="Speech", locked=True)
        ended = await peer.until(
            lambda line: (
                run in (line.get("run"), line.get("command")) and line["kind"].endswith(".refused")
            )
        )
        assert "locked" in ended["reason"] or "profile" in ended["reason"]
        assert not host.driver().calls


async def test_what_makes_no_sense_is_refused_at_once(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await program(host)
        at = soon(host, FAR_US / 1e6)
        assert "needs 'text'" in (await peer.ask("verb", verb="say", at=at))["reason"]
        await peer.ask("stop")
        for kind, fields in REQUESTS:
            assert "stop" in (await peer.ask(kind, **fields, at=at))["reason"]


@pytest.mark.parametrize("at", [-5, 1 << 62, -(1 << 62), 10**30])
@pytest.mark.parametrize(("kind", "fields"), REQUESTS)
async def test_a_moment_that_makes_no_sense_is_refused(
    tmp_path: Path, kind: str, fields: dict[str, Any], at: int
) -> None:
    async with served_session(tmp_path) as host:
        peer = await program(host)
        assert not (await peer.ask(kind, **fields, at=at))["ok"]
        assert not (await peer.ask("marker", text="x", at=10**30))["ok"]
        assert not (await peer.ask("marker", text="x", at=min(-5, -at)))["ok"]
        assert (await peer.ask("action", action="Hello"))["ok"], "it goes on"


async def test_so_many_wait_and_no_more(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await program(host)
        at = soon(host, FAR_US / 1e6)
        for number in range(MOST_SCHEDULED):
            kind, fields = REQUESTS[number % 2]
            assert (await peer.ask(kind, **fields, at=at))["ok"]
        assert not (await peer.ask("action", action="Hello", at=at))["ok"]
        ended = len(host.of(m.ActionEnd))
        assert ended == 1
        await empty(peer, "")
        for _ in range(MOST_SCHEDULED):
            assert (await peer.ask("action", action="Hello", at=at))["ok"], "what was ended is gone"
