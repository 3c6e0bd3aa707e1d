"""While the stop is pressed the model learns everything and does nothing."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from tests.session.engagement_rig import PLAIN, EngagementRig, GuideDriver, effect, guided, in_room
from tests.session.rig import call, together
from woz_tui.config.engagement import (
    AttentionSettings,
    EngagementSettings,
    HandshakeSettings,
    Timeouts,
)
from woz_tui.drivers.contract import Health, Job
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json

pytestmark = pytest.mark.safety

EVERYTHING = EngagementSettings(
    handshake=HandshakeSettings(by="robot", seconds=60.0, silence=2.0),
    attention=AttentionSettings(look=True, seconds=2.0),
)


async def no_state_by_itself(rig: EngagementRig) -> None:
    for state in ("RobotThinks", "PersonDetected", "RobotReplies"):
        rig.tell("force", to=state)
        await asyncio.sleep(1)


async def nobody_nearly_there(rig: EngagementRig) -> None:
    rig.tell("sense", sign="presence", value="on")
    rig.tell("sense", sign="gaze", value="on")
    rig.tell("sense", sign="distance", value="4")
    await asyncio.sleep(1)
    assert rig.engagement_shown.state == "PersonDetected"


async def no_cable(rig: EngagementRig) -> None:
    rig.robot.context.health(Health.LOST, "the cable")
    rig.robot.context.health(Health.CONNECTED, "a puppet")
    await asyncio.sleep(1)


async def no_sound(rig: EngagementRig) -> None:
    rig.stands_there()
    await asyncio.sleep(0.1)
    rig.sense(loudness=0.01, direction=0.0)
    rig.sense(loudness=0.5)
    rig.sense(direction=50.0)
    await asyncio.sleep(5)


async def no_stranger(rig: EngagementRig) -> None:
    rig.tell("handshake", what="begin")
    await asyncio.sleep(20)
    assert rig.path[-1] == "Handshake"


@pytest.mark.parametrize(
    "scene", [no_state_by_itself, nobody_nearly_there, no_cable, no_sound, no_stranger]
)
def test_nothing_makes_the_model_ask_for_anything(
    tmp_path: Path, scene: Callable[[EngagementRig], Awaitable[None]]
) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await asyncio.sleep(1)
        rig.session.stop("key")
        before = len(rig.commands)
        await scene(rig)
        assert rig.commands[before:] == []

    effects = effect("RobotThinks", together(call("say", text="Well")))
    in_room(tmp_path, scenario, guided(tmp_path, EVERYTHING, effects))


def test_a_question_that_was_stopped_is_not_asked_again_by_itself(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        rig.tell("handshake", what="begin")
        await asyncio.sleep(0.5)
        assert ("say", {"text": EVERYTHING.handshake.ask}) in rig.commands
        rig.session.stop("key")
        before = len(rig.commands)
        await asyncio.sleep(20)
        assert rig.commands[before:] == []
        assert rig.engagement_shown.state == "Handshake"
        rig.session.release("key")
        await asyncio.sleep(0.5)
        asked = [args["text"] for verb, args in rig.commands[before:] if verb == "say"]
        assert asked == [EVERYTHING.handshake.ask]

    in_room(tmp_path, scenario, guided(tmp_path, EVERYTHING))


def test_what_the_robot_says_itself_is_no_answer_however_late_it_is_understood(
    tmp_path: Path,
) -> None:
    async def scenario(rig: EngagementRig) -> None:
        rig.tell("handshake", what="begin")
        await asyncio.sleep(0.3)  # it speaks for a second
        await rig.hears(1, 1.0)
        rig.session.hub.publish(m.SpeechText(driver="robot", segment=1, text="my name is Ada"))
        await asyncio.sleep(1)
        said = [args["text"] for verb, args in rig.commands if verb == "say"]
        assert said == [EVERYTHING.handshake.ask]

    in_room(tmp_path, scenario, guided(tmp_path, EVERYTHING))


def test_looking_away_goes_on_over_a_reload(tmp_path: Path) -> None:
    settings = replace(PLAIN, attention=AttentionSettings(look=True, seconds=2.0))

    async def scenario(rig: EngagementRig) -> None:
        await no_sound_yet(rig)
        rig.session.adopt(guided(tmp_path, replace(settings, samples=3)), ["samples"])
        await asyncio.sleep(4)

    async def no_sound_yet(rig: EngagementRig) -> None:
        rig.stands_there()
        rig.sense(loudness=0.01, direction=0.0)
        await asyncio.sleep(0.5)
        rig.sense(loudness=0.5)
        rig.sense(direction=50.0)
        await asyncio.sleep(0.5)

    rig = in_room(tmp_path, scenario, guided(tmp_path, settings))
    assert [args["yaw"] for verb, args in rig.commands if verb == "gaze"] == [50.0, 0.0]


def test_a_mode_by_hand_outlasts_other_numbers_of_attention(tmp_path: Path) -> None:
    settings = replace(PLAIN, attention=AttentionSettings(look=True, seconds=2.0))
    other = replace(PLAIN, attention=AttentionSettings(look=True, seconds=1.0))

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("attend", mode="FullyEngaged")
        rig.stands_there()
        await asyncio.sleep(0.1)
        rig.session.adopt(guided(tmp_path, other), ["seconds"])
        rig.sense(loudness=0.5)
        rig.sense(direction=50.0)
        await asyncio.sleep(5)

    rig = in_room(tmp_path, scenario, guided(tmp_path, settings))
    assert [verb for verb, _ in rig.commands] == []


def test_an_effect_that_fails_when_nobody_has_said_anything_is_told(tmp_path: Path) -> None:
    """A time limit has brought the state: the run is over before it is known."""
    effects = effect("Wait", together(call("say", text="Bye {visitor}")))
    settings = replace(PLAIN, timeouts=Timeouts(approach=2.0))

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("sense", sign="presence", value="on")
        await asyncio.sleep(3)
        assert [text for text in rig.notices if "on Wait" in text]

    in_room(tmp_path, scenario, guided(tmp_path, settings, effects))


def test_nothing_is_published_while_nothing_changes(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await rig.visit(8, gaze=0)
        before = len(rig.of(m.EngagementShown))
        await rig.visit(60, gaze=0)
        assert len(rig.of(m.EngagementShown)) == before

    in_room(tmp_path, scenario)


class SlowBeepDriver(GuideDriver):
    """Its beep takes a while."""

    async def perform(self, job: Job) -> Mapping[str, Json]:
        if job.verb == "sound":
            await asyncio.sleep(2.0)
        return await super().perform(job)


def test_a_beep_that_finds_the_robot_busy_is_left_out_without_a_word(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        for state in ("RobotThinks", "RobotReplies", "RobotThinks"):
            rig.tell("force", to=state)
            await asyncio.sleep(0.3)
        assert [end.code for end in rig.of(m.Refused)] == ["busy"]
        assert rig.notices == []

    experiment = guided(tmp_path, EngagementSettings())
    rig = in_room(tmp_path, scenario, experiment, kind=SlowBeepDriver, linger=5)
    assert [verb for verb, _ in rig.robot.calls].count("sound") == 1
