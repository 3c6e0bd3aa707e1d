"""Several wizards, each with a part of the panels, over the real socket."""

from __future__ import annotations

import functools
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.host.rig import Peer, ServedSession, served_session
from tests.session.rig import HERE, action, call, experiment, together
from woz_tui.config.experiment import Experiment, Panel, SessionSettings
from woz_tui.features.study.design import Design
from woz_tui.features.study.section import DESIGN
from woz_tui.protocol import messages as m

#: Panel -> an action of it.
OF = {"Speech": "Hello", "Base": "Go", "Lights": "Red"}


def experiment_with_parts(tmp_path: Path) -> Experiment:
    """Speech for the voice, driving for the body, and a panel for nobody in particular."""
    made = experiment(tmp_path)
    speech, base = made.panels
    red = action("Red", together(call("play", move="red")), panel="Lights")
    return replace(
        made,
        panels=(
            replace(speech, parts=("voice",), covers=("say",)),
            replace(base, parts=("body",), covers=("drive",)),
            Panel("Lights", (red,), HERE),
        ),
    )


async def wizard(host: ServedSession, part: str = "", **fields: Any) -> Peer:
    peer = await host.connect()
    welcome = await peer.hello("wizard", **({"part": part} if part else {}), **fields)
    assert welcome.get("part", "") == part
    return peer


async def plays(peer: Peer) -> set[str]:
    """The panels whose actions this client can play."""
    return {panel for panel, name in OF.items() if (await peer.ask("action", action=name))["ok"]}


async def test_each_plays_the_panels_of_their_part(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=experiment_with_parts(tmp_path)) as host:
        voice, body = await wizard(host, "voice"), await wizard(host, "body")
        # What is for no part in particular is for both, as nobody plays without a part.
        assert await plays(voice) == {"Speech", "Lights"}
        assert await plays(body) == {"Base", "Lights"}
        rest = await wizard(host)
        assert await plays(rest) == {"Lights"}
        assert await plays(voice) == {"Speech"}


async def test_a_refusal_says_who_plays_it_and_is_in_the_log(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=experiment_with_parts(tmp_path)) as host:
        await wizard(host, "voice")
        body = await wizard(host, "body")
        reply = await body.ask("action", action="Hello", source="key", key="h")
        assert "voice (con1)" in reply["reason"]
        lines = {line["kind"]: line for line in body.seen if line.get("run") == reply["run"]}
        assert lines["action.requested"]["console"] == "con2"
        assert "voice (con1)" in lines["action.refused"]["reason"]
        typed = await body.ask("verb", verb="say", args={"text": "Hello"}, source="key")
        assert "voice (con1)" in typed["reason"]
        end = await host.published(lambda line: isinstance(line, m.Refused))
        assert isinstance(end, m.Refused)
        assert end.code == "part"
        # What no panel covers is for everybody, and so are notes, markers and the stop.
        assert (await body.ask("verb", verb="play", args={"move": "nod"}))["ok"]
        for kind, fields in (("note", {"text": "x"}), ("marker", {}), ("stop", {})):
            assert (await body.ask(kind, **fields))["ok"]
        assert (await body.ask("release"))["ok"]


async def test_a_wizard_without_a_part_plays_what_nobody_else_does(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=experiment_with_parts(tmp_path)) as host:
        rest = await wizard(host)
        assert await plays(rest) == set(OF)
        voice = await wizard(host, "voice")
        assert await plays(rest) == {"Base", "Lights"}
        voice.leave()
        await rest.kind("console.lost")
        assert await plays(rest) == set(OF)


async def test_what_nobody_plays_any_more_everybody_does(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=experiment_with_parts(tmp_path)) as host:
        voice, body = await wizard(host, "voice"), await wizard(host, "body")
        voice.leave()
        lost = await body.kind("console.lost")
        assert (lost["console"], lost["part"]) == ("con1", "voice")
        assert await plays(body) == set(OF)


async def test_a_part_has_one_player_and_late_ones_see_who(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=experiment_with_parts(tmp_path)) as host:
        first = await wizard(host, "voice")
        second, third = await host.connect(), await host.connect()
        late = await second.hello("wizard", part="voice")
        assert late["role"] == "watcher"
        shown = [line for line in late["state"] if line["kind"] == "console.attached"]
        assert [(line["console"], line["part"]) for line in shown] == [
            ("con1", "voice"),
            ("con2", "voice"),
        ]
        assert [panel.get("parts") for panel in late["panels"]] == [["voice"], ["body"], None]
        refused = await second.ask("action", action="Hello")
        assert "plays voice" in refused["reason"]
        assert "con1" in (await second.ask("take-over"))["reason"]
        taken = await third.hello("wizard", part="voice", take_over=True)
        assert taken["role"] == "wizard"
        assert "taken over" in (await first.until(lambda line: line.get("ref") == 0))["reason"]
        third.leave()
        await second.until(
            lambda line: line["kind"] == "console.lost" and line["console"] == "con3"
        )
        assert (await second.ask("take-over"))["ok"]
        assert await plays(second) >= {"Speech"}


async def test_who_watches_for_no_part_takes_over_the_one_that_is_silent(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=experiment_with_parts(tmp_path)) as host:
        await wizard(host, "voice")
        body, watcher = await wizard(host, "body"), await host.connect()
        await watcher.hello("watcher")
        refused = await watcher.ask("take-over")
        assert "voice (con1)" in refused["reason"]
        assert "body (con2)" in refused["reason"]
        await body.say(kind="beat", line_ok=False)
        await watcher.until(lambda line: line["kind"] == "stop.pressed")
        assert (await watcher.ask("take-over"))["ok"]
        assert (watcher.seen[-2]["kind"], watcher.seen[-2]["part"]) == ("console.attached", "body")
        assert await plays(watcher) == {"Base", "Lights"}


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({"role": "wizard", "part": "vioce"}, "no part 'vioce'"),
        ({"role": "participant", "part": "voice"}, "only a wizard"),
    ],
)
async def test_a_part_that_cannot_be_played_is_refused(
    tmp_path: Path, fields: dict[str, str], reason: str
) -> None:
    async with served_session(tmp_path, made=experiment_with_parts(tmp_path)) as host:
        peer = await host.connect()
        refused = await peer.ask("hello", **fields)
        assert reason in refused["reason"]
        assert "voice, body" in refused["hint"]
        # It is nobody yet, and may say hello again.
        await peer.hello("wizard", part="voice")


async def test_programs_and_phases_play_no_part(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=experiment_with_parts(tmp_path)) as host:
        await wizard(host, "voice")
        await wizard(host, "body")
        program = await host.connect()
        await program.hello()
        assert await plays(program) == set(OF)


async def test_a_program_of_a_part_plays_what_its_wizard_plays(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=experiment_with_parts(tmp_path)) as host:
        await wizard(host, "voice")
        body = await wizard(host, "body")
        program = await host.connect()
        assert (await program.hello(part="voice"))["part"] == "voice"
        assert await plays(program) == {"Speech", "Lights"}
        refused = await program.ask("verb", verb="drive", args={"x": 1.0})
        assert "body (con2)" in refused["reason"]
        assert (await program.ask("verb", verb="say", args={"text": "Hi"}))["ok"]
        # It is no wizard: what nobody plays any more is everybody's.
        body.leave()
        await program.kind("console.lost")
        assert await plays(program) == set(OF)
        assert await plays(await wizard(host, "body")) == {"Base", "Lights"}


async def test_a_verb_of_one_robot_belongs_to_who_plays_that_robot(tmp_path: Path) -> None:
    made = experiment(tmp_path, ("left.body", "right.body"))
    left, right = (
        replace(panel, parts=(part,), covers=(f"{part}.say",))
        for panel, part in zip(made.panels, ("left", "right"), strict=True)
    )
    async with served_session(tmp_path, made=replace(made, panels=(left, right))) as host:
        one = await wizard(host, "left")
        await wizard(host, "right")
        words = {"verb": "say", "args": {"text": "Hi"}}
        assert (await one.ask("verb", on="left", **words))["ok"]
        assert "right (con2)" in (await one.ask("verb", on="right", **words))["reason"]
        # So is the lock of a panel.
        assert (await one.ask("lock", panel=right.title, locked=True))["ok"]
        assert (await one.ask("verb", on="left", **words))["ok"]
        program = await host.connect()
        await program.hello()
        assert "locked" in (await program.ask("verb", on="right", **words))["reason"]


async def test_the_last_mistake_is_ones_own(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=experiment_with_parts(tmp_path)) as host:
        voice, body = await wizard(host, "voice"), await wizard(host, "body")
        mine = (await voice.ask("action", action="Hello"))["run"]
        await body.ask("action", action="Go")
        assert (await voice.ask("mistake"))["ok"]
        wrong = await host.published(lambda line: isinstance(line, m.Mistake))
        assert isinstance(wrong, m.Mistake)
        assert (wrong.run, wrong.console) == (mine, "con1")


async def test_the_log_says_who_began_a_trial_and_who_ended_it(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=experiment_with_parts(tmp_path)) as host:
        voice, body = await wizard(host, "voice"), await wizard(host, "body")
        assert (await voice.ask("trial", what="begin"))["ok"]
        assert (await body.ask("trial", what="done"))["ok"]
        found = {
            type(line): line.console
            for line in host.lines
            if isinstance(line, m.TrialStarted | m.TrialEnded)
        }
        assert found == {m.TrialStarted: "con1", m.TrialEnded: "con2"}


async def test_each_wizard_is_blind(tmp_path: Path) -> None:
    made = experiment_with_parts(tmp_path)
    design = Design(blind={"warm": "A", "cold": "B"})
    async with served_session(tmp_path, made=replace(made, sections={DESIGN: design})) as host:
        for part in ("voice", "body", ""):
            peer = await host.connect()
            assert (await peer.hello("wizard", part=part))["conditions"] == ["A", "B"]
            await plays(peer)
            assert not [line for line in peer.seen if "warm" in str(line).casefold()]


# -- the dead man's switch ------------------------------------------------------------------------


def of_drive(line: m.Message) -> bool:
    return isinstance(line, m.StopPressed) and line.scope == "drive"


async def drive(peer: Peer) -> bool:
    """Whether a drive of this client begins."""
    reply = await peer.ask("action", action="Go")
    return bool(reply["ok"])


async def test_driving_goes_on_without_the_voice_and_ends_without_the_body(tmp_path: Path) -> None:
    async with served_session(
        tmp_path, SessionSettings(dead_man=60), made=experiment_with_parts(tmp_path)
    ) as host:
        voice, body = await wizard(host, "voice"), await wizard(host, "body")
        assert await drive(body)
        await voice.say(kind="beat", line_ok=False)
        voice.leave()
        await body.kind("console.lost")
        assert not any(map(of_drive, host.lines))
        await body.say(kind="beat", line_ok=False)
        await host.published(of_drive)
        await host.published(lambda line: isinstance(line, m.Stopped))
        assert not await drive(body)


async def test_who_drives_is_asked_for_although_another_one_could(tmp_path: Path) -> None:
    """Without panels for it everybody can drive: it ends with the one who has begun it."""
    made = experiment_with_parts(tmp_path)
    speech, _, lights = made.panels
    made = replace(made, panels=(speech, replace(lights, parts=("body",))))
    async with served_session(tmp_path, SessionSettings(dead_man=60), made=made) as host:
        voice, body = await wizard(host, "voice"), await wizard(host, "body")
        assert (await body.ask("verb", verb="drive", args={"x": 1.0}))["ok"]
        await voice.say(kind="beat", line_ok=False)
        assert (await body.ask("note", text="the voice is away"))["ok"]
        assert not any(map(of_drive, host.lines))
        await voice.say(kind="beat")
        assert (await voice.ask("note", text="it is back"))["ok"]
        body.leave()
        await host.published(of_drive)
        await voice.kind("console.lost")
        assert (await voice.ask("verb", verb="drive", args={"x": 1.0}))["ok"]


async def test_what_a_program_drives_ends_with_the_part_that_drives(tmp_path: Path) -> None:
    async with served_session(
        tmp_path, SessionSettings(dead_man=60), made=experiment_with_parts(tmp_path)
    ) as host:
        voice = await wizard(host, "voice")
        body, program = await wizard(host, "body"), await host.connect()
        await program.hello()
        assert await drive(program)
        body.leave()
        await host.published(of_drive)
        # From now on the voice plays everything, and is responsible for it.
        await voice.kind("console.lost")
        assert await drive(program)


async def test_why_nobody_drives_names_the_part_that_drives(tmp_path: Path) -> None:
    async with served_session(
        tmp_path, SessionSettings(dead_man=60), made=experiment_with_parts(tmp_path)
    ) as host:
        voice, body = await wizard(host, "voice"), await wizard(host, "body")
        second, program = await host.connect(), await host.connect()
        await program.hello()
        assert (await second.hello("wizard", part="body"))["role"] == "watcher"
        await body.say(kind="beat", line_ok=False)
        await host.published(of_drive)
        second.leave()
        await host.published(lambda line: isinstance(line, m.ConsoleLost))
        for line_ok in (False, True):  # another part's line comes and goes
            await voice.say(kind="beat", line_ok=line_ok)
        assert (await voice.ask("note", text="the beats have come"))["ok"]
        assert not await drive(program)
        refused = [line.reason for line in host.of(m.Refused)]
        assert all("terminal" in reason and "body" in reason for reason in refused)
        assert refused


# -- at random ------------------------------------------------------------------------------------


def is_later_loss(seq: int, line: m.Message) -> bool:
    return isinstance(line, m.ConsoleLost) and line.seq > seq


@pytest.mark.parametrize("seed", range(4))
async def test_nobody_plays_what_is_anothers_and_every_press_is_answered(
    tmp_path: Path, seed: int
) -> None:
    chance = random.Random(seed)
    async with served_session(
        tmp_path, SessionSettings(dead_man=60), made=experiment_with_parts(tmp_path)
    ) as host:
        owners = {"Speech": "voice", "Base": "body", "Lights": ""}
        there: dict[str, Peer] = {}
        for _ in range(60):
            part = chance.choice(["voice", "body", ""])
            peer = there.get(part)
            if peer is None:
                there[part] = await wizard(host, part)
            elif chance.random() < 0.15:
                peer.leave()
                del there[part]
                gone = host.lines[-1].seq
                await host.published(functools.partial(is_later_loss, gone))
            else:
                panel = chance.choice([*OF])
                reply = await peer.ask("action", action=OF[panel], when_busy="replace")
                owner = owners[panel] if owners[panel] in there else "" if "" in there else part
                assert reply["ok"] == (owner == part), (panel, part, [*there], reply)
                assert reply["run"]
        ended = {line.run for line in host.of(m.ActionEnd)}
        refused = host.of(m.ActionRefused)
        assert {line.run for line in refused} <= ended
