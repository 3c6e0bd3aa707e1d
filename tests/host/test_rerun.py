"""A re-run in the robot process: who must be there for it, and what ends it."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.host.rig import Peer, ServedSession, served_session
from tests.replay.rerun_rig import write_log
from tests.replay.test_rerun_plan import END, LOG, START, command, dispatched, done_message
from tests.session.rig import WAIT_S
from woz_tui.config.experiment import SessionSettings
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.host import rerun_session as host_rerun
from woz_tui.host.rerun_session import RerunOptions, RerunSession, read_plan, without_model
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError


def log_of(tmp_path: Path, *verbs: str, every: float = 0.2) -> Path:
    """A log with these verbs, one every `every` seconds."""
    args: dict[str, dict[str, Any]] = {
        "say": {"text": "Hello"},
        "play": {"move": "nod"},
        "drive": {"x": 1.0},
    }
    lines: list[tuple[float, m.Message]] = [(0, START)]
    for n, verb in enumerate(verbs):
        at = 1 + n * every
        lines += [(at, command(f"c{n}", verb, args=args[verb])), (at, dispatched(f"c{n}"))]
    lines += [(100 + n, done_message(f"c{n}")) for n in range(len(verbs))]
    return write_log(tmp_path / "original" / LOG, [*lines, (900, END)])


def begin_rerun(host: ServedSession, log: Path, *, headless: bool = False) -> RerunSession:
    options = RerunOptions(log, headless, wait_s=WAIT_S)
    rerun = RerunSession(host.host, read_plan(options, host.session.experiment), options)
    rerun.begin_when_ready()
    return rerun


@pytest.fixture(autouse=True)
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first command comes at once."""
    monkeypatch.setattr(host_rerun, "WARNING_US", 20_000)
    monkeypatch.setattr(host_rerun, "LEAD_US", 20_000)


async def rerun_ended(host: ServedSession) -> m.RerunEnded:
    over = await host.published(lambda message: isinstance(message, m.RerunEnded))
    assert isinstance(over, m.RerunEnded)
    return over


async def beating(peer: Peer) -> None:
    while True:
        await peer.say(kind="beat")
        await asyncio.sleep(0.2)


async def test_with_a_console_it_begins_when_a_wizard_is_there(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        begin_rerun(host, log_of(tmp_path, "say"))
        watcher = await host.connect()
        await watcher.hello("watcher")
        await watcher.ask("marker", text="nobody plays yet")
        assert not host.of(m.RerunStarted)
        wizard = await host.connect()
        await wizard.hello("wizard")
        over = await rerun_ended(host)
        assert (over.reason, over.sent_again) == ("done", 1)
        notices = host.of(m.Notice)
        assert "begins in" in notices[-2].text
        assert "1 sent, 0 skipped; lateness p50" in notices[-1].text
        assert notices[-1].remedy == "end the session"
        assert not host.session.ended


async def test_who_comes_in_the_middle_is_told_of_it(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        begin_rerun(host, log_of(tmp_path, *["play"] * 3), headless=True)
        await host.published(lambda message: isinstance(message, m.RerunSent))
        watcher = await host.connect()
        welcome = await watcher.hello("watcher")
        assert "rerun.started" in {line["kind"] for line in welcome["state"]}
        assert "rerun.sent" not in {line["kind"] for line in welcome["recent"]}
        await rerun_ended(host)
        late = await host.connect()
        welcome = await late.hello("watcher")
        assert "rerun.started" not in {line["kind"] for line in welcome["state"]}


async def test_drives_go_while_a_wizard_watches_and_end_with_them(tmp_path: Path) -> None:
    # Who hangs up is gone at once; beats, and the end of them, may be late on a busy machine.
    async with served_session(tmp_path, SessionSettings(dead_man=20.0)) as host:
        wizard = await host.connect()
        await wizard.hello("wizard")
        beats = asyncio.create_task(beating(wizard))
        begin_rerun(host, log_of(tmp_path, "drive", "play", "drive", "play", every=2.0))
        await host.published(lambda message: isinstance(message, m.Dispatched))
        beats.cancel()
        wizard.leave()
        stopped = await host.published(lambda message: isinstance(message, m.Stopped))
        over = await rerun_ended(host)
        assert over.reason == "done"
        assert isinstance(stopped, m.Stopped)
        refused = host.of(m.Refused)
        assert {line.code for line in refused} == {"unwatched"}
        moves = host.of(m.Done)
        assert len(moves) == 2  # what does not drive has gone on


async def test_headless_nothing_drives_and_the_session_ends_with_it(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        begin_rerun(host, log_of(tmp_path, "drive", "play"), headless=True)
        reason = await asyncio.wait_for(host.host.serve(), WAIT_S)
        assert reason == "the re-run is over"
        (refused,) = host.of(m.Refused)
        assert refused.code == "unwatched"
        (notice,) = [line for line in host.of(m.Notice) if "re-run is over" in line.text]
        assert "2 sent, 1 refused, 0 skipped" in notice.text


async def test_headless_it_is_stopped_when_whoever_watched_is_gone(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        program = await host.connect()
        await program.hello("program")
        begin_rerun(host, log_of(tmp_path, *["play"] * 30), headless=True)
        await program.kind("rerun.sent")
        program.leave()
        over = await rerun_ended(host)
        assert over.reason == "stopped"
        assert host.session.bus.latched
        reason = await asyncio.wait_for(host.host.serve(), WAIT_S)
        assert reason == "the re-run: stopped"
        assert host.of(m.StopConfirmed)


@pytest.mark.parametrize(("role", "leaves"), [("watcher", "program"), ("wizard", "wizard")])
async def test_headless_it_goes_on_while_one_of_two_is_there(
    tmp_path: Path, role: str, leaves: str
) -> None:
    """Somebody watches when its program has gone, or a wizard looks in and goes."""
    async with served_session(tmp_path) as host:
        peers = {"program": await host.connect(), role: await host.connect()}
        for name, peer in peers.items():
            await peer.hello(name)
        begin_rerun(host, log_of(tmp_path, *["play"] * 4), headless=True)
        await peers["program"].kind("rerun.sent")
        peers[leaves].leave()
        assert (await rerun_ended(host)).reason == "done"


async def test_one_that_is_over_is_stopped_by_nobody(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        program = await host.connect()
        await program.hello("program")
        begin_rerun(host, log_of(tmp_path, "play"), headless=True)
        await rerun_ended(host)
        program.leave()
        await host.published(lambda message: isinstance(message, m.ConsoleLost))
        assert not host.session.bus.latched


async def test_what_waited_for_its_lane_then_waits_again(tmp_path: Path) -> None:
    """That it took another one's place would stand in the log as that one's end."""
    async with served_session(tmp_path) as host:
        begin_rerun(host, log_of(tmp_path, "play", "play", every=0.01), headless=True)
        await rerun_ended(host)
        ends = host.of(m.End)
        assert [type(end) for end in ends] == [m.Done, m.Done]


async def test_a_stop_before_it_begins_ends_it_too(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        begin_rerun(host, log_of(tmp_path, "say"))
        wizard = await host.connect()
        await wizard.say(kind="stop")
        await rerun_ended(host)
        await wizard.hello("wizard")
        await wizard.ask("release")
        await wizard.ask("marker", text="and nothing comes")
        assert not host.of(m.Command)


async def test_the_sessions_end_ends_it(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        rerun = begin_rerun(host, log_of(tmp_path, *["play"] * 30), headless=True)
        await host.published(lambda message: isinstance(message, m.RerunSent))
        rerun.end("the session ends")
        over = await rerun_ended(host)
        assert over.reason == "the session ends"
        assert over.sent_again < 30


async def test_a_log_without_a_command_is_refused(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        log = write_log(tmp_path / "original" / LOG, [(0, START), (1, END)])
        with pytest.raises(RequestError, match="no command"):
            read_plan(RerunOptions(log), host.session.experiment)
        with pytest.raises(RequestError, match=r"must end in \.jsonl"):
            read_plan(RerunOptions(Path(__file__)), host.session.experiment)


def test_the_model_takes_no_part() -> None:
    drivers = installed()
    guide = load(Path(__file__).parents[2] / "experiments" / "guide.yaml", drivers)
    assert guide.engagement is not None
    assert without_model(guide) == replace(guide, engagement=None)
