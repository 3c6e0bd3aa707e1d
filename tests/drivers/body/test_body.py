"""The driver `body`: verbs to setpoints, faces and readings; the stop; the end. In virtual time."""

from __future__ import annotations

import asyncio
import math
from pathlib import Path

import pytest
from woz_drivers.body import Body, BodySettings
from woz_drivers.body.tick_loop import BodyLoop, Lateness

from tests.drivers.body.rig import CALM, BodyRig, SteppedBody, played_body, robot, small, within
from tests.drivers.published_messages import BusJob, PublishedMessages
from tests.fakes.virtual_time import LoopClock, run_virtual, stand_still
from woz_tui.drivers.contract import DeviceLostError, Probe, RejectedError, Scope
from woz_tui.motion.body_shape import FaceShape, JointShape
from woz_tui.motion.kinematics import KinematicChain
from woz_tui.protocol.messages import (
    Json,
    ModeChanged,
)

# -- what it declares -----------------------------------------------------------------------------


def test_a_body_without_a_face_has_no_verbs_about_it() -> None:
    names = {verb.name for verb in Body.offer(small()).verbs}
    assert {"play", "gaze", "pose", "mode", "personality"} <= names
    assert not names & {"emotion", "look", "blink", "brightness"}
    assert "emotion" in {verb.name for verb in Body.offer(small(face=FaceShape())).verbs}


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("zoom", "has a control 'zoom'"),
        ("tempo", "has a control 'tempo'"),
        ("left.arm", "begins with a letter"),
        ("", "begins with a letter"),
        ("a\nb", "begins with a letter"),
    ],
)
def test_a_joints_name_can_be_told_from_everything_else(name: str, why: str) -> None:
    assert small().problems() == []
    [(path, problem)] = BodySettings({name: JointShape("z", -90, 90, 100)}).problems()
    assert path == f"joints.{name}"
    assert why in problem


def test_joints_that_servos_let_go_of_on_the_way_to_rest_are_named() -> None:
    slow = {"lean": JointShape("z", -75, 75, 8), "nod": JointShape("y", -40, 40, 100)}
    body = BodySettings(slow, servos="head", rest={"lean": 20.0})
    [(path, warning)] = body.warnings()
    assert path == "joints.lean.speed"
    assert "12 s" in warning
    assert BodySettings(slow, rest={"lean": 20.0}).warnings() == []


def test_readings_are_declared_as_they_are_published() -> None:
    assert Body.offer(small()).sensors == (
        *("setpoint.pan", "setpoint.tilt", "joint.pan", "joint.tilt", "tick"),
    )
    assert Body.offer(small(servos="head")).sensors == ("setpoint.pan", "setpoint.tilt", "tick")


def test_its_outline_is_that_of_a_body() -> None:
    found = Body.offer(small(face=FaceShape())).outline
    assert found["kind"] == "body"
    joints = found["joints"]
    assert isinstance(joints, list)
    assert [joint["name"] for joint in joints if isinstance(joint, dict)] == ["pan", "tilt"]


async def test_the_doctor_says_what_it_is_made_of(tmp_path: Path) -> None:
    findings = await Body.examine(Probe("body", robot("five-joints", tmp_path)))
    assert findings[0].level == "ok" and "5 joints" in findings[0].text
    assert any("no servos" in finding.text for finding in findings)


# -- verbs ----------------------------------------------------------------------------------------


@pytest.mark.toolkit("L4", "R2")
def test_a_pose_takes_its_time_and_ends_where_it_was_sent(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        job = BusJob("pose", {"joints": {"pan": 40.0}, "seconds": 1.0})
        begun = asyncio.get_running_loop().time()
        running = asyncio.create_task(rig.body.perform(job))
        path = await rig.path(60)
        sent = await running
        assert sent["joints"] == {"pan": 40.0}
        assert "ended" not in sent
        assert job.announced == [pytest.approx(1.0)]
        assert asyncio.get_running_loop().time() - begun < 1.3
        assert within(rig.body.settings, path)
        assert rig.setpoints["pan"] == pytest.approx(40.0)

    played_body(tmp_path, story)


@pytest.mark.toolkit("L7")
def test_a_move_is_awaited_and_a_named_pose_is_played_like_one(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        begun = asyncio.get_running_loop().time()
        await rig.do("play", move="nod", speed=1.0, amplitude=1.0)
        assert asyncio.get_running_loop().time() - begun > 1.0
        sent = await rig.do("play", move="aside", speed=2.0, amplitude=0.5)
        assert sent["joints"] == {"pan": 15.0, "tilt": 25.0}  # half of the way from home
        assert sent["seconds"] == pytest.approx(0.5)

    played_body(tmp_path, story, poses={"aside": {"pan": 30.0, "tilt": 40.0}})


@pytest.mark.toolkit("E2")
def test_streams_are_answered_at_once_and_take_over(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        playing = rig.begin("play", move="dance", speed=1.0, amplitude=1.0)
        await rig.ticks(10)
        begun = asyncio.get_running_loop().time()
        sent = await rig.do("gaze", yaw=20.0, pitch=0.0, seconds=2.0)
        assert asyncio.get_running_loop().time() == begun
        assert sent["seconds"] == pytest.approx(2.0)
        assert "gaze" in str((await playing)["ended"])

    played_body(tmp_path, story)


def test_the_arrow_keys_turn_a_body_as_they_turn_any_head(tmp_path: Path) -> None:
    """Yaw to its left and pitch downwards are positive, as for servos and the simulated robot."""

    async def whole() -> None:
        settings = robot("eyepi", tmp_path, personality=CALM)
        rig, chain = await BodyRig.of(settings, tmp_path), KinematicChain(settings)
        before = chain.ray(rig.setpoints)[1]
        await rig.do("nudge", yaw=5.0, pitch=10.0)
        await rig.ticks(30)
        lower = chain.ray(rig.setpoints)[1]
        assert lower[2] < before[2] and lower[1] > before[1]
        await rig.do("gaze", yaw=0.0, pitch=-20.0, seconds=0.5)
        await rig.ticks(40)
        up = chain.ray(rig.setpoints)[1]
        assert math.degrees(math.asin(up[2])) == pytest.approx(20.0, abs=0.5)
        await rig.body.close()

    run_virtual(whole())


HOSTILE: list[tuple[str, dict[str, Json]]] = [
    ("sing", {}),
    ("pose", {"joints": {"nose": 3.0}}),
    ("pose", {"joints": {"pan": math.nan}}),
    ("pose", {"joints": "all"}),
    ("play", {"move": "salto"}),
    ("play", {"move": "aside", "speed": 0.0}),
    ("gaze", {}),
    ("gaze", {"yaw": "left"}),
    ("control", {"control": "pan"}),
    ("mode", {"mode": "party"}),
    ("personality", {"name": "nobody"}),
    ("emotion", {"emotion": "happy"}),  # it has no face
]


@pytest.mark.toolkit("R4")
@pytest.mark.parametrize(("verb", "args"), HOSTILE)
def test_nonsense_is_rejected_and_moves_nothing(
    tmp_path: Path, verb: str, args: dict[str, Json]
) -> None:
    async def story(rig: BodyRig) -> None:
        before = rig.setpoints
        with pytest.raises(RejectedError):
            await rig.do(verb, **args)
        await rig.ticks(3)
        assert rig.setpoints == pytest.approx(before)

    played_body(tmp_path, story, poses={"aside": {"pan": 30.0}})


@pytest.mark.toolkit("M2")
def test_what_a_mode_does_not_take_is_rejected_with_a_remedy(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        await rig.do("mode", mode="demo")
        await rig.ticks(2)
        with pytest.raises(RejectedError, match="demo") as raised:
            await rig.do("pose", joints={"pan": 10.0})
        assert raised.value.remedy
        assert [mode_changed.now for mode_changed in rig.published.all(ModeChanged)] == [
            "normal",
            "demo",
        ]
        await rig.do("mode", mode="normal")
        await rig.ticks(2)
        assert rig.published.all(ModeChanged)[-1].now == "normal"

    played_body(tmp_path, story)


@pytest.mark.toolkit("M2", "E4")
@pytest.mark.parametrize("source", ["program", "engagement"])
def test_in_a_mode_a_joints_control_waits_for_a_hand_but_not_for_other_software(
    tmp_path: Path, source: str
) -> None:
    async def story(rig: BodyRig) -> None:
        await rig.do("mode", mode="demo")
        turned: dict[str, Json] = {"control": "pan", "value": 0.75}
        with pytest.raises(RejectedError, match="demo"):
            await rig.body.perform(BusJob("control", turned, source=source))
        sent = await rig.body.perform(BusJob("control", turned, source="midi"))
        assert sent["waits"] == "normal"

    played_body(tmp_path, story)


def test_a_cancelled_command_ends_where_it_is(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        running = rig.begin("pose", joints={"pan": 60.0}, seconds=2.0)
        await rig.ticks(50)
        running.cancel()
        with pytest.raises(asyncio.CancelledError):
            await running
        await rig.ticks(5)
        held = rig.setpoints["pan"]
        assert 20.0 < held < 45.0
        await rig.ticks(60)
        assert rig.setpoints["pan"] == pytest.approx(held, abs=0.5)

    played_body(tmp_path, story)


# -- the stop -------------------------------------------------------------------------------------


@pytest.mark.toolkit("M4", "E4")
def test_a_stop_stands_still_until_it_is_released(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        running = rig.begin("play", move="dance", speed=1.0, amplitude=1.0)
        await rig.ticks(30)
        await rig.body.stop(Scope.ALL)
        held = rig.setpoints
        await rig.ticks(100)
        assert rig.setpoints == held
        with pytest.raises(RejectedError, match="still"):
            await rig.do("play", move="nod")
        assert "stop" in str((await running)["ended"])
        await rig.body.resume()
        await rig.ticks(200)
        assert rig.setpoints != held  # it breathes again

    async def whole() -> None:
        rig = await BodyRig.of(small(breathing={"tilt": 1.0}), tmp_path)
        await story(rig)
        await rig.body.close()

    run_virtual(whole())


def test_a_stop_is_confirmed_although_the_process_stood_still(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        await rig.ticks(3)
        stand_still(after=0.0, seconds=0.5)
        await rig.body.stop(Scope.ALL)

    played_body(tmp_path, story)


def test_a_stop_before_it_is_opened_holds_from_the_first_tick_on(tmp_path: Path) -> None:
    async def whole() -> None:
        published = PublishedMessages(tmp_path, LoopClock(asyncio.get_running_loop()))
        body = SteppedBody("it", small(breathing={"tilt": 1.0}), published.context)
        await body.stop(Scope.ALL)
        await body.open()
        rig = BodyRig(body, published)
        await rig.ticks(1)
        held = rig.setpoints
        await rig.ticks(200)
        assert rig.setpoints == held
        await body.resume()
        await rig.ticks(200)
        assert rig.setpoints != held
        await body.close()

    run_virtual(whole())


def test_a_stop_that_was_given_up_does_not_keep_others_waiting(tmp_path: Path) -> None:
    async def whole() -> None:
        clock = LoopClock(asyncio.get_running_loop())
        loop = BodyLoop(
            small(), PublishedMessages(tmp_path, clock).context, Lateness(), lambda ended: None
        )
        given_up, other = loop.freeze(), loop.freeze()
        given_up.cancel()
        loop.step(1.0)
        assert other.done()
        assert other.result() is None

    run_virtual(whole())


def test_a_stop_of_driving_is_none_of_its_business(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        running = rig.begin("pose", joints={"pan": 30.0}, seconds=0.5)
        await rig.ticks(3)
        await rig.body.stop(Scope.DRIVE)
        await running
        assert rig.setpoints["pan"] == pytest.approx(30.0)

    played_body(tmp_path, story)


def test_it_rests_without_breath_and_closes(tmp_path: Path) -> None:
    async def whole() -> None:
        settings = small(breathing={"tilt": 1.0}, rest={"pan": 20.0})
        rig = await BodyRig.of(settings, tmp_path)
        await rig.ticks(100)
        path = asyncio.create_task(rig.path(200))
        await rig.body.rest()
        assert within(settings, await path)
        assert rig.setpoints == pytest.approx({"pan": 20.0, "tilt": 10.0})
        await rig.body.close()
        await rig.body.close()
        with pytest.raises(DeviceLostError):
            await rig.do("play", move="nod")
        await rig.body.stop(Scope.ALL)
        assert "ticks, late by" in rig.notices()

    run_virtual(whole())


def test_a_command_under_way_fails_when_it_is_closed(tmp_path: Path) -> None:
    async def whole() -> None:
        rig = await BodyRig.of(small(), tmp_path)
        running = rig.begin("play", move="dance", speed=1.0, amplitude=1.0)
        await rig.ticks(5)
        await rig.body.close()
        with pytest.raises(DeviceLostError):
            await running

    run_virtual(whole())
