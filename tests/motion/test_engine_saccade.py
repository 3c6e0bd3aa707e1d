"""Saccade following: the eyes first, then the head."""

from __future__ import annotations

import itertools
from dataclasses import replace

import pytest

from tests.motion.bodies import CALM, DT, EYEPI, FIVE, STILL, Rig, moves_safely
from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.engine_io import Tick
from woz_tui.motion.kinematics import KinematicChain
from woz_tui.motion.light_frames import LightFrame
from woz_tui.motion.modes import Mode
from woz_tui.motion.pose_sources import SPAN, gaze_direction
from woz_tui.protocol.messages import Json

#: Degrees that the eyes turn for one light sideways: they go three lights for 15 degrees.
DEGREES_A_LIGHT = 5.0


def eyes(frame: LightFrame | None) -> float:
    """By how many lights the eyes are beside their middle, to the robot's left."""
    assert frame is not None
    columns = [x for x in range(frame.width) for y in range(frame.height) if frame.lit(x, y)]
    return sum(columns) / len(columns) - (frame.width - 1) / 2


def started_rig(shape: BodyShape = STILL) -> Rig:
    rig = Rig(shape)
    rig.do("mode", mode="saccade")
    rig.run(1.0)
    return rig


def look_towards(yaw: float) -> dict[str, Json]:
    return {"x": yaw / SPAN[0], "y": 0.0}


@pytest.mark.toolkit("S1")
@pytest.mark.parametrize("yaw", [14.0, -14.0, 7.0])
def test_eyes_jump_the_head_follows_and_the_gaze_stays(yaw: float) -> None:
    rig = started_rig()
    before = rig.last
    rig.do("look", **look_towards(yaw))
    ticks = rig.run(3.0)
    assert eyes(ticks[0].face) == pytest.approx(yaw / DEGREES_A_LIGHT, abs=0.8)
    pitch = [tick.joints["pitch"] for tick in ticks]
    assert all(abs(b) >= abs(a) for a, b in itertools.pairwise(pitch))  # no overshoot
    assert pitch[-1] == pytest.approx(yaw, abs=0.1)
    reached = next(i for i, angle in enumerate(pitch) if abs(angle) >= 0.9 * abs(yaw)) * DT
    assert 0.2 <= reached <= 2.3  # 2.3 time constants: one of 0.1 to 1 s
    assert eyes(ticks[-1].face) == pytest.approx(eyes(before.face), abs=0.5)
    assert moves_safely(STILL, ticks)


@pytest.mark.toolkit("S1")
@pytest.mark.parametrize(("yaw", "pitch"), [(14.0, 0.0), (-10.0, 12.0), (3.0, -15.0)])
@pytest.mark.parametrize("alive", [False, True])
def test_head_and_eyes_together_look_at_the_target_all_the_way(
    yaw: float, pitch: float, alive: bool
) -> None:
    shape = EYEPI if alive else STILL
    rig = started_rig(shape)
    chain = KinematicChain(shape)
    ahead = gaze_direction(chain, {n: (j.start or 0.0) for n, j in shape.joints.items()})
    rig.do("look", x=yaw / SPAN[0], y=pitch / SPAN[1])
    for _ in range(150):
        tick = rig.tick()
        lead = rig.engine.eyes
        head = gaze_direction(chain, tick.joints)
        assert head[0] + lead[0] * shape.saccade[0] - ahead[0] == pytest.approx(yaw, abs=2.0)
        assert head[1] + lead[1] * shape.saccade[1] - ahead[1] == pytest.approx(pitch, abs=2.0)


@pytest.mark.toolkit("S2")
def test_a_new_step_on_the_way_is_no_jump() -> None:
    rig = started_rig()
    ticks: list[Tick] = []
    for yaw in (40.0, -40.0, 10.0, 59.0):
        rig.do("look", **look_towards(yaw))
        ticks += rig.run(0.2)
    ticks += rig.run(3.0)
    assert moves_safely(STILL, ticks)
    assert rig.last.joints["pitch"] == pytest.approx(59.0, abs=0.2)


@pytest.mark.toolkit("S2")
def test_beyond_the_last_joint_the_eyes_keep_the_rest() -> None:
    rig = Rig(STILL)
    rig.wait(rig.do("pose", joints={"pitch": 80.0}))
    rig.do("mode", mode="saccade")
    rig.run(0.5)
    rig.do("look", **look_towards(20.0))
    rig.run(4.0)
    assert rig.last.joints["pitch"] == pytest.approx(90.0, abs=0.2)
    assert rig.engine.eyes[0] == pytest.approx(10 / 15, abs=0.05)


@pytest.mark.toolkit("S1", "M2")
def test_the_knob_leads_as_the_verb_does_and_leaving_centres_the_eyes() -> None:
    rig = started_rig()
    rig.do("control", control="eye-x", value=0.75)
    rig.run(3.0)
    assert rig.last.joints["pitch"] == pytest.approx(SPAN[0] / 2, abs=0.2)
    assert rig.engine.state().controls["eye-x"] == pytest.approx(0.75)
    rig.do("mode", mode="normal")
    rig.run(2.0)
    assert rig.last.mode is Mode.NORMAL
    assert rig.last.joints["pitch"] == pytest.approx(0.0)
    assert rig.engine.eyes == (0.0, 0.0)


@pytest.mark.toolkit("S1")
def test_the_same_place_of_the_eyes_is_the_same_pose_each_time() -> None:
    rig = started_rig(replace(FIVE, personality=CALM))
    begun = dict(rig.last.joints)
    poses = []
    for x, y in ((0.5, 0.2), (-1.0, 0.9), (0.5, 0.2), (0.0, 0.0)):
        rig.do("look", x=x, y=y)
        rig.run(5.0)
        poses.append(dict(rig.last.joints))
    assert poses[2] == pytest.approx(poses[0], abs=1e-3)
    assert poses[3] == pytest.approx(begun, abs=1e-3)


@pytest.mark.toolkit("S1")
def test_it_begins_by_following_the_eyes_that_look_aside() -> None:
    rig = Rig(STILL)
    rig.do("look", x=0.8)
    before = rig.run(0.2)[-1]
    rig.do("mode", mode="saccade")
    assert eyes(rig.tick().face) == pytest.approx(eyes(before.face), abs=1.0)
    rig.run(3.0)
    assert rig.last.joints["pitch"] == pytest.approx(0.8 * 15, abs=0.2)
    assert eyes(rig.last.face) == pytest.approx(0.0, abs=0.5)


@pytest.mark.toolkit("S1", "P1")
def test_a_shy_and_slow_body_hits_its_target_all_the_same() -> None:
    rig = Rig(STILL)
    rig.do("personality", compression=0.6, smoothing=1.0)
    rig.run(3.0)
    rig.do("mode", mode="saccade")
    rig.run(3.0)
    before = rig.last.joints["pitch"]
    rig.do("look", **look_towards(30.0))
    rig.run(3.0)
    assert rig.last.joints["pitch"] == pytest.approx(before + 30.0, abs=0.5)
    assert rig.engine.eyes[0] == pytest.approx(0.0, abs=0.05)
    rig.do("mode", mode="normal")
    rig.run(6.0)
    assert rig.last.joints["top"] == pytest.approx(45 + 0.4 * (28.65 - 45), abs=0.1)


@pytest.mark.toolkit("S1", "L8")
def test_while_it_breathes_the_eyes_rest_within_half_a_light() -> None:
    rig = started_rig(EYEPI)
    offsets, tops = [], []
    for _ in range(500):
        rig.tick()
        offsets += [abs(3 * offset) for offset in rig.engine.eyes]  # three lights each way
        tops.append(rig.last.joints["top"])
    assert max(offsets) <= 0.5
    assert max(tops) - min(tops) > 1.0
