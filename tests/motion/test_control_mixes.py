"""Controls that a body's file makes of joints, roles and eyes; `zoom` is the first of them."""

from __future__ import annotations

import random
from dataclasses import replace
from typing import Any

import pytest
from woz_drivers.body.settings import BodySettings

from tests.motion.bodies import CALM, EYEPI, FIVE, STILL, Rig
from woz_tui.motion.body_shape import FaceShape
from woz_tui.motion.joint_control import DesiredPose
from woz_tui.motion.modes import Mode

CURIOUS = {"lean": 1.0, "nod": 0.5, "eye-y": 0.3}
SHY = {"pan": -0.4, "neck": 0.5, "lean": -1.0, "eye-x": -1.0}
MIXED = replace(
    FIVE,
    personality=CALM,
    face=FaceShape(),
    zoom={"low": 1, "high": -0.6},
    controls={"curious": CURIOUS, "shy": SHY},
)


@pytest.mark.toolkit("X1")
def test_a_control_moves_roles_and_eyes_by_their_shares() -> None:
    rig = Rig(MIXED)
    before = dict(rig.run(0.5)[-1].joints)
    rig.do("control", control="curious", value=0.6)
    tick = rig.run(1.0)[-1]
    moved = {name: tick.joints[name] - before[name] for name in before}
    # lean is `low` alone; half of nod is 0.35 of `head` and 0.15 of `high`.
    assert moved["head"] == pytest.approx(0.35 * moved["low"], abs=0.01)
    assert moved["high"] == pytest.approx(0.15 * moved["low"], abs=0.01)
    assert moved["base"] == moved["neck"] == pytest.approx(0)
    places = rig.engine.state().controls
    assert places["curious"] == pytest.approx(0.6)
    assert places["eye-y"] == pytest.approx(0.5 + 0.3 * 0.1)


@pytest.mark.toolkit("X1")
def test_in_its_middle_it_leaves_everything_where_it_was() -> None:
    rig = Rig(MIXED)
    before = dict(rig.run(0.5)[-1].joints)
    for place in (0.9, 0.1, 0.5):
        rig.do("control", control="curious", value=place)
        rig.run(0.5)
    assert rig.run(1.0)[-1].joints == pytest.approx(before)


@pytest.mark.toolkit("X1")
def test_the_joints_of_one_stop_together_where_the_first_is_at_its_end() -> None:
    rig = Rig(replace(STILL, controls={"both": {"middle": 1.0, "top": 1.0}}))
    rig.do("control", control="middle", value=0.5)
    rig.do("control", control="top", value=0.9)
    rig.do("control", control="both", value=1.0)
    joints = rig.run(1.0)[-1].joints
    assert joints["top"] == pytest.approx(90)
    assert joints["middle"] == pytest.approx(45 + 9)


def test_by_so_much_it_goes_on_from_where_it_stands() -> None:
    rig = Rig(MIXED)
    for _ in range(3):
        rig.do("control", control="shy", by=0.1)
    assert rig.engine.state().controls["shy"] == pytest.approx(0.8)


def test_in_a_mode_the_joints_wait_and_the_eyes_are_the_modes() -> None:
    rig = Rig(MIXED)
    rig.do("mode", mode=Mode.DEMO.value)
    eyes = rig.engine.state().controls["eye-y"]
    assert rig.do("control", control="curious", value=0.9).sent["waits"] == "normal"
    assert rig.engine.state().controls["eye-y"] == eyes


@pytest.mark.toolkit("X1", "R4")
@pytest.mark.parametrize("seed", range(20))
def test_no_sum_leaves_the_limits(seed: int) -> None:
    """Whatever is turned, aimed and mixed: the pose wanted and every place stay inside."""
    dice = random.Random(seed)
    names = list(MIXED.joints)
    desired = DesiredPose(MIXED, {name: joint.home for name, joint in MIXED.joints.items()})
    for _ in range(400):
        match dice.randrange(3):
            case 0:
                desired.turn(dice.choice(names), dice.random())
            case 1:
                control = dice.choice(("zoom", "curious", "shy"))
                desired.turn_mix(control, dice.choice((0.0, 0.5, 1.0, dice.random())))
            case _:
                aimed = {
                    name: MIXED.joints[name].within(dice.uniform(-150, 150))
                    for name in dice.sample(names, dice.randint(1, len(names)))
                }
                desired.aim(aimed)
                assert {name: desired.pose[name] for name in aimed} == pytest.approx(aimed)
        for name, joint in MIXED.joints.items():
            assert joint.min <= desired.pose[name] <= joint.max
            assert 0.0 <= desired.place(name) <= 1.0
        assert all(0.0 <= mix.place <= 1.0 for mix in desired.mixes.values())


@pytest.mark.toolkit("X1")
@pytest.mark.parametrize("seed", range(20))
def test_other_controls_at_rest_change_zoom_by_no_bit(seed: int) -> None:
    dice = random.Random(seed)
    names = list(EYEPI.joints)
    start = {name: joint.home for name, joint in EYEPI.joints.items()}
    alone = DesiredPose(EYEPI, start)
    among = DesiredPose(replace(EYEPI, controls={"nothing": {"pitch": 0.5, "top": 1}}), start)
    for _ in range(300):
        joint, place = dice.choice(names), dice.random()
        for desired in (alone, among):
            if place < 0.3:
                desired.turn(joint, place)
            elif place < 0.7:
                desired.turn_mix("zoom", (place - 0.3) / 0.4)
            else:
                desired.aim({joint: EYEPI.joints[joint].within(place * 200 - 100)})
        assert dict(alone.pose) == dict(among.pose)
        assert alone.mixes["zoom"].place == among.mixes["zoom"].place


@pytest.mark.parametrize(
    ("controls", "path", "sentence"),
    [
        ({"curious": {"tail": 1.0}}, "controls.curious.tail", "there are pitch, middle, top, pan"),
        ({"curious": {}}, "controls.curious", "moves nothing"),
        ({"pitch": {"top": 1.0}}, "controls.pitch", "a joint is called"),
        ({"zoom": {"top": 1.0}}, "controls.zoom", "has a control 'zoom' already"),
        ({"Very curious": {"top": 1.0}}, "controls.Very curious", ""),
        ({"curious": {"eye-x": 2.0}}, "controls.curious.eye-x", "from -1 to 1"),
    ],
)
def test_what_makes_no_sense_is_named(controls: dict[str, Any], path: str, sentence: str) -> None:
    settings = BodySettings(
        joints=dict(EYEPI.joints), roles=EYEPI.roles, face=FaceShape(), controls=controls
    )
    assert any(where == path and sentence in text for where, text in settings.problems())


def test_eyes_need_a_face() -> None:
    shape = replace(FIVE, face=None, controls={"curious": {"eye-x": 1.0}})
    assert ("controls.curious.eye-x", "it has no face") in shape.problems()
