"""Gaze, pose, poses, home: lines in time."""

from __future__ import annotations

import itertools
import math
import random
from dataclasses import replace

import pytest

from tests.motion.bodies import CALM, DT, EYEPI, FIVE, STILL, Rig, moves_safely
from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.kinematics import KinematicChain
from woz_tui.protocol.messages import Json

RAD = math.degrees(1e-6)


@pytest.mark.toolkit("L4", "L2")
@pytest.mark.parametrize("seconds", [0.6, 1.0, 2.5])
def test_a_gaze_is_a_straight_line_in_time(seconds: float) -> None:
    rig = Rig()
    start = dict(rig.last.joints)
    answer = rig.do("gaze", yaw=40.0, pitch=-10.0, seconds=seconds)
    goal = answer.sent["joints"]
    assert isinstance(goal, dict)
    ticks = rig.wait(answer)
    end = ticks[-1].joints
    assert len(ticks) == math.ceil(seconds / DT - 1e-9)
    for count, tick in enumerate(ticks, 1):
        share = min(1.0, count * DT / seconds)
        for joint, angle in start.items():
            assert abs(tick.joints[joint] - (angle + (end[joint] - angle) * share)) < RAD
    assert {joint: round(angle, 3) for joint, angle in end.items()} == goal
    assert answer.seconds == seconds
    assert "late_s" not in answer.sent


@pytest.mark.toolkit("L4")
def test_too_short_a_time_arrives_late_at_full_speed() -> None:
    rig = Rig()
    answer = rig.do("pose", joints={"pitch": 90.0}, seconds=0.1)
    assert answer.sent["late_s"] == pytest.approx(0.15)
    ticks = rig.wait(answer)
    assert len(ticks) * DT == pytest.approx(0.25, abs=DT)
    assert moves_safely(STILL, ticks)
    assert ticks[0].joints["pitch"] == pytest.approx(360 * DT)


@pytest.mark.toolkit("L4")
@pytest.mark.parametrize("seconds", [0.0, -3.0, math.nan, None, -1e300])
def test_no_time_means_as_fast_as_allowed(seconds: Json) -> None:
    rig = Rig()
    ticks = rig.wait(rig.do("pose", joints={"pitch": -72.0}, seconds=seconds))
    assert len(ticks) * DT == pytest.approx(72 / 360, abs=DT)
    assert ticks[-1].joints["pitch"] == -72.0


@pytest.mark.toolkit("L4")
def test_a_new_gaze_begins_at_the_setpoint_of_the_moment() -> None:
    rig = Rig()
    first = rig.do("pose", joints={"pitch": 80.0}, seconds=1.0)
    before = rig.run(0.5)[-1].joints["pitch"]
    second = rig.do("pose", joints={"pitch": -20.0}, seconds=1.0)
    ticks = rig.wait(second)
    assert [(e.token, e.why) for e in ticks[0].ended] == [(first.token, "replaced by pose")]
    for count, tick in enumerate(ticks, 1):
        assert tick.joints["pitch"] == pytest.approx(before + (-20 - before) * count * DT, abs=RAD)


@pytest.mark.toolkit("L4")
@pytest.mark.parametrize(("easing", "middle"), [("smooth", 1.5), ("minimum-jerk", 1.875)])
def test_other_easings_are_slow_at_both_ends(easing: str, middle: float) -> None:
    rig = Rig()
    answer = rig.do("pose", joints={"pitch": 60.0}, seconds=2.0, easing=easing)
    ticks = rig.wait(answer)
    steps = [b.joints["pitch"] - a.joints["pitch"] for a, b in itertools.pairwise(ticks)]
    assert max(steps) == pytest.approx(middle * 30 * DT, rel=0.01)
    assert steps[0] < 0.1 * max(steps)
    assert ticks[-1].joints["pitch"] == pytest.approx(60.0)


@pytest.mark.parametrize("smoothing", [0.0, 0.2])
def test_a_prediction_changes_no_setpoint(smoothing: float) -> None:
    """Also where a joint cannot follow, and lags behind what is wanted."""
    shape = replace(EYEPI, personality=replace(CALM, smoothing=smoothing))
    ways = []
    for asks in (False, True):
        rig = Rig(shape)
        rig.do("control", control="pitch", value=0.0)
        rig.run(2.0)
        rig.do("control", control="pitch", value=1.0)
        way = []
        for _ in range(60):
            if asks:
                assert rig.engine.predict("gaze", {"yaw": 20.0}).seconds
            way.append(rig.run(DT)[-1].joints)
        ways.append(way)
    assert ways[0] == ways[1]
    assert ways[0][0] != ways[0][-1]


def test_poses_follow_one_another() -> None:
    rig = Rig()
    answer = rig.do(
        "poses",
        poses=[
            {"joints": {"pitch": 30.0}, "seconds": 0.5},
            {"joints": {"top": 40.0, "tail": 1}, "seconds": 0.5},
            {"joints": {"pitch": 0.0, "top": 200}},
        ],
    )
    rig.run(0.5)
    assert rig.last.joints == pytest.approx({"pitch": 30, "middle": 45, "top": 28.65})
    rig.run(0.5)
    assert rig.last.joints == pytest.approx({"pitch": 30, "middle": 45, "top": 40})
    rig.wait(answer)
    assert rig.last.joints == pytest.approx({"pitch": 0, "middle": 45, "top": 90})
    told = answer.sent["poses"]
    assert isinstance(told, list)
    assert told[1] == {"joints": {"top": 40.0}, "left_out": {"tail": "no such joint"}}
    assert told[2] == {"joints": {"pitch": 0.0, "top": 90.0}, "clamped": {"top": 200.0}}


@pytest.mark.toolkit("L5")
def test_a_gaze_nobody_can_reach_is_flagged() -> None:
    rig = Rig()
    answer = rig.do("gaze", x=-1.0, y=0.1, z=0.2, seconds=1.0)
    assert answer.sent["reachable"] is False
    rig.wait(answer)
    assert "reachable" not in rig.do("gaze", x=2.0, y=0.5, z=0.1).sent


@pytest.mark.toolkit("L5")
@pytest.mark.parametrize("shape", [STILL, replace(FIVE, personality=CALM)], ids=["three", "five"])
def test_the_line_of_sight_passes_the_target(shape: BodyShape) -> None:
    chance, chain, reached = random.Random(5), KinematicChain(shape), 0
    rig = Rig(shape)
    for _ in range(20):
        target = (chance.uniform(0.5, 3), chance.uniform(-1.5, 1.5), chance.uniform(-0.5, 1))
        answer = rig.do("gaze", x=target[0], y=target[1], z=target[2], seconds=0.5)
        rig.wait(answer)
        rig.run(1.0)
        eyes, ray = chain.ray(rig.last.joints)
        way = [a - b for a, b in zip(target, eyes, strict=True)]
        cosine = sum(a * b for a, b in zip(way, ray, strict=True)) / math.hypot(*way)
        if "reachable" not in answer.sent:
            reached += 1
            assert math.degrees(math.acos(min(1.0, cosine))) < 2.0
    assert reached > 10


@pytest.mark.toolkit("L5")
def test_a_gaze_at_the_head_itself_is_refused() -> None:
    rig = Rig()
    x, y, z = KinematicChain(STILL).ray(rig.last.joints)[0]
    with pytest.raises(RejectedError, match=r"^gaze: \(.*\) m is at the head itself"):
        rig.do("gaze", x=x, y=y, z=z)
    rig.run(0.1)
    assert rig.last.joints == {"pitch": 0, "middle": 45, "top": 28.65}


@pytest.mark.toolkit("L5")
def test_a_gaze_at_nothing_is_refused_and_changes_nothing() -> None:
    rig = Rig()
    here = rig.engine.values(), rig.engine.state()
    for args in (
        {"x": math.nan, "y": 0.0, "z": 0.0},
        {"x": 1.0, "y": 0.0},
        {"x": 1.0, "y": 0.0, "z": 0.0, "yaw": 3.0},
        {},
        {"yaw": "left"},
        {"pitch": 120},
    ):
        with pytest.raises(RejectedError):
            rig.engine.apply("gaze", args)
    rig.run(0.2)
    assert (rig.engine.values(), rig.engine.state()) == here
    assert rig.last.joints == {"pitch": 0, "middle": 45, "top": 28.65}


def test_nudges_add_up() -> None:
    rig = Rig(FIVE)
    rig.do("breathing", on=False)
    rig.run(1.0)
    rig.do("gaze", yaw=0.0, pitch=0.0)
    rig.run(2.0)
    for _ in range(5):
        rig.do("nudge", yaw=4.0)
        rig.run(0.04)
    rig.run(1.0)
    straight = rig.do("gaze", yaw=20.0, pitch=0.0)
    before = dict(rig.last.joints)
    rig.wait(straight)
    assert rig.last.joints == pytest.approx(before, abs=2.0)


@pytest.mark.toolkit("L6")
def test_home_from_anywhere() -> None:
    chance = random.Random(6)
    rig = Rig()
    rig.do("emotion", emotion="sad", intensity=0.6)
    home = {name: joint.home for name, joint in STILL.joints.items()}
    for _ in range(100):
        pose = {n: chance.uniform(j.min, j.max) for n, j in STILL.joints.items()}
        rig.wait(rig.do("pose", joints=pose))
        ticks = rig.wait(rig.do("home"))
        assert rig.last.joints == pytest.approx(home)
        assert len(ticks) * DT == pytest.approx(1.0, abs=DT)
        assert (rig.last.emotion, rig.last.intensity) == ("sad", 0.6)


@pytest.mark.toolkit("L4", "E2")
def test_a_line_begins_where_a_joint_that_could_not_follow_is() -> None:
    rig = Rig()
    rig.do("joints", joints={"pitch": 90.0})
    at = rig.run(0.1)[-1].joints["pitch"]
    assert at < 50
    rig.do("pose", joints={"pitch": 0.0}, seconds=1.0)
    assert rig.tick().joints["pitch"] == pytest.approx(at * 0.98)


@pytest.mark.toolkit("E2")
def test_a_control_takes_its_joint_out_of_a_line() -> None:
    rig = Rig()
    answer = rig.do("pose", joints={"pitch": 60.0, "middle": 80.0}, seconds=1.0)
    before = rig.run(0.4)
    rig.do("control", control="pitch", value=0.5)
    after = rig.wait(answer)
    assert moves_safely(STILL, [*before, *after])
    assert rig.last.joints["middle"] == pytest.approx(80.0)
    assert rig.last.joints["pitch"] == pytest.approx(0.0)
    assert after[-1].ended[0].why == ""
    last = rig.do("pose", joints={"pitch": 60.0}, seconds=1.0)
    rig.run(0.2)
    rig.do("joints", joints={"pitch": 10.0})
    assert [(e.token, e.why) for e in rig.tick().ended] == [(last.token, "replaced by joints")]


@pytest.mark.toolkit("E2", "L8")
def test_a_gaze_while_breathing_is_the_line_and_the_breath() -> None:
    calm, alive = Rig(STILL), Rig(EYEPI)
    for rig in (calm, alive):
        rig.run(2.0)
        rig.do("gaze", yaw=30.0, seconds=1.0)
    for still, breathing in zip(calm.run(1.5), alive.run(1.5), strict=True):
        assert breathing.joints["pitch"] == pytest.approx(still.joints["pitch"], abs=1e-6)
        assert abs(breathing.joints["top"] - still.joints["top"]) <= 180 / 70 + 1e-6


@pytest.mark.toolkit("K3")
def test_four_controls_at_once_show_in_the_next_tick() -> None:
    rig = Rig()
    names = ("pitch", "middle", "top", "eye-x")
    for step in range(100):
        for fine in (0.0, 0.5):
            for name in names:
                rig.do("control", control=name, value=0.3 + (step + fine) / 400)
        tick = rig.tick()
        place = 0.3 + (step + 0.5) / 400
        assert tick.wanted["pitch"] == pytest.approx(-90 + 180 * place)
        assert tick.wanted["middle"] == tick.wanted["top"] == pytest.approx(90 * place)
    assert rig.engine.state().controls["eye-x"] == pytest.approx(0.3 + 99.5 / 400)


@pytest.mark.toolkit("K3")
def test_zoom_moves_its_joints_in_opposite_directions_and_stops_them_together() -> None:
    rig = Rig()
    rig.do("control", control="middle", value=0.5)
    rig.do("control", control="top", value=0.7)
    rig.run(0.5)
    seen = []
    for step in range(51):
        rig.do("control", control="zoom", value=0.5 + step / 100)
        rig.run(0.1)
        seen.append((rig.last.joints["middle"] - 45, rig.last.joints["top"] - 63))
    assert all(middle == pytest.approx(-top) for middle, top in seen)
    assert seen[-1][0] == pytest.approx(45)  # the middle joint has arrived at 90
    assert seen == sorted(seen)
    rig.do("control", control="zoom", value=0.0)
    rig.run(0.5)
    assert rig.last.joints["top"] == pytest.approx(90)  # 27 more, so 27 less for the other
    assert rig.last.joints["middle"] == pytest.approx(45 - 27)
    rig.do("control", control="zoom", value=0.5)
    rig.run(0.5)
    assert rig.last.joints == pytest.approx({"pitch": 0, "middle": 45, "top": 63})
