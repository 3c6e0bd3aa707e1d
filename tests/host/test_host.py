from __future__ import annotations

import asyncio
import stat
from dataclasses import replace
from pathlib import Path

import pytest

from tests.host.rig import Peer, served_session
from woz_tui.config.experiment import SessionSettings
from woz_tui.drivers.contract import Offer
from woz_tui.drivers.fields import Range
from woz_tui.host.experiment_view import ExperimentView, joint_limits
from woz_tui.protocol import messages as m
from woz_tui.system.session_sockets import SessionSocketError, bind


async def test_hello_gives_the_whole_picture_and_then_the_stream(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        welcome = await peer.hello()
        assert welcome["title"] == "Made by hand"
        assert [panel["title"] for panel in welcome["panels"]] == ["Speech", "Base"]
        assert {line["kind"] for line in welcome["state"]} >= {"session.start", "driver.connected"}
        reply = await peer.ask("action", action="Hello")
        assert reply == {"kind": "reply", "ref": reply["ref"], "ok": True, "run": "a00001"}
        done = await peer.kind("action.done")
        assert done["run"] == "a00001"
        kinds = [line["kind"] for line in peer.seen if "seq" in line and line["kind"] != "welcome"]
        assert kinds.index("action.requested") < kinds.index("command.requested")
        numbers = [line["seq"] for line in peer.seen if "seq" in line]
        assert numbers == sorted(numbers)


async def test_what_was_acknowledged_is_in_the_file(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        reply = await peer.ask("action", action="Hello")
        assert f'"run":"{reply["run"]}"' in host.session.recorder.path.read_text()


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        (b"nonsense\n", "malformed"),
        (b'{"kind":"dance","ref":7}\n', "Invalid value 'dance'"),
        (b'{"kind":"action","actin":"x","ref":7}\n', "unknown field `actin`"),
        (b"[1,2]\n", "Expected `object`"),
        (b'{"kind":"action","action":"Hello"}\n', "say hello first"),
        (b'{"kind":"hello","role":"king"}\n', "no role 'king'"),
        (b'{"kind":"hello","role":"wizard","protocol":99}\n', "speaks protocol 2, not 99"),
        (b'{"kind":"hello","role":"program","protocol":1}\n', "speaks protocol 2, not 1"),
        (b"\xff\xfe\n", "malformed"),
    ],
)
async def test_nonsense_is_answered_and_harms_nothing(
    tmp_path: Path, line: bytes, reason: str
) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        peer.writer.write(line)
        reply = await peer.kind("reply")
        assert not reply["ok"]
        assert reason in reply["reason"]
        other = await host.connect()
        await other.hello()


async def test_which_session_it_is_is_told_without_a_hello_and_leaves_no_trace(
    tmp_path: Path,
) -> None:
    async with served_session(tmp_path) as host:
        host.session.set(participant="P07")
        asker = await host.connect()
        reply = await asker.ask("about")
        assert reply["data"] == {
            "session": "S01", "title": host.experiment.title, "participant": "P07"
        }  # fmt: skip
        asker.leave()
        peer = await host.connect()
        welcome = await peer.hello()
        assert all("console.lost" not in line["kind"] for line in welcome["recent"])
        lines = host.session.recorder.path.read_text()
        assert lines.count("console.attached") == 1, "the peer's own"


async def test_the_refusal_of_a_number_that_json_has_not_finds_its_request(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        peer.writer.write(b'{"kind":"action","action":"Hello","args":{"x":NaN},"ref":7000}\n')
        reply = await peer.kind("reply")
        assert (reply["ok"], reply["ref"]) == (False, 7000)


async def test_a_line_without_end_is_cut_off(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        peer.writer.write(b"x" * (1 << 21))
        assert "at most" in (await peer.kind("reply"))["reason"]
        with pytest.raises((EOFError, ConnectionError)):
            await peer.kind("never")


async def test_stop_needs_no_hello_and_is_confirmed_by_name(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        watcher = await host.connect()
        await watcher.hello("watcher")
        stranger = await host.connect()
        await stranger.say(kind="stop", source="program")
        assert (await stranger.kind("reply"))["ok"]
        assert (await watcher.kind("stop.pressed"))["source"] == "program"
        confirmed = await watcher.kind("stop.confirmed")
        assert confirmed["confirmed"] == ["robot"]
        assert confirmed["missing"] == []


async def test_a_second_wizard_watches_until_it_takes_over(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        first, second = await host.connect(), await host.connect()
        assert (await first.hello("wizard"))["role"] == "wizard"
        assert (await second.hello("wizard"))["role"] == "watcher"
        refused = await second.ask("action", action="Hello")
        assert "only watches" in refused["reason"]
        assert (await second.ask("stop"))["ok"]
        third = await host.connect()
        assert (await third.hello("wizard", take_over=True))["role"] == "wizard"
        told = await first.until(lambda line: line["kind"] == "reply" and line["ref"] == 0)
        assert "taken over" in told["reason"]
        assert not (await first.ask("action", action="Hello"))["ok"]


async def test_who_watches_can_play_once_the_other_one_is_gone(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        first, second = await host.connect(), await host.connect()
        await first.hello("wizard")
        await second.hello("wizard", take_over=True)
        assert "con2 plays" in (await first.ask("take-over"))["reason"]
        second.leave()
        await first.until(lambda line: line["kind"] == "console.lost" and line["console"] == "con2")
        refused = await first.ask("action", action="Hello")
        assert (refused["ok"], refused["command"]) == (False, "take_over")
        assert (await first.ask("take-over"))["ok"]
        assert first.seen[-2]["kind"] == "console.attached"
        await drive(first)


async def drive(peer: Peer) -> None:
    await peer.say(kind="beat")
    reply = await peer.ask("verb", verb="drive", args={"x": 1.0})
    assert reply["ok"]
    assert peer.seen[-2]["kind"] == "command.dispatched"
    assert peer.seen[-2]["command"] == reply["run"]


async def test_driving_ends_with_the_console_and_the_rest_goes_on(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        watcher, wizard = await host.connect(), await host.connect()
        await watcher.hello("watcher")
        await wizard.hello("wizard")
        await drive(wizard)
        await wizard.ask("verb", verb="say", args={"text": "long"})
        wizard.leave()
        stopped = await watcher.kind("command.stopped")
        assert stopped["command"] == "c00001"
        assert (await watcher.kind("command.done"))["command"] == "c00002"
        assert ("stop", {"scope": "drive"}) in host.driver().calls
        assert ("stop", {"scope": "all"}) not in host.driver().calls


@pytest.mark.parametrize("way", ["silent", "line"])
async def test_driving_ends_when_beats_stay_away_or_the_line_is_dead(
    tmp_path: Path, way: str
) -> None:
    # Where the line is dead nobody waits for beats.
    dead_man = 1.0 if way == "silent" else 20.0
    async with served_session(tmp_path, SessionSettings(dead_man=dead_man)) as host:
        wizard = await host.connect()
        await wizard.hello("wizard")
        await drive(wizard)
        if way == "line":
            await wizard.say(kind="beat", line_ok=False)
        await host.published(lambda line: isinstance(line, m.StopPressed) and line.scope == "drive")
        await host.published(lambda line: isinstance(line, m.Stopped))
        if way == "line":
            await wizard.say(kind="beat", line_ok=True)
            await drive(wizard)


async def test_nobody_drives_without_a_wizard(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        program = await host.connect()
        await program.hello()
        await program.ask("verb", verb="drive", args={"x": 1.0})
        refused = await host.published(lambda line: isinstance(line, m.Refused))
        assert isinstance(refused, m.Refused)
        assert refused.code == "unwatched"


async def test_why_nobody_drives_is_about_who_plays_and_not_about_who_comes(
    tmp_path: Path,
) -> None:
    async with served_session(tmp_path, SessionSettings(dead_man=60)) as host:
        wizard, program = await host.connect(), await host.connect()
        await wizard.hello("wizard")
        await wizard.say(kind="beat", line_ok=False)
        assert (await wizard.ask("note", text="the beat has come"))["ok"]
        await program.hello()
        await program.ask("verb", verb="drive", args={"x": 1.0})
        refused = await host.published(lambda line: isinstance(line, m.Refused))
        assert isinstance(refused, m.Refused)
        assert "terminal" in refused.reason


async def test_a_silent_wizard_is_given_up_and_can_come_back(tmp_path: Path) -> None:
    async with served_session(tmp_path, SessionSettings(dead_man=0.1)) as host:
        wizard = await host.connect()
        await wizard.hello("wizard")
        lost = await host.published(lambda line: isinstance(line, m.ConsoleLost))
        assert isinstance(lost, m.ConsoleLost)
        assert lost.why == "silent"
        again = await host.connect()
        assert (await again.hello("wizard"))["role"] == "wizard"


async def test_a_session_without_any_console_is_abandoned(tmp_path: Path) -> None:
    async with served_session(tmp_path, SessionSettings(abandon_after=0.3)) as host:
        peer = await host.connect()
        await peer.hello()
        peer.leave()
        assert await asyncio.wait_for(host.host.serve(), 20) == "abandoned"


@pytest.mark.parametrize("stays_as", ["program", "listener", "server of pages"])
async def test_without_its_wizard_a_session_is_not_kept_by_programs(
    tmp_path: Path, stays_as: str
) -> None:
    async with served_session(tmp_path, SessionSettings(abandon_after=0.3)) as host:
        wizard, stays = await host.connect(), await host.connect()
        await wizard.hello("wizard")
        if stays_as == "listener":  # as `woz listen`, which shows nothing
            await stays.hello("watcher", stream="nothing")
        elif stays_as == "server of pages":
            await stays.hello("watcher", name="page", unattended=True)
            attached = host.session.state.consoles["con2"]
            assert attached.name == "page"
        else:
            await stays.hello("program")
        wizard.leave()
        over = asyncio.ensure_future(host.host.serve())
        for _ in range(100):
            if over.done():
                break
            passing = await host.connect()
            await passing.hello("program")
            await passing.kind("pulse")
            passing.leave()
        assert over.done()
        assert over.result() == "abandoned"


async def test_a_session_that_only_programs_play_goes_on_as_long_as_one_is_there(
    tmp_path: Path,
) -> None:
    async with served_session(tmp_path, SessionSettings(abandon_after=2.0)) as host:
        program, watcher = await host.connect(), await host.connect()
        await program.hello("program")
        await watcher.hello("watcher")
        watcher.leave()
        over = asyncio.ensure_future(host.host.serve())
        for _ in range(60):  # longer than that
            await program.kind("pulse")
        assert not over.done()
        program.leave()
        assert await asyncio.wait_for(over, 20) == "abandoned"


async def test_a_client_that_never_reads_loses_samples_not_acks(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        slow = await host.connect()
        await slow.hello()
        slow.writer.transport.pause_reading()  # type: ignore[attr-defined]
        for index in range(40_000):
            host.session.hub.publish(m.reading("loudness", index / 1e5))
            if index % 1000 == 0:
                host.session.mark(f"m{index}", "program")
                await asyncio.sleep(0)
        slow.writer.transport.resume_reading()  # type: ignore[attr-defined]
        marks = [await slow.kind("marker") for _ in range(40)]
        assert [mark["text"] for mark in marks] == [f"m{1000 * n}" for n in range(40)]
        pulse = await slow.until(lambda line: line["kind"] == "pulse" and "dropped" in line)
        assert pulse["dropped"] > 0


async def test_reload_and_preflight_answer_with_data(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello()
        reply = await peer.ask("reload", dry_run=True)
        assert reply["ok"]
        assert reply.get("data", []) == []
        preflight = await peer.ask("preflight")
        subjects = {finding["subject"] for finding in preflight["data"]}
        assert subjects >= {"robot", "distance", "log", "disk", "date", "session", "stop"}


async def test_the_rest_of_the_requests(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello()
        assert (await peer.ask("mistake"))["reason"] == "nothing has been played yet"
        run = (await peer.ask("action", action="Hello"))["run"]
        assert (await peer.ask("cancel", run=run))["ok"]
        assert (await peer.ask("mistake", text="wrong key"))["ok"]
        assert (await peer.ask("marker", text="here"))["ok"]
        assert (await peer.ask("note", text="he laughed"))["ok"]
        assert not (await peer.ask("note", text=" "))["ok"]
        assert (await peer.ask("lock", panel="Speech", locked=True))["ok"]
        assert "locked" in (await peer.ask("action", action="Hello"))["reason"]
        assert (await peer.ask("set", participant="P09"))["ok"]
        assert not (await peer.ask("set", condition="hot"))["ok"]
        assert not (await peer.ask("release"))["ok"]
        assert "too late" in (await peer.ask("action", action="Hello", stale=True))["reason"]
        assert "too late" in (await peer.ask("action", action="Hello", age_us=9_000_000))["reason"]
        assert (await peer.ask("end"))["ok"]
        assert await asyncio.wait_for(host.host.serve(), 20) == "program"


@pytest.mark.parametrize(
    ("role", "name", "who"),
    [
        ("program", "greeter", "the program greeter"),
        ("program", "", "the program con1"),
        ("wizard", "", "the wizard"),
    ],
)
async def test_whoever_cuts_something_short_is_named(
    tmp_path: Path, role: str, name: str, who: str
) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(role, name=name)
        said = (await peer.ask("verb", verb="say", args={"text": "a long sentence"}))["run"]
        waits = (await peer.ask("verb", verb="say", args={"text": "another one"}))["run"]
        assert (await peer.ask("empty-queue"))["ok"]
        assert (await peer.ask("cancel", run=said))["ok"]
        await host.published(lambda line: isinstance(line, m.Stopped) and line.command == said)
        reasons = {line.command: line.reason for line in host.lines if isinstance(line, m.Stopped)}
        assert reasons == {waits: f"queue emptied by {who}", said: f"cancelled by {who}"}


def test_the_socket_is_private_and_a_dead_one_is_replaced(tmp_path: Path) -> None:
    path = tmp_path / "s"
    bind(path).close()
    assert path.exists()
    with bind(path) as listener:
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
        with pytest.raises(SessionSocketError, match="is running"):
            bind(path)
        assert listener.fileno() >= 0


async def test_a_verb_has_its_variables_filled_in(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello()
        reply = await peer.ask("verb", verb="say", args={"text": "Hello {participant} {{x}}"})
        assert reply["ok"]
        await peer.kind("command.done")
        assert host.driver().calls[-1] == ("say", {"text": "Hello P07 {x}"})
        refused = await peer.ask("verb", verb="say", args={"text": "Hello {nobody}"})
        assert not refused["ok"]
        assert "{nobody} has no value yet" in refused["reason"]
        assert "brace" in refused["hint"]


async def test_the_welcome_tells_the_joints_limits(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        assert (await peer.hello())["settings"]["joints"] == {"pan": [-90.0, 60.0]}


async def test_the_welcome_tells_the_variables_values(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        told = (await peer.hello())["settings"]["values"]
        assert told == host.session.values()


async def test_two_robots_joints_of_one_name_keep_their_limits_apart(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        session = host.session
        pan = replace(
            session.experiment.drivers[0],
            offer=Offer(sensors=("joint.pan",), joints={"pan": Range(-90, 60, "degrees")}),
        )
        drivers = [replace(pan, name=f"{robot}.head") for robot in ("left", "right")]
        session.experiment = replace(session.experiment, drivers=tuple(drivers))
        span = (-90.0, 60.0)
        assert joint_limits(ExperimentView.of(session)) == {"left.pan": span, "right.pan": span}
