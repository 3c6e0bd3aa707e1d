"""Planning and bounding of setpoints: pure functions, hostile inputs."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from woz_drivers.dynamixel import control_tables
from woz_drivers.dynamixel.servo import calibrate
from woz_drivers.dynamixel.setpoint_planning import (
    Keyframe,
    TargetFollower,
    plan_motion,
    plan_segment,
    shortest_duration,
)
from woz_drivers.dynamixel.settings import ServoJointSettings

from woz_tui.motion.safety import Limits, limited_setpoint

DT = 0.02
#: How long an example takes says something about the machine only.
patient = settings(deadline=None)
WIDE = st.floats(allow_nan=True, allow_infinity=True)
ANGLE = st.floats(-1e4, 1e4)
LIMITS = st.builds(
    lambda low, width, speed, acceleration: Limits(low, low + width, speed, acceleration),
    st.floats(-360, 360),
    st.floats(0.1, 720),
    st.floats(0.1, 1000),
    st.none() | st.floats(1, 10_000),
)


@patient
@given(LIMITS, st.floats(0, 1), st.lists(st.tuples(WIDE, WIDE), max_size=30))
def test_guard_holds_against_anything(
    limits: Limits, where: float, hostile: list[tuple[float, float]]
) -> None:
    last = limits.low + where * (limits.high - limits.low)
    for wanted, elapsed in hostile:
        new = limited_setpoint(limits, last, wanted, elapsed)
        allowed = limits.speed * elapsed if math.isfinite(elapsed) and elapsed > 0 else 0.0
        assert math.isfinite(new)
        assert limits.low <= new <= limits.high
        assert abs(new - last) <= allowed * (1 + 1e-9) + 1e-9
        last = new


@patient
@given(LIMITS, ANGLE, st.lists(st.tuples(WIDE, st.floats(0, 0.1)), max_size=30))
def test_guard_never_drives_a_joint_further_out(
    limits: Limits, outside: float, hostile: list[tuple[float, float]]
) -> None:
    last = outside
    for wanted, elapsed in hostile:
        new = limited_setpoint(limits, last, wanted, elapsed)
        assert min(limits.low, last) <= new <= max(limits.high, last)
        last = new
    # Left alone, it is not dragged back in either.
    assert limited_setpoint(limits, outside, outside, DT) == outside


@patient
@given(
    LIMITS,
    st.floats(0, 1),
    st.floats(0, 1),
    st.floats(0, 20),
    st.sampled_from(["minimum-jerk", "trapezoid"]),
)
def test_a_segment_keeps_the_limits(
    limits: Limits, a: float, b: float, seconds: float, profile: str
) -> None:
    start, goal = (limits.low + share * (limits.high - limits.low) for share in (a, b))
    duration = max(seconds, shortest_duration(goal - start, limits))
    part = plan_segment(start, goal, duration, limits, profile)
    assert part.at(0) == part.at(-1) == pytest.approx(start, abs=2e-6)
    assert part.at(duration) == goal
    assert part.at(duration + 5) == goal
    dt = duration / 200
    path = [part.at(index * dt) for index in range(201)]
    steps = [b - a for a, b in itertools.pairwise(path)]
    rounding = 1e-9 * (abs(start) + abs(goal) + 1)
    assert max(map(abs, steps)) <= limits.speed * dt * (1 + 1e-6) + rounding
    if limits.acceleration is not None:
        changes = [b - a for a, b in itertools.pairwise(steps)]
        bound = limits.acceleration * dt * dt * (1 + 1e-3) + 3 * rounding
        assert max(map(abs, changes)) <= bound


def test_minimum_jerk_is_the_published_curve() -> None:
    part = plan_segment(0.0, 10.0, 2.0, Limits(-90, 90, 300), "minimum-jerk")
    assert part.at(1.0) == pytest.approx(5.0)
    assert part.at(0.5) == pytest.approx(10 * (10 / 64 - 15 / 256 + 6 / 1024))


def test_too_short_for_a_gentle_curve_still_arrives_in_time() -> None:
    # 90 degrees in 0.4 s: minimum jerk would peak at 422 deg/s, a flat top at 300 is enough.
    part = plan_segment(0.0, 90.0, 0.4, Limits(-90, 90, 300), "minimum-jerk")
    assert part.ramp == pytest.approx(0.1)
    assert part.at(0.4) == 90.0


def test_a_plan_waits_for_the_slowest_joint_and_says_how_late() -> None:
    limits = {"pan": Limits(-90, 90, 100), "tilt": Limits(-30, 30, 10)}
    frames = [
        Keyframe({"pan": 50.0, "tilt": 20.0}, 1.0),
        Keyframe({"pan": 0.0, "tilt": 99.0}, 3.0),
    ]
    motion_plan = plan_motion({"pan": 0.0, "tilt": 0.0}, frames, limits, "minimum-jerk")
    assert motion_plan.duration == pytest.approx(2.0 + 3.0)
    assert motion_plan.late == pytest.approx(1.0)
    assert motion_plan.clamped == {"tilt": 99.0}
    assert motion_plan.tracks["pan"].at(2.0) == pytest.approx(50.0)
    assert motion_plan.tracks["tilt"].goal == 30.0


@patient
@given(
    st.dictionaries(st.sampled_from("abc"), LIMITS, min_size=1),
    st.lists(
        st.tuples(st.dictionaries(st.sampled_from("abcx"), ANGLE), WIDE), min_size=1, max_size=4
    ),
)
def test_any_plan_stays_in_range_and_under_speed(
    limits: dict[str, Limits], raw: list[tuple[dict[str, float], float]]
) -> None:
    frames = [Keyframe(angles, seconds) for angles, seconds in raw if not seconds > 1e3]
    start = {name: bound.low for name, bound in limits.items()}
    motion_plan = plan_motion(start, frames, limits, "minimum-jerk")
    assert math.isfinite(motion_plan.duration)
    assert set(motion_plan.tracks) <= set(limits)
    for name, track in motion_plan.tracks.items():
        bound = limits[name]
        dt = max(motion_plan.duration, 1e-3) / 150
        path = [track.at(index * dt) for index in range(152)]
        slack = 1e-6 * (abs(bound.low) + abs(bound.high) + 1)
        assert all(bound.low - slack <= value <= bound.high + slack for value in path)
        fastest = max(abs(b - a) for a, b in itertools.pairwise(path))
        assert fastest <= bound.speed * dt * (1 + 1e-6) + slack


@patient
@given(LIMITS, st.lists(st.tuples(st.floats(0, 1), st.integers(1, 20)), min_size=1, max_size=8))
def test_following_keeps_the_limits_and_arrives(
    limits: Limits, targets: list[tuple[float, int]]
) -> None:
    width = limits.high - limits.low
    position = limits.low
    follow = TargetFollower(limits, position)
    for share, ticks in targets:
        follow.target = limits.low + share * width
        for _ in range(ticks):
            moved = limited_setpoint(limits, position, follow.step(position, DT), DT)
            assert limits.low <= moved <= limits.high
            position = moved
    for _ in range(round(width / (limits.speed * DT)) + 4000):
        if follow.arrived(position):
            break
        position = limited_setpoint(limits, position, follow.step(position, DT), DT)
    assert position == pytest.approx(follow.target, abs=1e-3)


@patient
@given(
    st.sampled_from(control_tables.MODELS),
    st.floats(-400, 400),
    st.sampled_from([1, -1]),
    st.floats(0.25, 8),
)
def test_what_is_written_lies_within_the_servo(
    model: control_tables.ServoModel, degrees: float, direction: int, gear: float
) -> None:
    joint = ServoJointSettings(id=1, min=-90, max=90, direction=direction, gear=gear)
    calibration = calibrate(joint, model, (10, model.steps - 20))
    raw = calibration.raw(degrees)
    assert 10 <= raw <= model.steps - 20
    back = calibration.degrees(raw)
    if calibration.low <= degrees <= calibration.high:
        assert back == pytest.approx(degrees, abs=model.degrees_per_step / gear)


def test_calibration_refuses_what_is_no_number() -> None:
    calibration = calibrate(
        ServoJointSettings(id=1, min=-9, max=9), control_tables.MODELS[0], (0, 4095)
    )
    with pytest.raises(ValueError, match="nan"):
        calibration.raw(math.nan)


def test_gear_and_direction() -> None:
    model = control_tables.by_name("XL330-M288")
    assert model is not None
    joint = ServoJointSettings(id=1, min=-40, max=40, zero=1000, direction=-1, gear=2.0)
    calibration = calibrate(joint, model, (0, 4095))
    # Ten degrees of the joint are twenty of the servo, the other way round.
    assert calibration.raw(10.0) == 1000 - round(20 / (360 / 4096))
    assert calibration.degrees(1000 - 228) == pytest.approx(10.0, abs=0.05)
    assert calibration.speed_count(60.0) == math.ceil(120 / (0.229 * 6))
