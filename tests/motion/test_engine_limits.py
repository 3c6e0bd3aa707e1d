"""Ranges and speeds, seen from outside."""

from __future__ import annotations

import pytest

from tests.motion.bodies import BODIES, DT, FIVE, NODDER, STILL, Rig, moves_safely
from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.builtin_moves import BUILT_IN
from woz_tui.motion.engine import Engine


@pytest.mark.toolkit("R1", "L1")
@pytest.mark.parametrize("verb", ["joints", "pose"])
@pytest.mark.parametrize("asked", [-1000, -90.001, -90, 0, 90, 90.001, 1000])
def test_angles_end_where_the_range_ends(verb: str, asked: float) -> None:
    rig = Rig()
    answer = rig.do(verb, joints=dict.fromkeys(STILL.joints, asked))
    rig.run(1.5)
    assert rig.last.joints["pitch"] == pytest.approx(min(90, max(-90, asked)))
    assert rig.last.joints["middle"] == pytest.approx(min(90, max(0, asked)))
    assert rig.last.joints["top"] == pytest.approx(min(90, max(0, asked)))
    outside = {n: asked for n, j in STILL.joints.items() if not j.min <= asked <= j.max}
    assert answer.sent.get("clamped", {}) == outside


@pytest.mark.toolkit("R2", "R5")
@pytest.mark.parametrize(
    ("joint", "least"), [("pitch", 180 / 360), ("middle", 90 / 250), ("top", 90 / 320)]
)
@pytest.mark.parametrize("how", ["joints", "pose", "control"])
def test_a_step_over_the_range_takes_as_long_as_the_speed_asks(
    joint: str, least: float, how: str
) -> None:
    shape = STILL.joints[joint]
    rig = Rig(present={joint: shape.min})
    if how == "control":
        rig.do("control", control=joint, value=1.0)
    else:
        rig.do(how, joints={joint: shape.max})
    ticks = rig.until(lambda tick: tick.joints[joint] >= shape.max - 1e-9)
    assert least - 1e-9 <= len(ticks) * DT <= least + 3 * DT
    assert moves_safely(STILL, ticks)
    if how != "pose":  # what is wanted jumps, where it can be follows
        assert ticks[0].wanted[joint] == shape.max
        assert ticks[0].joints[joint] < shape.max


@pytest.mark.toolkit("R3")
def test_shaking_turns_the_joint_that_pans() -> None:
    rig = Rig()
    ticks = rig.wait(rig.do("play", move="shake"))
    pitch = [tick.joints["pitch"] for tick in ticks]
    assert max(pitch) > 5
    assert min(pitch) < -5
    assert all(tick.joints["middle"] == 45 for tick in ticks)


@pytest.mark.toolkit("R3")
def test_without_a_joint_that_pans_shaking_moves_the_eyes() -> None:
    rig = Rig(NODDER)
    still = rig.last.face
    ticks = rig.wait(rig.do("play", move="shake"))
    assert {tick.joints["chin"] for tick in ticks} == {0.0}
    pictures = {tick.face.hex for tick in ticks if tick.face is not None}
    assert len(pictures) >= 3  # middle, to the left, to the right
    rig.run(0.5)
    assert rig.last.face == still


@pytest.mark.toolkit("R6")
@pytest.mark.parametrize("shape", BODIES.values(), ids=BODIES)
def test_every_body_does_everything(shape: BodyShape) -> None:
    rig = Rig(shape)
    for move in BUILT_IN:
        rig.do("play", move=move)
        assert moves_safely(shape, rig.run(1.0))
    for mode in ("tracking", "saccade", "demo"):
        rig.do("mode", mode=mode)
        assert moves_safely(shape, rig.run(1.0))
        rig.do("mode", mode="normal")
        assert moves_safely(shape, rig.run(0.5))
    rig.do("gaze", yaw=20, pitch=10)
    rig.do("home")
    assert moves_safely(shape, rig.run(2.0))


@pytest.mark.toolkit("R5")
def test_joints_show_where_the_limits_let_them_come() -> None:
    rig = Rig(FIVE)
    rig.do("joints", joints={"base": 120})
    tick = rig.tick()
    assert tick.wanted["base"] - tick.joints["base"] > 100
    rig.do("breathing", on=False)
    rig.run(2.0)
    assert rig.last.wanted == pytest.approx(dict(rig.last.joints))


def test_it_begins_where_the_joints_are() -> None:
    engine = Engine(STILL, BUILT_IN, present={"pitch": 33.0, "top": float("nan"), "foo": 3})
    tick = engine.tick(5.0)
    assert tick.joints == pytest.approx({"pitch": 33.0, "middle": 45.0, "top": 28.65})
    assert engine.tick(6.0).joints == pytest.approx(dict(tick.joints))
    assert engine.state().controls["pitch"] == pytest.approx((33 + 90) / 180)
