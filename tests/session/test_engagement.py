"""The model in a session: what it hears, what it says, what the wizard tells it."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from tests.session.engaged import PLAIN, WIZARD, Guide, Room, guided, in_room
from woz_tui.config.engagement import (
    EngagementSettings,
    SignSettings,
    Timeouts,
)
from woz_tui.drivers.contract import Ask
from woz_tui.protocol import messages as m
from woz_tui.sensing.engagement_stream import EngagementFollower
from woz_tui.session.participant_identity import RequestError

KNOWN_STATE = "EngagedWithKnown"


async def engaged(room: Room) -> None:
    """A known visitor stands before the robot."""
    await room.visit(4, identity="V1")


async def keeps_looking(room: Room, seconds: float) -> None:
    await room.visit(seconds, identity="V1")


def test_a_visitor_is_seen_engages_and_leaves_again(tmp_path: Path) -> None:
    """E5: transitions with outcome and the four verdicts are in the log."""

    async def scenario(room: Room) -> None:
        await engaged(room)
        await room.visit(4, presence=0, gaze=0, distance=4.0)

    room = in_room(tmp_path, scenario)
    assert room.path == ["PersonDetected", KNOWN_STATE, "PersonDetected", "Wait"]
    assert room.outcomes == ["human_presence", "recognized", "error", "human_absence"]
    first, second, *_ = room.of(m.EngagementChanged)
    assert first.verdicts["presence"] == 1
    assert second.verdicts == {"presence": 1, "gaze": 1, "distance": 1, "identity": "V1"}
    assert second.visitor == "V1"
    assert second.why
    assert not second.forced


def test_without_the_section_nothing_is_said_and_its_verbs_are_unknown(tmp_path: Path) -> None:
    async def scenario(room: Room) -> None:
        await engaged(room)
        with pytest.raises(RequestError, match="no driver offers 'toggle'"):
            room.tell("toggle", sign="gaze")

    room = in_room(tmp_path, scenario, replace(guided(tmp_path), engagement=None))
    assert room.of(m.EngagementChanged) == []
    assert room.of(m.EngagementShown) == []


def test_while_it_is_off_the_signs_are_shown_and_no_state(tmp_path: Path) -> None:
    async def scenario(room: Room) -> None:
        await engaged(room)
        room.tell("sense", sign="gaze", value="off")
        await asyncio.sleep(0.5)
        seen = room.of(m.EngagementShown)
        assert {look.run for look in seen} == {"off"}
        assert [seen[0].signs["presence"].verdict, seen[-1].signs["presence"].verdict] == [0, 1]
        assert seen[-1].signs["gaze"].forced
        assert not room.of(m.EngagementChanged)
        room.tell("sense", sign="gaze", value="sensor")
        room.tell("engagement", run="run")
        await keeps_looking(room, 1)

    room = in_room(tmp_path, scenario, guided(tmp_path, replace(PLAIN, start="off")))
    assert room.path[:2] == ["PersonDetected", KNOWN_STATE]


def test_the_look_is_published_now_and_then_and_at_once_after_a_change(tmp_path: Path) -> None:
    async def scenario(room: Room) -> None:
        for index in range(1000):
            room.sense(presence=1, gaze=1, distance=0.8 + index / 2000)
            await asyncio.sleep(0.01)

    room = in_room(tmp_path, scenario)
    looks = room.of(m.EngagementShown)
    changes = room.of(m.EngagementChanged)
    assert len(looks) <= 10 * 5 + 5 + len(changes)
    assert looks[0].state == "Wait"
    for change in changes:
        after = next(line for line in looks if line.seq > change.seq)
        assert after.t - change.t < 1000
    assert looks[-1].signs["presence"].verdict == 0


def test_the_wizard_gives_what_no_camera_sees(tmp_path: Path) -> None:
    """E7: verdicts by hand, marked as such; the first press is the opposite of the verdict."""

    async def scenario(room: Room) -> None:
        room.tell("toggle", sign="presence")
        await asyncio.sleep(0.1)
        room.tell("sense", sign="identity", value="V9")
        room.tell("toggle", sign="gaze")
        room.tell("sense", sign="distance", value="0.7")
        await asyncio.sleep(60)
        assert room.shown.state == KNOWN_STATE
        room.tell("toggle", sign="gaze")
        await asyncio.sleep(0.1)

    room = in_room(tmp_path, scenario)
    assert room.path[:3] == ["PersonDetected", KNOWN_STATE, "PersonDetected"]
    assert all(change.forced for change in room.of(m.EngagementChanged))
    said = [line.sent for line in room.of(m.Done) if line.driver == "engagement"]
    assert said[0] == {"sign": "presence", "value": "on"}
    assert said[-1] == {"sign": "gaze", "value": "off"}
    assert room.shown.signs["gaze"].forced


def test_every_edge_can_be_forced_and_what_makes_no_sense_is_refused(tmp_path: Path) -> None:
    """E7: a state or an outcome, by hand."""

    async def scenario(room: Room) -> None:
        for to in ("PersonDetected", "recognized", "listening", "done", "done", "done"):
            room.tell("force", to=to)
            await asyncio.sleep(0.2)
        room.tell("force", to="handshake")

    room = in_room(tmp_path, scenario)
    assert room.path == [
        *("PersonDetected", KNOWN_STATE, "UserSpeaks"),
        *("RobotThinks", "RobotReplies", KNOWN_STATE),
    ]
    assert all(change.forced for change in room.of(m.EngagementChanged))
    (refused,) = room.of(m.Refused)
    assert refused.code == "args"
    assert "does not lead out of EngagedWithKnown" in refused.reason


def test_a_conversation_by_the_wizard(tmp_path: Path) -> None:
    """E5: the visitor speaks, the wizard answers, then begins by themselves."""

    async def scenario(room: Room) -> None:
        room.stands_there()
        await asyncio.sleep(0.5)
        await room.hears(1, 2.0)
        await asyncio.sleep(3)
        assert room.shown.waits_since == room.of(m.SpeechEnded)[0].t
        room.tell("say", text="It is from Rome.")
        await asyncio.sleep(2)
        assert room.shown.waits_since == -1
        room.tell("say", text="Shall we go on?")

    room = in_room(tmp_path, scenario)
    assert room.path[1:] == [
        *(KNOWN_STATE, "UserSpeaks", "RobotThinks", "RobotReplies", KNOWN_STATE),
        *("RobotSpeaks", KNOWN_STATE),
    ]
    assert room.outcomes[2:] == ["listening", "done", "done", "done", "speaking", "done"]


def test_an_answer_within_the_hang_over_is_the_answer(tmp_path: Path) -> None:
    async def scenario(room: Room) -> None:
        room.stands_there()
        await asyncio.sleep(0.5)
        speech = asyncio.ensure_future(room.hears(1, 2.0))
        await asyncio.sleep(1.5)
        room.tell("say", text="Yes.")
        await speech
        await asyncio.sleep(2)

    room = in_room(tmp_path, scenario)
    assert room.path[-4:] == ["UserSpeaks", "RobotThinks", "RobotReplies", KNOWN_STATE]


def test_a_say_that_replaces_another_is_one_reply(tmp_path: Path) -> None:
    async def scenario(room: Room) -> None:
        room.stands_there()
        await asyncio.sleep(0.5)
        await room.hears(1)
        room.tell("say", text="From Rome")
        await asyncio.sleep(0.3)
        room.session.send("say", {"text": "From Naples!"}, "", WIZARD, when_busy="replace")

    room = in_room(tmp_path, scenario)
    assert room.path[-3:] == ["RobotThinks", "RobotReplies", KNOWN_STATE]
    reply, after = (change.t for change in room.of(m.EngagementChanged)[-2:])
    assert after - reply > 1_200_000


def test_a_stopped_reply_is_over_and_the_model_is_told_things_while_stopped(
    tmp_path: Path,
) -> None:
    """E7: overriding works at any time; nothing else does while the stop is pressed."""

    async def scenario(room: Room) -> None:
        room.stands_there()
        await asyncio.sleep(0.5)
        await room.hears(1)
        room.tell("say", text="From Rome")
        await asyncio.sleep(0.3)
        room.session.stop("key")
        await asyncio.sleep(0.3)
        assert room.shown.state == KNOWN_STATE
        room.session.play("Looks", WIZARD)
        with pytest.raises(RequestError, match="the stop is pressed"):
            room.session.play("Welcome", WIZARD)
        await asyncio.sleep(0.3)
        assert room.shown.state == "PersonDetected"

    in_room(tmp_path, scenario)


def test_held_it_moves_by_hand_only(tmp_path: Path) -> None:
    async def scenario(room: Room) -> None:
        room.tell("engagement", run="hold")
        await engaged(room)
        assert room.path == []
        assert room.shown.next == "PersonDetected"
        room.tell("engagement", run="step")
        await keeps_looking(room, 1)
        assert room.path == ["PersonDetected"]
        room.tell("engagement", run="run")
        await keeps_looking(room, 1)

    room = in_room(tmp_path, scenario)
    assert room.path[:2] == ["PersonDetected", KNOWN_STATE]


def test_filters_and_distance_while_running(tmp_path: Path) -> None:
    """E2: n and t_r of each sign are set while running."""

    async def scenario(room: Room) -> None:
        room.tell("filter", sign="presence", samples=1, threshold=1.0)
        room.tell("social_distance", metres=2.5)
        await asyncio.sleep(0.1)
        room.sense(presence=1)
        await asyncio.sleep(0.3)
        assert room.path == ["PersonDetected"]
        assert room.shown.signs["presence"].places == 1
        assert room.shown.social_distance == 2.5
        room.tell("filter", sign="gaze", kind="median")
        await asyncio.sleep(0.3)

    room = in_room(tmp_path, scenario)
    (refused,) = room.of(m.Refused)
    assert "median is for distance" in refused.reason


def test_a_timeout_comes_without_any_message(tmp_path: Path) -> None:
    """Nobody says anything any more: the deadline itself moves the machine, at its moment."""
    settings = replace(PLAIN, timeouts=Timeouts(talking=5.0))

    async def scenario(room: Room) -> None:
        room.tell("force", to="RobotReplies")

    room = in_room(tmp_path, scenario, guided(tmp_path, settings), linger=8)
    entered, left = room.of(m.EngagementChanged)[:2]
    assert left.outcome == "error"
    assert left.t - entered.t == pytest.approx(5_000_000, abs=5000)


def test_the_absence_of_the_visitor_ends_the_state_and_not_the_sentence(tmp_path: Path) -> None:
    """And the log gives the same transitions once more, with the setting and without it."""
    settings = replace(PLAIN, timeouts=Timeouts(absent=5.0))

    async def scenario(room: Room) -> None:
        await engaged(room)
        await room.hears(1)
        await room.visit(4, presence=0, gaze=0, distance=4.0)
        said = room.tell("say", text="Behind you.")
        await room.visit(0.4, presence=0, gaze=0, distance=4.0)
        assert room.path[-1] == "RobotReplies"
        await room.visit(3, presence=0, gaze=0, distance=4.0)
        (end,) = [line for line in room.of(m.Done) if line.command == said]
        gone = room.of(m.EngagementChanged)[-1]
        assert (gone.was, gone.now, gone.outcome) == ("RobotReplies", "Wait", "human_absence")
        assert gone.t < end.t, "the sentence went on"

    room = in_room(tmp_path, scenario, guided(tmp_path, settings))
    follower = EngagementFollower(PLAIN)
    again = [change for line in room.lines for change in follower.apply(line)]
    assert [change.now for change in again] == room.path
    changes = room.of(m.EngagementChanged)
    assert [change.t for change in again] == pytest.approx([line.t for line in changes], abs=5000)
    before = EngagementFollower(PLAIN)
    old = [_without_absent(line) for line in room.lines]
    found = [change.now for line in old for change in before.apply(line)]
    assert found[-3:] == [KNOWN_STATE, "PersonDetected", "Wait"], "after the answer, as before"


def _without_absent(line: m.AnyMessage) -> m.AnyMessage:
    """The settings as a log has them that was written before there was this one."""
    if not isinstance(line, m.EngagementAdopted):
        return line
    limits = line.settings["timeouts"]
    assert isinstance(limits, dict)
    kept = {name: value for name, value in limits.items() if name != "absent"}
    return msgspec.structs.replace(line, settings={**line.settings, "timeouts": kept})


def test_another_participant_begins_anew(tmp_path: Path) -> None:
    async def scenario(room: Room) -> None:
        room.tell("sense", sign="all", value="on")
        room.tell("visitor", code="Anna")
        await asyncio.sleep(0.5)
        room.session.set(trial=2)
        await asyncio.sleep(0.5)
        assert room.shown.state == KNOWN_STATE
        room.session.set(participant="P08")
        await asyncio.sleep(0.5)

    room = in_room(tmp_path, scenario)
    assert room.path[-1] == "Wait"
    assert room.shown.visitor == ""
    assert not room.shown.signs["gaze"].forced


def test_a_reload_keeps_the_state_and_takes_the_new_numbers(tmp_path: Path) -> None:
    async def scenario(room: Room) -> None:
        await engaged(room)
        other = replace(PLAIN, social_distance=2.0, gaze=SignSettings(samples=3))
        room.session.adopt(guided(tmp_path, other), ["engagement changed"])
        await keeps_looking(room, 1)
        assert room.shown.state == KNOWN_STATE
        assert room.shown.social_distance == 2.0
        assert room.shown.signs["gaze"].places == 3
        bare = replace(guided(tmp_path), engagement=None)
        room.session.adopt(bare, ["engagement is gone"])
        with pytest.raises(RequestError):
            room.tell("toggle", sign="gaze")
        room.session.adopt(guided(tmp_path), ["engagement is new"])
        await engaged(room)
        room.tell("toggle", sign="gaze")
        await asyncio.sleep(0.2)
        assert room.shown.signs["gaze"].forced

    in_room(tmp_path, scenario)


def test_signs_of_other_robots_are_not_ours(tmp_path: Path) -> None:
    settings = EngagementSettings(signals="none", presence=SignSettings(sensor="left.presence"))

    async def scenario(room: Room) -> None:
        await engaged(room)
        assert room.path == []
        for _ in range(8):
            room.session.hub.publish(m.reading("left.presence", 1))
            await asyncio.sleep(0.3)

    room = in_room(tmp_path, scenario, guided(tmp_path, settings))
    assert room.path[0] == "PersonDetected"


def test_loudness_is_end_pointed_where_no_driver_does_it(tmp_path: Path) -> None:
    async def scenario(room: Room) -> None:
        room.stands_there()
        room.sense(**{"loudness.threshold": 0.05})
        for index in range(40):
            room.sense(loudness=0.2 if 5 <= index < 15 else 0.01)
            await asyncio.sleep(0.1)

    room = in_room(tmp_path, scenario)
    assert room.path[-2:] == ["UserSpeaks", "RobotThinks"]
    spoke, thinks = (change.t for change in room.of(m.EngagementChanged)[-2:])
    assert thinks - spoke == pytest.approx(2_000_000, abs=150_000)


def test_a_visitor_greeted_by_name(tmp_path: Path) -> None:
    async def scenario(room: Room) -> None:
        with pytest.raises(RequestError, match=r"\{visitor\} has no value yet") as refused:
            room.session.play("Greet", WIZARD)
        assert "enter who the visitor is" in refused.value.hint
        await engaged(room)
        room.session.play("Greet", WIZARD)

    room = in_room(tmp_path, scenario)
    assert ("say", {"text": "Hello V1"}) in room.robot.calls


def test_a_panel_of_one_of_two_robots_may_tell_the_model(tmp_path: Path) -> None:
    one = guided(tmp_path)
    (spec,) = one.drivers
    two = replace(
        one, drivers=(replace(spec, name="left.robot"), replace(spec, name="right.robot"))
    )

    async def scenario(room: Room) -> None:
        driver = room.session.drivers["left.robot"]
        assert isinstance(driver, Guide)
        driver.context.ask(Ask("verb", "toggle", {"sign": "presence"}, source="midi"))
        await asyncio.sleep(0.5)

    room = in_room(tmp_path, scenario, two)
    assert room.path == ["PersonDetected"]
