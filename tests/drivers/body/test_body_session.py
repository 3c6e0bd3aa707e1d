"""A body in a whole session: real bus, hub, recorder and experiment file, in virtual time."""

from __future__ import annotations

import asyncio
import itertools
import wave
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

from tests.drivers.body.rig import SteppedBody, within
from tests.session.rig import SessionRig
from tools import EXPERIMENTS, show_tune
from tools.demo_session import catalogue
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Ask
from woz_tui.features.scripts.in_session import ScriptController
from woz_tui.features.scripts.section import SCRIPT
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.participant_identity import SessionIdentity

KEY = RequestOrigin("key", "h", "con1")
PROGRAM = RequestOrigin("program", "", "bridge1")


class BodySession(SessionRig):
    """A session on an example."""

    def __init__(self, folder: Path, name: str) -> None:
        drivers = catalogue()
        made = load(EXPERIMENTS / f"{name}.yaml", drivers)
        who = SessionIdentity(participant="P01", condition=next(iter(made.conditions), ""))
        super().__init__(folder, identity=who, catalogue=drivers, made=made)

    def body(self, name: str = "body") -> SteppedBody:
        driver = self.session.drivers[name]
        assert isinstance(driver, SteppedBody)
        return driver


def on_stage(
    tmp_path: Path, scenario: Callable[[BodySession], Awaitable[None]], name: str = "eyepi"
) -> BodySession:
    async def half_a_second_later(rig: BodySession) -> None:
        await asyncio.sleep(0.5)
        await scenario(rig)

    return BodySession(tmp_path, name).run(half_a_second_later)


@pytest.mark.toolkit("L2", "L7", "M1")
def test_it_plays_gazes_stops_and_stirs_again(tmp_path: Path) -> None:
    async def scenario(rig: BodySession) -> None:
        rig.session.play("Dance", KEY)
        await asyncio.sleep(2)
        rig.session.play("Left", KEY)  # a gaze: the dance is over
        await asyncio.sleep(2)
        assert rig.kinds(m.ActionDone) == ["ActionDone", "ActionDone"]
        assert rig.values("setpoint.pitch")[-1] == pytest.approx(45.0, abs=1.0)
        rig.session.play("Dance", KEY)
        await asyncio.sleep(1)
        rig.session.stop("key")
        await asyncio.sleep(0.6)
        stopped = rig.of(m.StopConfirmed)
        assert "body" in stopped[-1].confirmed and not stopped[-1].missing
        held = rig.values("joint.pitch")[-1], rig.values("joint.top")[-1]
        await asyncio.sleep(2)
        assert (rig.values("joint.pitch")[-1], rig.values("joint.top")[-1]) == held
        with pytest.raises(RequestError, match="stop"):
            rig.session.play("Nod", KEY)
        rig.session.release("key")
        await asyncio.sleep(3)
        breath = rig.values("joint.top")[-20:]
        assert max(breath) - min(breath) > 1.0
        rig.session.play("Nod", KEY)
        await asyncio.sleep(3)

    rig = on_stage(tmp_path, scenario)
    assert rig.kinds(m.ActionDone)[-1] == "ActionDone"
    modes = [line.now for line in rig.of(m.ModeChanged)]
    assert modes == ["normal"]
    assert not rig.kinds(m.Failed, m.DriverFaulted, m.LaneFaulted)


@pytest.mark.toolkit("M2", "M3", "E4")
def test_programs_cannot_interrupt_the_demo_and_the_wizard_can(tmp_path: Path) -> None:
    async def scenario(rig: BodySession) -> None:
        rig.session.play("Demo", KEY)
        await asyncio.sleep(5)
        rig.session.send("gaze", {"yaw": 20}, "", PROGRAM)
        await asyncio.sleep(0.1)
        refused = rig.of(m.Refused)
        assert "demo" in refused[-1].reason
        rig.session.play("Normal", KEY)
        await asyncio.sleep(2)
        rig.session.send("gaze", {"yaw": 20}, "", PROGRAM)
        await asyncio.sleep(1)
        assert rig.values("setpoint.pitch")[-1] == pytest.approx(20.0, abs=1.0)

    rig = on_stage(tmp_path, scenario)
    modes = [line.now for line in rig.of(m.ModeChanged)]
    assert modes == ["normal", "demo", "normal"]
    assert len(rig.kinds(m.Refused)) == 1


def test_a_burst_of_steps_of_a_control_loses_none(tmp_path: Path) -> None:
    async def scenario(rig: BodySession) -> None:
        for _ in range(28):
            rig.session.play("Pitch left", KEY)
            rig.session.play("Pitch right", KEY)
        await asyncio.sleep(1)

    rig = on_stage(tmp_path, scenario)
    assert rig.kinds(m.Refused, m.Failed) == []
    assert rig.kinds(m.ActionDone) == ["ActionDone"] * 56


def test_replacing_a_move_ends_it_and_begins_anew(tmp_path: Path) -> None:
    async def scenario(rig: BodySession) -> None:
        rig.session.play("Dance", KEY)
        await asyncio.sleep(1)
        rig.session.play("Nod", KEY, when_busy="replace")
        await asyncio.sleep(3)

    rig = on_stage(tmp_path, scenario)
    assert len(rig.kinds(m.Superseded)) == 1
    assert "ActionDone" in rig.kinds(m.ActionDone)


NOD = "name: mine\nframes:\n  - {seconds: 0.4, nod: 20}\n  - {seconds: 0.4, nod: 0}\n"


def test_a_move_given_whole_plays_as_any_other_and_ends_with_the_stop(tmp_path: Path) -> None:
    async def scenario(rig: BodySession) -> None:
        rig.session.send("play_move", {"move": NOD}, "body", PROGRAM)
        await asyncio.sleep(0.4)
        assert rig.values("setpoint.top")[-1] > rig.values("setpoint.top")[0] + 10
        await asyncio.sleep(2)
        rig.session.send("play_move", {"move": NOD.replace("0.4", "5")}, "body", PROGRAM)
        await asyncio.sleep(1)
        rig.session.stop("key")
        await asyncio.sleep(0.6)
        assert "body" in rig.of(m.StopConfirmed)[-1].confirmed
        rig.session.send("play_move", {"move": NOD}, "body", PROGRAM)
        rig.session.release("key")
        rig.session.send("play_move", {"move": "name: mine\nframes: [{nod: 3}]"}, "body", PROGRAM)
        await asyncio.sleep(0.5)

    rig = on_stage(tmp_path, scenario)
    done = rig.of(m.Done)
    assert [(one.sent["move"], one.sent["seconds"]) for one in done] == [("mine", 0.8)]
    assert len(rig.kinds(m.Stopped)) == 1
    pressed, unreadable = rig.of(m.Refused)
    assert pressed.code == "stopped"
    assert "seconds" in unreadable.reason


@pytest.mark.toolkit("U1", "P5")
def test_the_show_is_played_to_its_end_by_two_robots(tmp_path: Path) -> None:
    async def scenario(rig: BodySession) -> None:
        script = SCRIPT.of(rig.session.experiment)
        for number in range(len(script)):
            rig.session.features.of(ScriptController).play_next(KEY)
            for _ in range(400):
                await asyncio.sleep(0.1)
                if len(rig.kinds(m.ActionDone, m.ActionFailed)) > number:
                    break
        await asyncio.sleep(1)

    rig = on_stage(tmp_path, scenario, "show")
    script = SCRIPT.of(rig.session.experiment)
    assert rig.kinds(m.ActionEnd) == ["ActionDone"] * len(script)
    ways: dict[str, list[object]] = {"joy.body": [], "grim.body": []}
    for line in rig.lines:
        if isinstance(line, m.BodyChanged) and line.values["personality"] not in (
            ways[line.driver][-1:] or ["default"]
        ):
            ways[line.driver].append(line.values["personality"])
    assert ways == {"joy.body": ["upbeat"], "grim.body": ["grumpy", "upbeat"]}
    # One of them sleeps. The happy one breaks down, and the grumpy one is amazed, then sad.
    assert _emotions(rig, "joy", "Curtain", "Joy dances") == ["neutral", "amazed"]
    assert _emotions(rig, "grim", "Curtain", "Grim objects") == ["sleepy"]
    assert _emotions(rig, "joy", "Crash", "Revival") == ["happy", "crash", "sleepy"]
    assert _emotions(rig, "grim", "Crash", "Revival") == ["angry", "amazed", "sad"]
    assert _emotions(rig, "joy", "Revival", "")[-1] == "happy"
    assert _emotions(rig, "grim", "Revival", "")[-1] == "happy"
    played = {
        (line.action, Path(str(line.args["file"])).name)
        for line in rig.of(m.Command)
        if line.verb == "sound"
    }
    assert played == {
        *((scene, "tune.wav") for scene in ("Music", "Joy dances", "Crash", "Together")),
        ("Crash", "run-down.wav"),
    }
    # What they utter goes with their faces, and the log has it for a re-run; mixes move the body.
    uttered = [line for line in rig.of(m.Command) if line.verb == "utter"]
    assert [line.action for line in uttered] == ["Music", "Grim objects", "Shock", "Revival"]
    assert all(isinstance(line.args["seed"], int) for line in uttered)
    music, angry, shock, happy = (
        (float(str(line.args["valence"])), float(str(line.args["arousal"]))) for line in uttered
    )
    assert music[1] > 0 and shock[1] > music[1]  # amazed, the second time wholly
    assert angry[0] < 0 < happy[0]
    mixes = [line.args["control"] for line in rig.of(m.Command) if line.verb == "control"]
    assert mixes == ["curious", "curious", "timid", "curious", "curious", "timid"]
    assert not rig.kinds(m.Refused, m.Failed)
    for robot, name in (("joy", "joint.pitch"), ("grim", "joint.pitch")):
        turned = rig.values(f"{robot}.{name}")
        assert max(turned) - min(turned) > 20
    settings = rig.body("joy.body").settings
    path = [{"pitch": angle} for angle in rig.values("joy.joint.pitch")]
    assert all(settings.joints["pitch"].min <= pose["pitch"] <= 90 for pose in path)


@pytest.mark.toolkit("U1")
def test_the_music_of_the_show_lasts_as_long_as_the_dance(tmp_path: Path) -> None:
    async def scenario(rig: BodySession) -> None:
        rig.session.play("Curtain", KEY)
        await asyncio.sleep(5)
        rig.session.play("Joy dances", KEY)
        await asyncio.sleep(10)

    rig = on_stage(tmp_path, scenario, "show")
    verbs = {line.command: line.verb for line in rig.of(m.Command)}
    lasted = {verbs[line.command]: line.duration_us / 1e6 for line in rig.of(m.Done)}
    assert lasted["sound"] == pytest.approx(lasted["play"], abs=0.1)
    for name, samples in (("tune", show_tune.tune()), ("run-down", show_tune.run_down())):
        with wave.open(str(EXPERIMENTS / "media" / f"{name}.wav")) as sound:
            written = sound.readframes(sound.getnframes())
        assert len(written) == len(samples)
        # A machine may round another way where a wave turns over.
        assert sum(a != b for a, b in zip(written, samples, strict=True)) < 100, (
            "run `python -m tools.show_tune`"
        )


def _emotions(rig: BodySession, robot: str, first: str, until: str) -> list[str]:
    """What a robot shows, one after the other, from one scene to the beginning of another."""
    scenes = {
        line.action: place
        for place, line in enumerate(rig.lines)
        if isinstance(line, m.ActionRequested)
    }
    shown = [
        line.emotion
        for line in rig.lines[scenes[first] : scenes.get(until)]
        if isinstance(line, m.FaceShown) and line.driver == f"{robot}.body"
    ]
    return [emotion for emotion, _ in itertools.groupby(shown)]


@pytest.mark.toolkit("U4", "L8")
def test_minutes_without_input_it_stays_alive_where_it_was(tmp_path: Path) -> None:
    async def scenario(rig: BodySession) -> None:
        await asyncio.sleep(150)
        tops = rig.values("joint.top")[50:]
        first, last = tops[:600], tops[-600:]
        assert max(first) - min(first) > 3.0
        assert max(last) - min(last) > 3.0
        assert sum(first) / 600 == pytest.approx(sum(last) / 600, abs=0.1)

    rig = on_stage(tmp_path, scenario)
    assert len({line.rows for line in rig.of(m.FaceShown)}) > 1


def test_a_body_may_ask_for_the_sound_of_a_move(tmp_path: Path) -> None:
    async def scenario(rig: BodySession) -> None:
        heard: list[tuple[bool, str]] = []
        context = rig.body().context
        context.ask(
            Ask("verb", "sound", {"file": "media/gong.wav"}, source="body"),
            lambda carried, why: heard.append((carried, why)),
        )
        await asyncio.sleep(5)
        assert heard == [(True, "")]

    rig = on_stage(tmp_path, scenario)
    command = next(line for line in rig.of(m.Command))
    assert (command.driver, command.verb, command.source) == ("voice", "sound", "body")


def test_readings_keep_the_limits_at_rest_and_in_the_end(tmp_path: Path) -> None:
    async def scenario(rig: BodySession) -> None:
        await asyncio.sleep(1)

    rig = on_stage(tmp_path, scenario)
    settings = rig.body().settings
    last = {name: rig.values(f"joint.{name}")[-1] for name in settings.joints}
    # The last reading is up to a tenth of a second older than the arrival.
    assert last == pytest.approx(dict(settings.rest_pose), abs=2.0)
    assert within(settings, [last])
