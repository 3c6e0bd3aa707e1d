"""While the stop is pressed the model learns everything and does nothing."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from tests.fakes.virtual_time import run_virtual
from tests.session.engaged import PLAIN, Guide, Room, effect, guided, in_room
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


async def no_state_by_itself(room: Room) -> None:
    for state in ("RobotThinks", "PersonDetected", "RobotReplies"):
        room.tell("force", to=state)
        await asyncio.sleep(1)


async def nobody_nearly_there(room: Room) -> None:
    room.tell("sense", sign="presence", value="on")
    room.tell("sense", sign="gaze", value="on")
    room.tell("sense", sign="distance", value="4")
    await asyncio.sleep(1)
    assert room.shown.state == "PersonDetected"


async def no_cable(room: Room) -> None:
    room.robot.context.health(Health.LOST, "the cable")
    room.robot.context.health(Health.CONNECTED, "a puppet")
    await asyncio.sleep(1)


async def no_sound(room: Room) -> None:
    room.stands_there()
    await asyncio.sleep(0.1)
    room.sense(loudness=0.01, direction=0.0)
    room.sense(loudness=0.5)
    room.sense(direction=50.0)
    await asyncio.sleep(5)


async def no_stranger(room: Room) -> None:
    room.tell("handshake", what="begin")
    await asyncio.sleep(20)
    assert room.path[-1] == "Handshake"


@pytest.mark.parametrize(
    "scene", [no_state_by_itself, nobody_nearly_there, no_cable, no_sound, no_stranger]
)
def test_nothing_makes_the_model_ask_for_anything(
    tmp_path: Path, scene: Callable[[Room], Awaitable[None]]
) -> None:
    async def scenario(room: Room) -> None:
        await asyncio.sleep(1)
        room.session.stop("key")
        before = len(room.commands)
        await scene(room)
        assert room.commands[before:] == []

    effects = effect("RobotThinks", together(call("say", text="Well")))
    in_room(tmp_path, scenario, guided(tmp_path, EVERYTHING, effects))


def test_a_question_that_was_stopped_is_not_asked_again_by_itself(tmp_path: Path) -> None:
    async def scenario(room: Room) -> None:
        room.tell("handshake", what="begin")
        await asyncio.sleep(0.5)
        assert ("say", {"text": EVERYTHING.handshake.ask}) in room.commands
        room.session.stop("key")
        before = len(room.commands)
        await asyncio.sleep(20)
        assert room.commands[before:] == []
        assert room.shown.state == "Handshake"
        room.session.release("key")
        await asyncio.sleep(0.5)
        asked = [args["text"] for verb, args in room.commands[before:] if verb == "say"]
        assert asked == [EVERYTHING.handshake.ask]

    in_room(tmp_path, scenario, guided(tmp_path, EVERYTHING))


def test_what_the_robot_says_itself_is_no_answer_however_late_it_is_understood(
    tmp_path: Path,
) -> None:
    async def scenario(room: Room) -> None:
        room.tell("handshake", what="begin")
        await asyncio.sleep(0.3)  # it speaks for a second
        await room.hears(1, 1.0)
        room.session.hub.publish(m.SpeechText(driver="robot", segment=1, text="my name is Ada"))
        await asyncio.sleep(1)
        said = [args["text"] for verb, args in room.commands if verb == "say"]
        assert said == [EVERYTHING.handshake.ask]

    in_room(tmp_path, scenario, guided(tmp_path, EVERYTHING))


def test_looking_away_goes_on_over_a_reload(tmp_path: Path) -> None:
    settings = replace(PLAIN, attention=AttentionSettings(look=True, seconds=2.0))

    async def scenario(room: Room) -> None:
        await no_sound_yet(room)
        room.session.adopt(guided(tmp_path, replace(settings, samples=3)), ["samples"])
        await asyncio.sleep(4)

    async def no_sound_yet(room: Room) -> None:
        room.stands_there()
        room.sense(loudness=0.01, direction=0.0)
        await asyncio.sleep(0.5)
        room.sense(loudness=0.5)
        room.sense(direction=50.0)
        await asyncio.sleep(0.5)

    room = in_room(tmp_path, scenario, guided(tmp_path, settings))
    assert [args["yaw"] for verb, args in room.commands if verb == "gaze"] == [50.0, 0.0]


def test_a_mode_by_hand_outlasts_other_numbers_of_attention(tmp_path: Path) -> None:
    settings = replace(PLAIN, attention=AttentionSettings(look=True, seconds=2.0))
    other = replace(PLAIN, attention=AttentionSettings(look=True, seconds=1.0))

    async def scenario(room: Room) -> None:
        room.tell("attend", mode="FullyEngaged")
        room.stands_there()
        await asyncio.sleep(0.1)
        room.session.adopt(guided(tmp_path, other), ["seconds"])
        room.sense(loudness=0.5)
        room.sense(direction=50.0)
        await asyncio.sleep(5)

    room = in_room(tmp_path, scenario, guided(tmp_path, settings))
    assert [verb for verb, _ in room.commands] == []


def test_an_effect_that_fails_when_nobody_has_said_anything_is_told(tmp_path: Path) -> None:
    """A time limit has brought the state: the run is over before it is known."""
    effects = effect("Wait", together(call("say", text="Bye {visitor}")))
    settings = replace(PLAIN, timeouts=Timeouts(approach=2.0))

    async def scenario(room: Room) -> None:
        room.tell("sense", sign="presence", value="on")
        await asyncio.sleep(3)
        assert [text for text in room.notices if "on Wait" in text]

    in_room(tmp_path, scenario, guided(tmp_path, settings, effects))


def test_nothing_is_published_while_nothing_changes(tmp_path: Path) -> None:
    async def scenario(room: Room) -> None:
        await room.visit(8, gaze=0)
        before = len(room.of(m.EngagementShown))
        await room.visit(60, gaze=0)
        assert len(room.of(m.EngagementShown)) == before

    in_room(tmp_path, scenario)


class Ringing(Guide):
    """Its beep takes a while."""

    async def perform(self, job: Job) -> Mapping[str, Json]:
        if job.verb == "sound":
            await asyncio.sleep(2.0)
        return await super().perform(job)


def test_a_beep_that_finds_the_robot_busy_is_left_out_without_a_word(tmp_path: Path) -> None:
    async def go() -> Room:
        room = Room(tmp_path, guided(tmp_path, EngagementSettings()), Ringing)
        await room.session.open()
        for state in ("RobotThinks", "RobotReplies", "RobotThinks"):
            room.tell("force", to=state)
            await asyncio.sleep(0.3)
        assert [end.code for end in room.of(m.Refused)] == ["busy"]
        assert room.notices == []
        await asyncio.sleep(5)
        await room.session.close("test")
        return room

    room = run_virtual(go())
    assert [verb for verb, _ in room.robot.calls].count("sound") == 1
