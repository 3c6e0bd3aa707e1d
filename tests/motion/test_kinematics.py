"""Forward kinematics against matrices and hand-computed poses; gazes that meet their targets."""

from __future__ import annotations

import math
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.example_counts import many
from tests.motion.chains import bodies, by_matrices, eyepi, missed_deg
from woz_tui.motion.body_shape import BodyShape, FaceShape
from woz_tui.motion.kinematics import KinematicChain, body_outline

SHAPE = eyepi()
CHAIN = KinematicChain(SHAPE)
HOME = {name: joint.home for name, joint in SHAPE.joints.items()}
# Base to pitch (0.02, 0, 0.04), pitch to middle (0.02, 0, 0.03), middle to top 0.08 forward.
REFERENCE = {
    "all zero": ((0, 0, 0), (0.12, 0, 0.07), (1, 0, 0)),
    "turned left": ((90, 0, 0), (0.02, 0.10, 0.07), (0, 1, 0)),
    "turned right": ((-90, 0, 0), (0.02, -0.10, 0.07), (0, -1, 0)),
    "upright": ((0, 90, 90), (0.04, 0, 0.15), (1, 0, 0)),
    "middle alone": ((0, 90, 0), (0.04, 0, 0.15), (0, 0, 1)),
    "top alone": ((0, 0, 90), (0.12, 0, 0.07), (0, 0, -1)),
}


def fractions(count: int) -> st.SearchStrategy[list[float]]:
    return st.lists(st.floats(0, 1), min_size=count, max_size=count)


def inside(shape: BodyShape, shares: list[float]) -> dict[str, float]:
    return {
        name: joint.min + share * (joint.max - joint.min)
        for (name, joint), share in zip(shape.joints.items(), shares, strict=True)
    }


def in_range(shape: BodyShape, angles: Any) -> bool:
    return set(angles) == set(shape.joints) and all(
        joint.min <= angles[name] <= joint.max for name, joint in shape.joints.items()
    )


@pytest.mark.toolkit("V1", "V2")
@pytest.mark.parametrize("pose", REFERENCE)
def test_reference_poses(pose: str) -> None:
    angles, end, gaze = REFERENCE[pose]
    joints = dict(zip(SHAPE.joints, angles, strict=True))
    assert CHAIN.points(joints)[-1] == pytest.approx(end, abs=1e-9)
    origin, direction = CHAIN.ray(joints)
    assert origin == pytest.approx(end, abs=1e-9)
    assert direction == pytest.approx(gaze, abs=1e-9)


@pytest.mark.toolkit("V1", "R6")
@given(bodies(), fractions(5))
def test_links_stand_where_matrices_put_them(shape: BodyShape, shares: list[float]) -> None:
    angles = inside(shape, shares)
    places, gaze = by_matrices(shape, angles)
    points = KinematicChain(shape).points(angles)
    assert len(points) == len(shape.joints) + 2
    assert np.abs(np.array(points) - np.array(places)).max() < 1e-9  # metres
    assert np.abs(np.array(KinematicChain(shape).ray(angles)[1]) - gaze).max() < 1e-9


@pytest.mark.toolkit("L5")
@given(fractions(3), st.floats(0.3, 20), fractions(3))
def test_what_a_pose_looks_at_is_found_from_any_other(
    shares: list[float], far: float, begin: list[float]
) -> None:
    eyes, gaze = CHAIN.ray(inside(SHAPE, shares))
    target = tuple(e + far * g for e, g in zip(eyes, gaze, strict=True))
    aim = CHAIN.aim_at((target[0], target[1], target[2]), inside(SHAPE, begin))
    assert in_range(SHAPE, aim.joints)
    assert aim.reachable
    assert missed_deg(*CHAIN.ray(aim.joints), target) < 2
    assert missed_deg(*CHAIN.ray(aim.joints), target) == pytest.approx(aim.error_deg, abs=0.01)


@pytest.mark.toolkit("L5", "R6")
@given(bodies(), fractions(5), st.floats(1, 20))
def test_five_joints_find_what_they_can_see(
    shape: BodyShape, shares: list[float], far: float
) -> None:
    chain = KinematicChain(shape)
    eyes, gaze = chain.ray(inside(shape, shares))
    target = tuple(e + far * g for e, g in zip(eyes, gaze, strict=True))
    aim = chain.aim_at((target[0], target[1], target[2]), {})
    assert in_range(shape, aim.joints)
    assert missed_deg(*chain.ray(aim.joints), target) < 2


@pytest.mark.toolkit("L5", "R6")
@given(bodies(3), st.tuples(*[st.floats(-5, 5)] * 3), fractions(3))
def test_wherever_the_target_is_the_pose_is_in_range_and_its_error_true(
    shape: BodyShape, target: tuple[float, float, float], begin: list[float]
) -> None:
    chain = KinematicChain(shape)
    start = inside(shape, begin)
    if math.dist(chain.ray(start)[0], target) < 0.05:
        return
    aim = chain.aim_at(target, start)
    assert in_range(shape, aim.joints)
    assert aim.reachable == (aim.error_deg <= 0.1)
    assert missed_deg(*chain.ray(start), target) >= aim.error_deg - 0.01
    if math.dist(chain.ray(aim.joints)[0], target) > 0.05:
        assert missed_deg(*chain.ray(aim.joints), target) == pytest.approx(aim.error_deg, abs=0.01)


@pytest.mark.toolkit("L5")
def test_the_nearest_pose_to_what_is_behind() -> None:
    aim = CHAIN.aim_at((-3.0, 1.0, 0.2), HOME)
    assert not aim.reachable
    assert in_range(SHAPE, aim.joints)
    assert aim.joints["pitch"] == pytest.approx(90, abs=0.5)  # as far to its left as it gets
    poses = [
        {"pitch": float(pitch), "middle": float(middle), "top": float(top)}
        for pitch in range(-90, 91, 15)
        for middle in range(0, 91, 15)
        for top in range(0, 91, 15)
    ]
    best = min(missed_deg(*CHAIN.ray(pose), (-3.0, 1.0, 0.2)) for pose in poses)
    assert aim.error_deg <= best + 0.5


@pytest.mark.parametrize(("yaw", "pitch"), [(0, 0), (30, 10), (-60, -40), (89, 60), (0, -85)])
def test_along_a_direction(yaw: float, pitch: float) -> None:
    aim = CHAIN.aim_along(yaw, pitch, HOME)
    assert aim.reachable
    _, (x, y, z) = CHAIN.ray(aim.joints)
    assert math.degrees(math.atan2(y, x)) == pytest.approx(yaw, abs=0.3)
    assert math.degrees(math.asin(z)) == pytest.approx(pitch, abs=0.2)


def test_a_direction_that_no_pose_has() -> None:
    aim = CHAIN.aim_along(120, 0, HOME)
    assert not aim.reachable
    assert aim.error_deg == pytest.approx(30, abs=0.5)


@pytest.mark.toolkit("L5")
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e300])
def test_no_point_in_space(bad: float) -> None:
    with pytest.raises(ValueError, match="no point in space"):
        CHAIN.aim_at((1.0, bad, 0.0), HOME)


@pytest.mark.toolkit("L5")
def test_the_head_cannot_look_at_itself() -> None:
    with pytest.raises(ValueError, match="at the head itself"):
        CHAIN.aim_at(CHAIN.ray(HOME)[0], HOME)


@pytest.mark.parametrize(("yaw", "pitch"), [(math.nan, 0.0), (0.0, math.inf)])
def test_no_direction(yaw: float, pitch: float) -> None:
    with pytest.raises(ValueError, match="no direction"):
        CHAIN.aim_along(yaw, pitch, HOME)


def test_a_start_out_of_range_or_without_numbers_is_put_in_range() -> None:
    aim = CHAIN.aim_along(20, 0, {"pitch": 400.0, "top": math.nan})
    assert aim.reachable
    assert in_range(SHAPE, aim.joints)


@given(bodies(4), fractions(4))
@settings(max_examples=many(20))
def test_an_outline_carries_the_whole_chain(shape: BodyShape, shares: list[float]) -> None:
    angles = inside(shape, shares)
    copy = KinematicChain.of_outline(msgspec.json.decode(msgspec.json.encode(body_outline(shape))))
    assert copy.points(angles) == KinematicChain(shape).points(angles)
    assert copy.ray(angles) == KinematicChain(shape).ray(angles)
    assert [(link.name, link.low, link.high, link.home) for link in copy.links] == [
        (name, joint.min, joint.max, joint.home) for name, joint in shape.joints.items()
    ]


def test_an_outline_says_how_large_the_face_is() -> None:
    assert body_outline(SHAPE)["face"] is None
    faced = BodyShape(joints=SHAPE.joints, face=FaceShape())
    assert body_outline(faced)["face"] == {"width": 24, "height": 16}


@pytest.mark.parametrize(
    "wrong",
    [
        None,
        [],
        {"joints": 3, "eyes": [0, 0, 0], "view": "x"},
        {"joints": [], "eyes": [0, 0], "view": "x"},
        {"joints": [], "eyes": [0, 0, 0], "view": "up"},
        {"joints": [{"name": "a"}], "eyes": [0, 0, 0], "view": "x"},
    ],
)
def test_what_is_no_outline(wrong: Any) -> None:
    with pytest.raises(ValueError, match=r"outline|values to unpack"):
        KinematicChain.of_outline(wrong)
