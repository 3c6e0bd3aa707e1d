"""Safety: whatever is wanted, what leaves is in range, within speed and acceleration, finite."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.motion.chains import bodies, eyepi
from woz_tui.motion.body_shape import BodyShape, JointShape
from woz_tui.motion.safety import LONGEST_S, Limits, Safety, limited_setpoint

#: Rounding of a double, as an angle.
EPS = 1e-6
DT = 0.02


def safety(shape: BodyShape | None = None, **start: float) -> Safety:
    shape = shape or eyepi()
    home = {name: joint.home for name, joint in shape.joints.items()}
    return Safety(shape.joints, {**home, **start})


def one(acceleration: float | None, start: float = 0.0, speed: float = 360) -> Safety:
    return Safety({"j": JointShape("z", -90, 90, speed, acceleration)}, {"j": start})


def reached(guarded: Safety, joint: str, wanted: float) -> float:
    """Where it is after two seconds."""
    pose = dict(guarded.last)
    for _ in range(100):
        guarded.step({**pose, joint: wanted}, DT)
    return guarded.last[joint]


@pytest.mark.toolkit("R1")
@pytest.mark.parametrize(
    ("wanted", "bottom", "other"),
    [
        *((-1000, -90, 0), (-90.001, -90, 0), (-90, -90, 0), (-1e-9, -1e-9, 0), (0, 0, 0)),
        *((90, 90, 90), (90.001, 90, 90), (1000, 90, 90), (1e300, 90, 90), (10**30, 90, 90)),
    ],
)
def test_angles_out_of_range_end_at_the_limit(wanted: float, bottom: float, other: float) -> None:
    assert reached(safety(), "pitch", wanted) == bottom
    assert reached(safety(), "middle", wanted) == other
    assert reached(safety(), "top", wanted) == other


@pytest.mark.toolkit("R2")
@pytest.mark.parametrize(
    ("joint", "low", "high", "least"),
    [("pitch", -90, 90, 0.5), ("middle", 0, 90, 0.36), ("top", 0, 90, 0.28125)],
)
@pytest.mark.parametrize("acceleration", [None, 20_000, 2000])
def test_a_step_over_the_whole_range_takes_its_time(
    joint: str, low: float, high: float, least: float, acceleration: float | None
) -> None:
    dt = 0.005
    guarded = safety(eyepi(acceleration), **{joint: low})
    before, seconds = guarded.last, 0.0
    speed = eyepi().joints[joint].speed
    while guarded.last[joint] < high:
        guarded.step({**guarded.last, joint: high}, dt)
        assert abs(guarded.last[joint] - before[joint]) <= speed * dt + EPS
        before, seconds = guarded.last, seconds + dt
    assert seconds >= least - 1e-9
    braking = 0.0 if acceleration is None else speed / acceleration
    assert seconds <= least + braking + 8 * dt


@pytest.mark.toolkit("L4", "R2")
def test_a_line_is_followed_without_lag_where_acceleration_is_high() -> None:
    guarded = safety(pitch=-80.0)
    for tick in range(1, 101):
        line = -80.0 + 160.0 * tick / 100  # 80 degrees a second
        assert guarded.step({**guarded.last, "pitch": line}, DT)["pitch"] == line


@pytest.mark.parametrize("acceleration", [100, 700, 5000])
def test_a_wanted_angle_is_reached_and_never_overshot(acceleration: float) -> None:
    guarded = one(acceleration, -40)
    way = [guarded.step({"j": 41.7}, DT)["j"] for _ in range(400)]
    assert way == sorted(way)
    assert way[-1] == 41.7


def test_gentle_joints_brake_before_they_turn_back() -> None:
    guarded = one(400)
    out = [guarded.step({"j": 90}, DT)["j"] for _ in range(30)]
    back = [guarded.step({"j": -90}, DT)["j"] for _ in range(200)]
    assert max(back) > out[-1] + 5  # it could not stop at once
    assert back[-1] == -90


times = st.one_of(st.floats(1e-4, 0.3), st.sampled_from([DT, DT, DT, 1e-9, 1e9, math.inf]))


@pytest.mark.toolkit("R2", "R4")
@given(
    st.one_of(st.none(), st.floats(50, 50_000)),
    st.floats(-90, 90),
    st.lists(st.tuples(st.floats(-200, 200), st.integers(1, 20), times), max_size=25),
)
def test_range_speed_and_acceleration_hold_for_steps_of_any_length(
    acceleration: float | None, start: float, legs: list[tuple[float, int, float]]
) -> None:
    guarded = one(acceleration, start)
    position, speed, counted = start, 0.0, LONGEST_S
    for wanted, repeat, dt in legs:
        for _ in range(repeat):
            before, counted = counted, min(dt, LONGEST_S)
            moved = guarded.step({"j": wanted}, dt)["j"]
            assert -90 <= moved <= 90
            assert abs(moved - position) <= 360 * counted + EPS
            pace = (moved - position) / counted
            if acceleration is not None:
                rounding = EPS + 1e-12 / min(counted, before)
                assert abs(pace - speed) <= acceleration * max(counted, before) + rounding
            position, speed = moved, pace


@pytest.mark.toolkit("R4")
@given(st.floats(100, 20_000), st.lists(times, min_size=5, max_size=60), st.floats(-90, 90))
def test_no_overshoot_whatever_the_length_of_the_steps(
    acceleration: float, steps: list[float], goal: float
) -> None:
    guarded = one(acceleration, -90)
    way = [guarded.step({"j": goal}, dt)["j"] for dt in steps]
    assert way == sorted(way)
    assert max(way) <= goal


@pytest.mark.toolkit("R4")
@pytest.mark.parametrize(
    ("wrong", "why"),
    [
        (math.nan, "nan is no angle"),
        (math.inf, "inf is no angle"),
        (-math.inf, "-inf is no angle"),
        ("45", "'45' is no angle"),
        (None, "NoneType is no angle"),
        (True, "bool is no angle"),
        ([45.0], "list is no angle"),
        (10**400, "int is no angle"),
    ],
)
def test_a_rejected_angle_keeps_the_last_safe_one_for_that_joint_alone(
    wrong: object, why: str
) -> None:
    guarded = safety(pitch=10.0)
    guarded.step({"pitch": 20.0, "middle": 72.0, "top": 63.0}, DT)
    kept = guarded.last["pitch"]
    guarded.step({"pitch": wrong, "middle": 80.0, "top": 63.0}, DT)
    assert guarded.rejected == {"pitch": why}
    assert guarded.last["pitch"] == kept
    assert guarded.last["middle"] > 72
    guarded.step({"pitch": 20.0, "middle": 80.0, "top": 63.0}, DT)
    assert guarded.rejected == {}
    assert guarded.last["pitch"] > kept


@pytest.mark.toolkit("R4")
def test_missing_and_unknown_joints_are_told() -> None:
    guarded = safety()
    before = guarded.last
    after = guarded.step({"pitch": 5.0, "middle": 72.0, "tail": 3.0}, DT)
    assert guarded.rejected == {"top": "is missing", "tail": "there is no such joint"}
    assert set(after) == set(before)
    assert after["top"] == before["top"]


@pytest.mark.toolkit("R4")
@pytest.mark.parametrize("dt", [0.0, -1.0, math.nan, -math.inf])
def test_no_time_no_move(dt: float) -> None:
    guarded = safety()
    before = dict(guarded.last)
    assert guarded.step({"pitch": 50.0, "middle": 0.0, "top": 0.0}, dt) == before


@pytest.mark.toolkit("R4")
@pytest.mark.parametrize("dt", [5.0, 1e300, math.inf])
def test_a_process_that_slept_goes_on_from_where_it_stood(dt: float) -> None:
    guarded = one(None)
    assert guarded.step({"j": 90.0}, dt)["j"] <= 360 * LONGEST_S


@pytest.mark.parametrize("acceleration", [None, 500.0])
def test_a_limp_joint_out_of_range_may_only_come_back_in(acceleration: float | None) -> None:
    guarded = one(acceleration)
    guarded.restart({"j": 120.0})
    assert guarded.last == {"j": 120.0}
    assert guarded.step({"j": 150.0}, DT)["j"] == 120.0
    assert guarded.step({"j": math.nan}, DT)["j"] == 120.0
    way = [guarded.step({"j": 0.0}, DT)["j"] for _ in range(20)]
    assert all(0 <= a - b <= 360 * DT + EPS for a, b in zip([120.0, *way], way, strict=False))
    inside = way[-1]
    assert inside < 120
    for _ in range(200):
        guarded.step({"j": 150.0}, DT)
    assert guarded.last["j"] <= max(90.0, inside)


def test_a_restart_takes_the_joints_as_they_are_and_at_rest() -> None:
    guarded = safety()
    for _ in range(5):
        guarded.step({"pitch": 90.0, "middle": 0.0, "top": 0.0}, DT)
    middle = guarded.last["middle"]
    guarded.restart({"pitch": -30.0, "top": math.nan, "ear": 1.0})
    assert guarded.last["pitch"] == -30.0
    assert guarded.last["middle"] == middle
    assert guarded.rejected == {"top": "nan is no angle", "ear": "there is no such joint"}


def test_a_start_that_is_unknown_is_home() -> None:
    guarded = Safety(eyepi().joints, {"middle": math.nan, "tail": 4.0})
    assert guarded.last == {"pitch": 0.0, "middle": 72.0, "top": 63.0}
    assert set(guarded.rejected) == {"middle", "tail"}


def test_what_left_cannot_be_changed_from_outside() -> None:
    guarded = safety()
    before = guarded.last
    with pytest.raises(TypeError):
        guarded.last["pitch"] = 1000.0  # type: ignore[index]
    guarded.step({"pitch": 90.0, "middle": 0.0, "top": 0.0}, DT)
    assert before["pitch"] == 0.0


@given(st.floats(), st.floats(-300, 300), st.floats())
def test_guard_alone(wanted: float, last: float, elapsed: float) -> None:
    moved = limited_setpoint(Limits(-90, 90, 100), last, wanted, elapsed)
    assert min(-90, last) <= moved <= max(90, last)
    if math.isfinite(elapsed):
        assert abs(moved - last) <= 100 * max(elapsed, 0.0) + EPS


HOSTILE: tuple[object, ...] = (
    *(math.nan, math.inf, -math.inf, 1e300, -1e300, 10**400, -0.0, 5e-324),
    *("", "90", None, True, [], {}, b"1", object(), 1j),
)


def hostile_step(draw: random.Random, names: list[str]) -> tuple[Mapping[str, object], float]:
    wanted: dict[str, object] = {}
    for name in names:
        if draw.random() < 0.9:
            wanted[name] = (
                draw.choice(HOSTILE) if draw.random() < 0.3 else draw.uniform(-1000, 1000)
            )
    if draw.random() < 0.1:
        wanted[draw.choice(["tail", "", "\0", "Pitch"])] = draw.choice(HOSTILE)
    dt = draw.choice(
        [DT, DT, DT, draw.uniform(0, 0.2), 0.0, -3.0, math.nan, math.inf, 1e300, 1e-12]
    )
    return wanted, dt


@pytest.mark.toolkit("R4")
@pytest.mark.parametrize("acceleration", [None, 1500.0])
def test_a_hundred_thousand_hostile_steps(acceleration: float | None) -> None:
    shape = eyepi(acceleration)
    draw = random.Random(20_260)
    guarded = safety(shape)
    names = list(shape.joints)
    limits = [(name, one.min, one.max, one.speed) for name, one in shape.joints.items()]
    last = guarded.last
    for number in range(50_000):
        wanted, dt = hostile_step(draw, names)
        now = guarded.step(wanted, dt)
        counted = min(dt, LONGEST_S) if dt > 0 else 0.0
        for name, low, high, speed in limits:
            assert low <= now[name] <= high
            assert abs(now[name] - last[name]) <= speed * counted + EPS
        if number % 1000 == 999:
            guarded.restart({name: draw.choice((math.nan, 3.0)) for name in names})
        last = guarded.last


@pytest.mark.toolkit("R4", "R6")
@given(bodies(), st.integers(0, 2**32))
def test_bodies_of_five_joints_are_as_safe(shape: BodyShape, seed: int) -> None:
    draw = random.Random(seed)
    guarded = safety(shape)
    last = guarded.last
    for _ in range(100):
        wanted, dt = hostile_step(draw, list(shape.joints))
        now = guarded.step(wanted, dt)
        for name, joint in shape.joints.items():
            assert joint.min <= now[name] <= joint.max
            counted = min(dt, LONGEST_S) if dt > 0 else 0.0
            assert abs(now[name] - last[name]) <= joint.speed * counted + EPS
        last = now
