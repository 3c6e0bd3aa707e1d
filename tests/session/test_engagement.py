"""The model in a session: what it hears, what it says, what the wizard tells it."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from tests.session.engagement_rig import PLAIN, WIZARD, EngagementRig, GuideDriver, guided, in_room
from woz_tui.config.engagement import (
    EngagementSettings,
    SignSettings,
    Timeouts,
)
from woz_tui.drivers.contract import Ask
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.sensing.engagement_stream import EngagementFollower

KNOWN_STATE = "EngagedWithKnown"


async def engage_visitor(rig: EngagementRig) -> None:
    """A known visitor stands before the robot."""
    await rig.visit(4, identity="V1")


async def keeps_looking(rig: EngagementRig, seconds: float) -> None:
    await rig.visit(seconds, identity="V1")


def test_a_visitor_is_seen_engages_and_leaves_again(tmp_path: Path) -> None:
    """E5: transitions with outcome and the four verdicts are in the log."""

    async def scenario(rig: EngagementRig) -> None:
        await engage_visitor(rig)
        await rig.visit(4, presence=0, gaze=0, distance=4.0)

    rig = in_room(tmp_path, scenario)
    assert rig.path == ["PersonDetected", KNOWN_STATE, "PersonDetected", "Wait"]
    assert rig.outcomes == ["human_presence", "recognized", "error", "human_absence"]
    first, second, *_ = rig.of(m.EngagementChanged)
    assert first.verdicts["presence"] == 1
    assert second.verdicts == {"presence": 1, "gaze": 1, "distance": 1, "identity": "V1"}
    assert second.visitor == "V1"
    assert second.why
    assert not second.forced


def test_without_the_section_nothing_is_said_and_its_verbs_are_unknown(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await engage_visitor(rig)
        with pytest.raises(RequestError, match="no driver offers 'toggle'"):
            rig.tell("toggle", sign="gaze")

    rig = in_room(tmp_path, scenario, replace(guided(tmp_path), engagement=None))
    assert rig.of(m.EngagementChanged) == []
    assert rig.of(m.EngagementShown) == []


def test_while_it_is_off_the_signs_are_shown_and_no_state(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await engage_visitor(rig)
        rig.tell("sense", sign="gaze", value="off")
        await asyncio.sleep(0.5)
        seen = rig.of(m.EngagementShown)
        assert {look.run for look in seen} == {"off"}
        assert [seen[0].signs["presence"].verdict, seen[-1].signs["presence"].verdict] == [0, 1]
        assert seen[-1].signs["gaze"].forced
        assert not rig.of(m.EngagementChanged)
        rig.tell("sense", sign="gaze", value="sensor")
        rig.tell("engagement", run="run")
        await keeps_looking(rig, 1)

    rig = in_room(tmp_path, scenario, guided(tmp_path, replace(PLAIN, start="off")))
    assert rig.path[:2] == ["PersonDetected", KNOWN_STATE]


def test_the_look_is_published_now_and_then_and_at_once_after_a_change(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        for index in range(1000):
            rig.sense(presence=1, gaze=1, distance=0.8 + index / 2000)
            await asyncio.sleep(0.01)

    rig = in_room(tmp_path, scenario)
    looks = rig.of(m.EngagementShown)
    changes = rig.of(m.EngagementChanged)
    assert len(looks) <= 10 * 5 + 5 + len(changes)
    assert looks[0].state == "Wait"
    for change in changes:
        after = next(line for line in looks if line.seq > change.seq)
        assert after.t - change.t < 1000
    assert looks[-1].signs["presence"].verdict == 0


def test_the_wizard_gives_what_no_camera_sees(tmp_path: Path) -> None:
    """E7: verdicts by hand, marked as such; the first press is the opposite of the verdict."""

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("toggle", sign="presence")
        await asyncio.sleep(0.1)
        rig.tell("sense", sign="identity", value="V9")
        rig.tell("toggle", sign="gaze")
        rig.tell("sense", sign="distance", value="0.7")
        await asyncio.sleep(60)
        assert rig.engagement_shown.state == KNOWN_STATE
        rig.tell("toggle", sign="gaze")
        await asyncio.sleep(0.1)

    rig = in_room(tmp_path, scenario)
    assert rig.path[:3] == ["PersonDetected", KNOWN_STATE, "PersonDetected"]
    assert all(change.forced for change in rig.of(m.EngagementChanged))
    said = [line.sent for line in rig.of(m.Done) if line.driver == "engagement"]
    assert said[0] == {"sign": "presence", "value": "on"}
    assert said[-1] == {"sign": "gaze", "value": "off"}
    assert rig.engagement_shown.signs["gaze"].forced


def test_every_edge_can_be_forced_and_what_makes_no_sense_is_refused(tmp_path: Path) -> None:
    """E7: a state or an outcome, by hand."""

    async def scenario(rig: EngagementRig) -> None:
        for to in ("PersonDetected", "recognized", "listening", "done", "done", "done"):
            rig.tell("force", to=to)
            await asyncio.sleep(0.2)
        rig.tell("force", to="handshake")

    rig = in_room(tmp_path, scenario)
    assert rig.path == [
        *("PersonDetected", KNOWN_STATE, "UserSpeaks"),
        *("RobotThinks", "RobotReplies", KNOWN_STATE),
    ]
    assert all(change.forced for change in rig.of(m.EngagementChanged))
    (refused,) = rig.of(m.Refused)
    assert refused.code == "args"
    assert "does not lead out of EngagedWithKnown" in refused.reason


def test_a_conversation_by_the_wizard(tmp_path: Path) -> None:
    """E5: the visitor speaks, the wizard answers, then begins by themselves."""

    async def scenario(rig: EngagementRig) -> None:
        rig.stands_there()
        await asyncio.sleep(0.5)
        await rig.hears(1, 2.0)
        await asyncio.sleep(3)
        assert rig.engagement_shown.waits_since == rig.of(m.SpeechEnded)[0].t
        rig.tell("say", text="It is from Rome.")
        await asyncio.sleep(2)
        assert rig.engagement_shown.waits_since == -1
        rig.tell("say", text="Shall we go on?")

    rig = in_room(tmp_path, scenario)
    assert rig.path[1:] == [
        *(KNOWN_STATE, "UserSpeaks", "RobotThinks", "RobotReplies", KNOWN_STATE),
        *("RobotSpeaks", KNOWN_STATE),
    ]
    assert rig.outcomes[2:] == ["listening", "done", "done", "done", "speaking", "done"]


def test_an_answer_within_the_hang_over_is_the_answer(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        rig.stands_there()
        await asyncio.sleep(0.5)
        speech = asyncio.ensure_future(rig.hears(1, 2.0))
        await asyncio.sleep(1.5)
        rig.tell("say", text="Yes.")
        await speech
        await asyncio.sleep(2)

    rig = in_room(tmp_path, scenario)
    assert rig.path[-4:] == ["UserSpeaks", "RobotThinks", "RobotReplies", KNOWN_STATE]


def test_a_say_that_replaces_another_is_one_reply(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        rig.stands_there()
        await asyncio.sleep(0.5)
        await rig.hears(1)
        rig.tell("say", text="From Rome")
        await asyncio.sleep(0.3)
        rig.session.send("say", {"text": "From Naples!"}, "", WIZARD, when_busy="replace")

    rig = in_room(tmp_path, scenario)
    assert rig.path[-3:] == ["RobotThinks", "RobotReplies", KNOWN_STATE]
    reply, after = (change.t for change in rig.of(m.EngagementChanged)[-2:])
    assert after - reply > 1_200_000


def test_a_stopped_reply_is_over_and_the_model_is_told_things_while_stopped(
    tmp_path: Path,
) -> None:
    """E7: overriding works at any time; nothing else does while the stop is pressed."""

    async def scenario(rig: EngagementRig) -> None:
        rig.stands_there()
        await asyncio.sleep(0.5)
        await rig.hears(1)
        rig.tell("say", text="From Rome")
        await asyncio.sleep(0.3)
        rig.session.stop("key")
        await asyncio.sleep(0.3)
        assert rig.engagement_shown.state == KNOWN_STATE
        rig.session.play("Looks", WIZARD)
        with pytest.raises(RequestError, match="the stop is pressed"):
            rig.session.play("Welcome", WIZARD)
        await asyncio.sleep(0.3)
        assert rig.engagement_shown.state == "PersonDetected"

    in_room(tmp_path, scenario)


def test_held_it_moves_by_hand_only(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        rig.tell("engagement", run="hold")
        await engage_visitor(rig)
        assert rig.path == []
        assert rig.engagement_shown.next == "PersonDetected"
        rig.tell("engagement", run="step")
        await keeps_looking(rig, 1)
        assert rig.path == ["PersonDetected"]
        rig.tell("engagement", run="run")
        await keeps_looking(rig, 1)

    rig = in_room(tmp_path, scenario)
    assert rig.path[:2] == ["PersonDetected", KNOWN_STATE]


def test_filters_and_distance_while_running(tmp_path: Path) -> None:
    """E2: n and t_r of each sign are set while running."""

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("filter", sign="presence", samples=1, threshold=1.0)
        rig.tell("social_distance", metres=2.5)
        await asyncio.sleep(0.1)
        rig.sense(presence=1)
        await asyncio.sleep(0.3)
        assert rig.path == ["PersonDetected"]
        assert rig.engagement_shown.signs["presence"].places == 1
        assert rig.engagement_shown.social_distance == 2.5
        rig.tell("filter", sign="gaze", kind="median")
        await asyncio.sleep(0.3)

    rig = in_room(tmp_path, scenario)
    (refused,) = rig.of(m.Refused)
    assert "median is for distance" in refused.reason


def test_a_timeout_comes_without_any_message(tmp_path: Path) -> None:
    """Nobody says anything any more: the deadline itself moves the machine, at its moment."""
    settings = replace(PLAIN, timeouts=Timeouts(talking=5.0))

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("force", to="RobotReplies")

    rig = in_room(tmp_path, scenario, guided(tmp_path, settings), linger=8)
    entered, left = rig.of(m.EngagementChanged)[:2]
    assert left.outcome == "error"
    assert left.t - entered.t == pytest.approx(5_000_000, abs=5000)


def test_the_absence_of_the_visitor_ends_the_state_and_not_the_sentence(tmp_path: Path) -> None:
    """And the log gives the same transitions once more, with the setting and without it."""
    settings = replace(PLAIN, timeouts=Timeouts(absent=5.0))

    async def scenario(rig: EngagementRig) -> None:
        await engage_visitor(rig)
        await rig.hears(1)
        await rig.visit(4, presence=0, gaze=0, distance=4.0)
        said = rig.tell("say", text="Behind you.")
        await rig.visit(0.4, presence=0, gaze=0, distance=4.0)
        assert rig.path[-1] == "RobotReplies"
        await rig.visit(3, presence=0, gaze=0, distance=4.0)
        (end,) = [line for line in rig.of(m.Done) if line.command == said]
        gone = rig.of(m.EngagementChanged)[-1]
        assert (gone.was, gone.now, gone.outcome) == ("RobotReplies", "Wait", "human_absence")
        assert gone.t < end.t, "the sentence went on"

    rig = in_room(tmp_path, scenario, guided(tmp_path, settings))
    follower = EngagementFollower(PLAIN)
    again = [change for line in rig.lines for change in follower.apply(line)]
    assert [change.now for change in again] == rig.path
    changes = rig.of(m.EngagementChanged)
    assert [change.t for change in again] == pytest.approx([line.t for line in changes], abs=5000)
    before = EngagementFollower(PLAIN)
    old = [_as_of_before(line) for line in rig.lines]
    found = [change.now for line in old for change in before.apply(line)]
    assert found[-3:] == [KNOWN_STATE, "PersonDetected", "Wait"], "after the answer, as before"


def _as_of_before(line: m.Message) -> m.Message:
    """The settings as a log has them that was written before any but the paper's ways out."""
    if not isinstance(line, m.EngagementAdopted):
        return line
    limits = line.settings["timeouts"]
    assert isinstance(limits, dict)
    kept = {name: value for name, value in limits.items() if name not in ("absent", "unengaged")}
    told = {name: value for name, value in line.settings.items() if name != "turns"}
    return msgspec.structs.replace(line, settings={**told, "timeouts": kept})


def test_another_participant_begins_anew(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        rig.tell("sense", sign="all", value="on")
        rig.tell("visitor", code="Anna")
        await asyncio.sleep(0.5)
        rig.session.set(trial=2)
        await asyncio.sleep(0.5)
        assert rig.engagement_shown.state == KNOWN_STATE
        rig.session.set(participant="P08")
        await asyncio.sleep(0.5)

    rig = in_room(tmp_path, scenario)
    assert rig.path[-1] == "Wait"
    assert rig.engagement_shown.visitor == ""
    assert not rig.engagement_shown.signs["gaze"].forced


def test_a_reload_keeps_the_state_and_takes_the_new_numbers(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await engage_visitor(rig)
        other = replace(PLAIN, social_distance=2.0, gaze=SignSettings(samples=3))
        rig.session.adopt(guided(tmp_path, other), ["engagement changed"])
        await keeps_looking(rig, 1)
        assert rig.engagement_shown.state == KNOWN_STATE
        assert rig.engagement_shown.social_distance == 2.0
        assert rig.engagement_shown.signs["gaze"].places == 3
        bare = replace(guided(tmp_path), engagement=None)
        rig.session.adopt(bare, ["engagement is gone"])
        with pytest.raises(RequestError):
            rig.tell("toggle", sign="gaze")
        rig.session.adopt(guided(tmp_path), ["engagement is new"])
        await engage_visitor(rig)
        rig.tell("toggle", sign="gaze")
        await asyncio.sleep(0.2)
        assert rig.engagement_shown.signs["gaze"].forced

    in_room(tmp_path, scenario)


def test_signs_of_other_robots_are_not_ours(tmp_path: Path) -> None:
    settings = EngagementSettings(signals="none", presence=SignSettings(sensor="left.presence"))

    async def scenario(rig: EngagementRig) -> None:
        await engage_visitor(rig)
        assert rig.path == []
        for _ in range(8):
            rig.session.hub.publish(m.reading("left.presence", 1))
            await asyncio.sleep(0.3)

    rig = in_room(tmp_path, scenario, guided(tmp_path, settings))
    assert rig.path[0] == "PersonDetected"


def test_loudness_is_end_pointed_where_no_driver_does_it(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        rig.stands_there()
        rig.sense(**{"loudness.threshold": 0.05})
        for index in range(40):
            rig.sense(loudness=0.2 if 5 <= index < 15 else 0.01)
            await asyncio.sleep(0.1)

    rig = in_room(tmp_path, scenario)
    assert rig.path[-2:] == ["UserSpeaks", "RobotThinks"]
    spoke, thinks = (change.t for change in rig.of(m.EngagementChanged)[-2:])
    assert thinks - spoke == pytest.approx(2_000_000, abs=150_000)


def test_a_visitor_greeted_by_name(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        with pytest.raises(RequestError, match=r"\{visitor\} has no value yet") as raised:
            rig.session.play("Greet", WIZARD)
        assert "enter who the visitor is" in raised.value.hint
        await engage_visitor(rig)
        rig.session.play("Greet", WIZARD)

    rig = in_room(tmp_path, scenario)
    assert ("say", {"text": "Hello V1"}) in rig.robot.calls


def test_a_panel_of_one_of_two_robots_may_tell_the_model(tmp_path: Path) -> None:
    one = guided(tmp_path)
    (spec,) = one.drivers
    two = replace(
        one, drivers=(replace(spec, name="left.robot"), replace(spec, name="right.robot"))
    )

    async def scenario(rig: EngagementRig) -> None:
        driver = rig.session.drivers["left.robot"]
        assert isinstance(driver, GuideDriver)
        driver.context.ask(Ask("verb", "toggle", {"sign": "presence"}, source="midi"))
        await asyncio.sleep(0.5)

    rig = in_room(tmp_path, scenario, two)
    assert rig.path == ["PersonDetected"]
