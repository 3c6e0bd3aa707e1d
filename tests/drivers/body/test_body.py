"""The driver `body`: verbs to setpoints, faces and readings; the stop; the end. In virtual time."""

from __future__ import annotations

import asyncio
import dataclasses
import math
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.body import Body, Settings

from tests.drivers.body.rig import Stage, robot, small, within
from tests.drivers.heard import Ordered
from tests.fakes.virtual_time import run_virtual
from woz_tui.core.conformance import check
from woz_tui.core.driver import Lost, Probe, Rejected, Scope
from woz_tui.core.messages import (
    BodyChanged,
    DriverConnected,
    DriverFaulted,
    FaceShown,
    Json,
    ModeChanged,
    Notice,
    Reading,
)
from woz_tui.motion.builtin import BUILT_IN
from woz_tui.motion.kinematics import Chain
from woz_tui.motion.setpoints import PRESENT, SEEN, Present, Seen
from woz_tui.motion.shapes import FaceShape, JointShape, Personality

#: A body without breath, so that it stands where it was told to.
CALM = Personality(breathing=0.0, blink_rate=0.0)


def played(
    tmp_path: Path, story: Callable[[Stage], Coroutine[Any, Any, None]], **changes: Any
) -> Stage:
    """Plays `story` on a small calm body to its end, and closes it."""
    settings = small(personality=CALM, **changes)

    async def whole() -> Stage:
        it = await Stage.of(settings, tmp_path)
        await story(it)
        await it.body.close()
        return it

    return run_virtual(whole())


# -- what it declares -----------------------------------------------------------------------------


async def test_it_keeps_the_driver_contract(tmp_path: Path) -> None:
    for name in ("eyepi", "five-joints"):
        findings = await check(Body, robot(name, tmp_path))
        assert [finding.level for finding in findings] == ["ok"], findings


def test_a_body_without_a_face_has_no_verbs_about_it() -> None:
    names = {verb.name for verb in Body.verbs(small())}
    assert {"play", "gaze", "pose", "mode", "personality"} <= names
    assert not names & {"emotion", "look", "blink", "brightness"}
    assert "emotion" in {verb.name for verb in Body.verbs(small(face=FaceShape()))}


def test_readings_are_declared_as_they_are_published() -> None:
    assert Body.sensors(small()) == (
        *("setpoint.pan", "setpoint.tilt", "joint.pan", "joint.tilt", "tick"),
    )
    assert Body.sensors(small(servos="head")) == ("setpoint.pan", "setpoint.tilt", "tick")


def test_its_outline_is_that_of_a_body() -> None:
    found = Body.outline(small(face=FaceShape()))
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
    async def story(it: Stage) -> None:
        job = Ordered("pose", {"joints": {"pan": 40.0}, "seconds": 1.0})
        begun = asyncio.get_running_loop().time()
        running = asyncio.create_task(it.body.perform(job))
        path = await it.path(60)
        sent = await running
        assert sent["joints"] == {"pan": 40.0}
        assert "ended" not in sent
        assert job.announced == [pytest.approx(1.0)]
        assert asyncio.get_running_loop().time() - begun < 1.3
        assert within(it.body.settings, path)
        assert it.setpoints["pan"] == pytest.approx(40.0)

    played(tmp_path, story)


@pytest.mark.toolkit("L7")
def test_a_move_is_awaited_and_a_named_pose_is_played_like_one(tmp_path: Path) -> None:
    async def story(it: Stage) -> None:
        begun = asyncio.get_running_loop().time()
        await it.do("play", move="nod", speed=1.0, amplitude=1.0)
        assert asyncio.get_running_loop().time() - begun > 1.0
        sent = await it.do("play", move="aside", speed=2.0, amplitude=0.5)
        assert sent["joints"] == {"pan": 15.0, "tilt": 25.0}  # half of the way from home
        assert sent["seconds"] == pytest.approx(0.5)

    played(tmp_path, story, poses={"aside": {"pan": 30.0, "tilt": 40.0}})


@pytest.mark.toolkit("E2")
def test_streams_are_answered_at_once_and_take_over(tmp_path: Path) -> None:
    async def story(it: Stage) -> None:
        playing = it.begin("play", move="dance", speed=1.0, amplitude=1.0)
        await it.ticks(10)
        begun = asyncio.get_running_loop().time()
        sent = await it.do("gaze", yaw=20.0, pitch=0.0, seconds=2.0)
        assert asyncio.get_running_loop().time() == begun
        assert sent["seconds"] == pytest.approx(2.0)
        assert "gaze" in str((await playing)["ended"])

    played(tmp_path, story)


def test_the_arrow_keys_turn_a_body_as_they_turn_any_head(tmp_path: Path) -> None:
    """Yaw to its left and pitch downwards are positive, as for servos and the simulated robot."""

    async def whole() -> None:
        settings = robot("eyepi", tmp_path, personality=CALM)
        it, chain = await Stage.of(settings, tmp_path), Chain(settings)
        before = chain.ray(it.setpoints)[1]
        await it.do("nudge", yaw=5.0, pitch=10.0)
        await it.ticks(30)
        lower = chain.ray(it.setpoints)[1]
        assert lower[2] < before[2] and lower[1] > before[1]
        await it.do("gaze", yaw=0.0, pitch=-20.0, seconds=0.5)
        await it.ticks(40)
        up = chain.ray(it.setpoints)[1]
        assert math.degrees(math.asin(up[2])) == pytest.approx(20.0, abs=0.5)
        await it.body.close()

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
    async def story(it: Stage) -> None:
        before = it.setpoints
        with pytest.raises(Rejected):
            await it.do(verb, **args)
        await it.ticks(3)
        assert it.setpoints == pytest.approx(before)

    played(tmp_path, story, poses={"aside": {"pan": 30.0}})


@pytest.mark.toolkit("M2")
def test_what_a_mode_does_not_take_is_rejected_with_a_remedy(tmp_path: Path) -> None:
    async def story(it: Stage) -> None:
        await it.do("mode", mode="demo")
        await it.ticks(2)
        with pytest.raises(Rejected, match="demo") as refused:
            await it.do("pose", joints={"pan": 10.0})
        assert refused.value.remedy
        assert [moved.now for moved in it.heard.all(ModeChanged)] == ["normal", "demo"]
        await it.do("mode", mode="normal")
        await it.ticks(2)
        assert it.heard.all(ModeChanged)[-1].now == "normal"

    played(tmp_path, story)


def test_a_cancelled_command_ends_where_it_is(tmp_path: Path) -> None:
    async def story(it: Stage) -> None:
        running = it.begin("pose", joints={"pan": 60.0}, seconds=2.0)
        await it.ticks(50)
        running.cancel()
        with pytest.raises(asyncio.CancelledError):
            await running
        await it.ticks(5)
        held = it.setpoints["pan"]
        assert 20.0 < held < 45.0
        await it.ticks(60)
        assert it.setpoints["pan"] == pytest.approx(held, abs=0.5)

    played(tmp_path, story)


# -- the stop -------------------------------------------------------------------------------------


@pytest.mark.toolkit("M4", "E4")
def test_a_stop_stands_still_until_it_is_released(tmp_path: Path) -> None:
    async def story(it: Stage) -> None:
        running = it.begin("play", move="dance", speed=1.0, amplitude=1.0)
        await it.ticks(30)
        await it.body.stop(Scope.ALL)
        held = it.setpoints
        await it.ticks(100)
        assert it.setpoints == held
        with pytest.raises(Rejected, match="still"):
            await it.do("play", move="nod")
        assert "stop" in str((await running)["ended"])
        await it.body.resume()
        await it.ticks(200)
        assert it.setpoints != held  # it breathes again

    async def whole() -> None:
        it = await Stage.of(small(breathing={"tilt": 1.0}), tmp_path)
        await story(it)
        await it.body.close()

    run_virtual(whole())


def test_a_stop_of_driving_is_none_of_its_business(tmp_path: Path) -> None:
    async def story(it: Stage) -> None:
        running = it.begin("pose", joints={"pan": 30.0}, seconds=0.5)
        await it.ticks(3)
        await it.body.stop(Scope.DRIVE)
        await running
        assert it.setpoints["pan"] == pytest.approx(30.0)

    played(tmp_path, story)


def test_it_rests_without_breath_and_closes(tmp_path: Path) -> None:
    async def whole() -> None:
        settings = small(breathing={"tilt": 1.0}, rest={"pan": 20.0})
        it = await Stage.of(settings, tmp_path)
        await it.ticks(100)
        path = asyncio.create_task(it.path(200))
        await it.body.rest()
        assert within(settings, await path)
        assert it.setpoints == pytest.approx({"pan": 20.0, "tilt": 10.0})
        await it.body.close()
        await it.body.close()
        with pytest.raises(Lost):
            await it.do("play", move="nod")
        await it.body.stop(Scope.ALL)
        assert "ticks, late by" in it.notices()

    run_virtual(whole())


def test_a_command_under_way_fails_when_it_is_closed(tmp_path: Path) -> None:
    async def whole() -> None:
        it = await Stage.of(small(), tmp_path)
        running = it.begin("play", move="dance", speed=1.0, amplitude=1.0)
        await it.ticks(5)
        await it.body.close()
        with pytest.raises(Lost):
            await running

    run_virtual(whole())


# -- what it tells --------------------------------------------------------------------------------


def test_readings_come_ten_times_a_second(tmp_path: Path) -> None:
    async def story(it: Stage) -> None:
        await it.ticks(100)

    it = played(tmp_path, story)
    assert 20 <= len(it.heard.values("setpoint.pan")) <= 22
    assert len(it.heard.values("joint.pan")) == len(it.heard.values("setpoint.pan"))
    assert 2 <= len(it.heard.values("tick")) <= 3
    assert {one.sensor for one in it.heard.all(Reading)} <= set(Body.sensors(it.body.settings))
    assert [one.detail for one in it.heard.all(DriverConnected)] == [
        "2 joints at 50 Hz, without servos"
    ]


@pytest.mark.toolkit("F1", "L9")
def test_the_face_is_shown_when_it_changes_and_is_what_the_lights_get(tmp_path: Path) -> None:
    async def story(it: Stage) -> None:
        await it.do("emotion", emotion="happy", intensity=1.0)
        await it.ticks(60)
        shown = it.heard.all(FaceShown)
        assert 2 <= len(shown) <= 60 / 2 + 2  # 25 a second at most
        assert (shown[-1].emotion, shown[-1].intensity) == ("happy", 1.0)
        assert shown[-1].rows == it.lit.frame.hex
        count = len(shown)
        await it.ticks(60)
        assert len(it.heard.all(FaceShown)) == count

    played(tmp_path, story, face=FaceShape())


@pytest.mark.toolkit("P5")
def test_how_it_is_is_told_when_it_changes(tmp_path: Path) -> None:
    ways = {"grumpy": Personality(tempo=1.4, smoothing=0.3, compression=0.25)}

    async def story(it: Stage) -> None:
        await it.ticks(30)
        assert len(it.heard.all(BodyChanged)) == 1
        await it.do("personality", name="grumpy")
        await it.ticks(50)
        values = it.heard.all(BodyChanged)[-1].values
        assert values["personality"] == "grumpy"
        assert values["tempo"] == pytest.approx(1.4)
        assert it.state.personality == "grumpy"
        assert set(it.state.controls) >= {"pan", "tilt", "tempo", "smoothing"}

    played(tmp_path, story, personalities=ways)


@pytest.mark.toolkit("R4")
def test_the_zero_of_a_joint_is_added_for_the_servos_only(tmp_path: Path) -> None:
    joints = {"pan": JointShape("z", -90, 90, 300, zero=5.0)}

    async def whole() -> None:
        settings = Settings(joints, personality=CALM)
        it = await Stage.of(settings, tmp_path)
        await it.do("pose", joints={"pan": 10.0}, seconds=0.3)
        await it.ticks(10)
        assert it.setpoints["pan"] == pytest.approx(15.0)
        assert it.heard.values("setpoint.pan")[-1] == pytest.approx(10.0)
        await it.body.close()

    run_virtual(whole())


# -- servos and camera beside it ------------------------------------------------------------------


def present(it: Stage, held: frozenset[str], **joints: float) -> None:
    now = round(asyncio.get_running_loop().time() * 1e6)
    it.heard.outlet.feed(PRESENT, of="head").put(Present(now, joints, held))


@pytest.mark.toolkit("R4")
def test_it_begins_where_the_servos_are_and_follows_hands_while_they_are_limp(
    tmp_path: Path,
) -> None:
    async def story(it: Stage) -> None:
        present(it, frozenset(), pan=33.0, tilt=-12.0)
        await it.ticks(2)
        assert it.setpoints == pytest.approx({"pan": 33.0, "tilt": -12.0})
        present(it, frozenset(), pan=-40.0, tilt=-12.0)  # a hand turns it
        await it.ticks(2)
        assert it.setpoints["pan"] == pytest.approx(-40.0)
        present(it, frozenset({"pan", "tilt"}), pan=-40.0, tilt=-12.0)
        await it.ticks(2)
        present(it, frozenset({"pan", "tilt"}), pan=10.0, tilt=-12.0)  # held: it lags, no more
        await it.ticks(2)
        assert it.setpoints["pan"] == pytest.approx(-40.0)

    played(tmp_path, story, servos="head")


def test_a_move_is_rehearsed_with_limp_servos(tmp_path: Path) -> None:
    async def story(it: Stage) -> None:
        present(it, frozenset(), pan=0.0, tilt=10.0)
        await it.ticks(2)
        running = it.begin("play", move="shake", speed=1.0, amplitude=1.0)
        for step in range(40):
            present(it, frozenset(), pan=float(step), tilt=10.0)
            await it.ticks(1)
        assert "ended" not in await running

    played(tmp_path, story, servos="head")


@pytest.mark.toolkit("O4", "O6")
def test_tracking_turns_to_what_the_camera_sees(tmp_path: Path) -> None:
    async def story(it: Stage) -> None:
        await it.do("mode", mode="tracking")
        for frame in range(1, 60):
            now = round(asyncio.get_running_loop().time() * 1e6)
            it.heard.outlet.feed(SEEN, of="eye").put(Seen(now, frame, 0.5, 0.0, 0.1))
            await it.ticks(2)
        assert it.setpoints["pan"] < -5.0  # right of the middle: the head turns to its right

    played(tmp_path, story, camera="eye")


# -- when something breaks ------------------------------------------------------------------------


@pytest.mark.toolkit("G1", "R4")
def test_a_tick_that_fails_is_told_and_the_next_one_goes_on(tmp_path: Path) -> None:
    async def story(it: Stage) -> None:
        class Torn(type(it.body.loop.engine)):  # type: ignore[misc]
            def tick(self, t: float) -> Any:
                raise RuntimeError("a bug")

        whole = it.body.loop.engine.__class__
        it.body.loop.engine.__class__ = Torn
        await it.ticks(2)
        assert len(it.heard.all(DriverFaulted)) == 1
        it.body.loop.engine.__class__ = whole
        await it.ticks(2)
        assert len(it.heard.all(DriverConnected)) == 2
        await it.do("pose", joints={"pan": 5.0}, seconds=0.2)

    played(tmp_path, story)


def test_every_built_in_move_can_be_played(tmp_path: Path) -> None:
    async def story(it: Stage) -> None:
        for name in BUILT_IN:
            if name != "demo":
                running = it.begin("play", move=name, speed=1.0, amplitude=1.0)
                path = await it.path(200)
                assert within(it.body.settings, path)
                await running

    it = played(tmp_path, story)
    assert not [one for one in it.heard.all(Notice) if one.level != "info"]


def test_settings_of_robot_files_are_what_they_say(tmp_path: Path) -> None:
    settings = robot("eyepi", tmp_path)
    assert [joint.home for joint in settings.joints.values()] == [0, 72, 63]
    assert dataclasses.asdict(settings.personalities["grumpy"])["compression"] == 0.25
