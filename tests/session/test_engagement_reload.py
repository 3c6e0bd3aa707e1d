"""The section `engagement` comes, goes and changes while a session runs."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from pathlib import Path

import pytest

from tests.session.engagement_rig import PLAIN, EngagementRig, effect, guided, in_room
from tests.session.rig import call, together
from woz_tui.config.engagement import EngagementSettings, Timeouts
from woz_tui.config.experiment import Experiment, Wait
from woz_tui.drivers.contract import SPEECH, Health
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json

SHOWING = EngagementSettings()


def reload(rig: EngagementRig, experiment: Experiment) -> None:
    rig.robot.calls.clear()
    rig.session.adopt(experiment, ["the section"])


def eyes(rig: EngagementRig) -> list[Json]:
    """Colours that the robot was told since the last look."""
    colors = [args["color"] for verb, args in rig.robot.calls if verb == "eyes"]
    rig.robot.calls.clear()
    return colors


def test_a_model_that_comes_back_begins_anew(tmp_path: Path) -> None:
    experiment = guided(tmp_path, SHOWING)

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("force", to="RobotReplies")
        await asyncio.sleep(1)
        assert eyes(rig) == ["off", "blue"]
        reload(rig, replace(experiment, engagement=None))
        held = {type(message) for message in rig.session.state.messages()}
        assert not held & {m.EngagementChanged, m.EngagementShown}
        await asyncio.sleep(1)
        reload(rig, experiment)
        await asyncio.sleep(1)
        assert rig.engagement_shown.state == "Wait"
        assert eyes(rig) == ["off"]
        rig.session.stop("key")
        await asyncio.sleep(1)
        rig.session.release("key")
        await asyncio.sleep(1)
        assert eyes(rig) == ["off"]

    in_room(tmp_path, scenario, experiment)


def test_what_the_model_had_begun_ends_with_it(tmp_path: Path) -> None:
    effects = effect("RobotThinks", Wait(2.0), together(call("say", text="That is a long story")))
    experiment = guided(tmp_path, PLAIN, effects)

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("force", to="RobotThinks")
        await asyncio.sleep(1)
        reload(rig, replace(experiment, engagement=None))
        await asyncio.sleep(5)
        assert rig.robot.calls == []
        assert rig.of(m.ActionStopped)[-1].reason == "the engagement model was removed"

    in_room(tmp_path, scenario, experiment)


def test_a_model_that_comes_later_knows_who_cuts_speech(tmp_path: Path) -> None:
    """A microphone's driver has said so long ago: loudness is no speech."""
    experiment = guided(tmp_path)

    async def scenario(rig: EngagementRig) -> None:
        rig.robot.context.sensor(SPEECH, "ready")
        await asyncio.sleep(1)
        reload(rig, experiment)
        rig.stands_there()
        await asyncio.sleep(1)
        rig.sense(loudness=0.9)
        await asyncio.sleep(0.1)
        assert rig.engagement_shown.state == "EngagedWithKnown"
        assert rig.engagement_shown.since >= 1_000_000

    in_room(tmp_path, scenario, replace(experiment, engagement=None))


def test_a_time_limit_that_is_new_counts_though_no_sensor_says_anything(tmp_path: Path) -> None:
    settings = replace(PLAIN, timeouts=Timeouts(approach=5.0))

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("sense", sign="presence", value="on")
        await asyncio.sleep(4)  # signs have grown old: nothing else is due
        reload(rig, guided(tmp_path, settings))
        await asyncio.sleep(2)
        assert rig.path[:2] == ["PersonDetected", "Wait"]

    in_room(tmp_path, scenario, guided(tmp_path))


def test_a_model_that_is_off_shows_nothing_and_shows_all_once_it_runs(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await asyncio.sleep(1)
        rig.session.stop("key")
        await asyncio.sleep(1)
        rig.session.release("key")
        rig.robot.context.health(Health.CONNECTED, "once more")
        await asyncio.sleep(1)
        assert eyes(rig) == []
        rig.tell("engagement", run="run")
        await asyncio.sleep(1)
        assert eyes(rig) == ["off"]
        rig.tell("engagement", run="hold")
        await asyncio.sleep(1)
        assert eyes(rig) == []

    in_room(tmp_path, scenario, guided(tmp_path, replace(SHOWING, start="off")), linger=0)


def test_what_waits_for_a_busy_robot_is_dropped_when_the_state_is_left(tmp_path: Path) -> None:
    effects = {
        **effect("PersonDetected", together(call("say", text="Hello"), call("play", move="wave"))),
        **effect("Wait", together(call("say", text="Bye"))),
    }

    async def scenario(rig: EngagementRig) -> None:
        for _ in range(21):
            rig.tell("toggle", sign="presence")
            await asyncio.sleep(0.2)
        assert rig.path[-1] == "PersonDetected"
        began = [args["text"] for verb, args in rig.robot.calls if verb == "say"]
        rig.robot.calls.clear()
        await asyncio.sleep(10)
        late = [args["text"] for verb, args in rig.robot.calls if verb == "say"]
        assert len(began) + len(late) <= 6
        assert late in ([], ["Hello"])
        reasons = {end.reason for end in rig.of(m.ActionStopped)}
        assert "the state changed from Wait to PersonDetected" in reasons

    in_room(tmp_path, scenario, guided(tmp_path, PLAIN, effects))


@pytest.mark.parametrize("spoken", [0.5, 1.5])
def test_a_step_that_has_begun_in_part_is_finished(tmp_path: Path, spoken: float) -> None:
    """The robot speaks, or has spoken, and waves once it has bowed."""
    effects = effect("PersonDetected", together(call("say", text="Hi"), call("play", move="wave")))

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("play", move="bow")
        rig.tell("play", move="bow")
        rig.tell("force", to="PersonDetected")
        await asyncio.sleep(spoken)
        rig.tell("force", to="Wait")
        await asyncio.sleep(5)
        moves = [args["move"] for verb, args in rig.robot.calls if verb == "play"]
        assert moves == ["bow", "bow", "wave"]

    in_room(tmp_path, scenario, guided(tmp_path, PLAIN, effects))


def test_states_that_chase_each_other_are_left_in_peace(tmp_path: Path) -> None:
    flip = together(call("toggle", "engagement", sign="presence"))
    effects = {**effect("PersonDetected", flip), **effect("Wait", flip)}

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("toggle", sign="presence")
        await asyncio.sleep(10)
        assert 10 < len(rig.path) <= 40
        assert [text for text in rig.notices if "change in a loop" in text]

    in_room(tmp_path, scenario, guided(tmp_path, PLAIN, effects))
