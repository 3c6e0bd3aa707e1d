"""The simulated body: limits and speeds hold whatever is asked of it."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.simulated import SimulatedJoint
from woz_drivers.simulated.body import SimulatedRobotBody
from woz_drivers.simulated.faults import ActiveFaults

JOINTS = {"pan": SimulatedJoint(-90, 90, 100), "tilt": SimulatedJoint(-30, 40, 50)}

degrees = st.floats(-1000, 1000)
moments = st.floats(0, 3)


@given(
    st.lists(
        st.tuples(
            moments,
            st.sampled_from(["go", "jump", "trace", "freeze"]),
            st.dictionaries(st.sampled_from(["pan", "tilt"]), degrees, min_size=1),
            moments,
        ),
        max_size=15,
    )
)
def test_no_joint_leaves_its_limits_or_turns_faster_than_it_can(
    orders: list[tuple[float, str, dict[str, float], float]],
) -> None:
    body = SimulatedRobotBody(JOINTS)
    now = 0.0
    for pause, order, goals, seconds in orders:
        match order:
            case "go":
                body.go(goals, seconds)
            case "jump":
                body.jump(goals)
            case "trace":
                body.trace([(seconds, goals), (seconds * 2, goals)])
            case _:
                body.freeze()
        before = {name: joint.present for name, joint in body.joints.items()}
        body.advance(now + pause)
        for name, joint in body.joints.items():
            low, high = joint.limits.low, joint.limits.high
            assert low <= joint.present <= high
            assert low <= joint.setpoint <= high
            assert abs(joint.present - before[name]) <= joint.limits.speed * pause + 1e-6
        now += pause


def test_a_frozen_body_stays_where_it_is() -> None:
    body = SimulatedRobotBody(JOINTS)
    body.go({"pan": 80}, 2.0)
    body.advance(1.0)
    body.freeze()
    stopped = body.joints["pan"].present
    assert 0 < stopped < 80
    body.advance(10.0)
    assert body.joints["pan"].present == stopped
    assert body.joints["pan"].setpoint == stopped
    assert not body.moving


def test_a_pose_takes_the_time_asked_for_or_the_time_it_needs() -> None:
    body = SimulatedRobotBody(JOINTS)
    assert body.go({"pan": 10}, 2.0) == 2.0
    body = SimulatedRobotBody(JOINTS)
    needed = body.go({"pan": 90}, 0.0)
    assert needed == pytest.approx(90 / 100 * math.pi / 2)
    body.advance(needed + 0.1)
    assert body.joints["pan"].present == pytest.approx(90, abs=0.1)
    assert not body.moving


def test_the_base_drives_in_the_direction_it_looks() -> None:
    body = SimulatedRobotBody(JOINTS)
    body.base.drive(0.0, 1.0, 0.0, 0.0, 90.0)
    body.advance(1.0)
    body.base.drive(1.0, 2.0, 1.0, 0.0, 0.0)
    body.advance(2.0)
    assert [body.base.x, body.base.y] == pytest.approx([0, 0.5])
    body.advance(3.0)
    assert [body.base.x, body.base.y] == pytest.approx([0, 1])
    assert body.base.heading == pytest.approx(90)
    assert not body.base.moving


def test_a_joint_whose_home_lies_outside_its_limits_is_refused() -> None:
    with pytest.raises(ValueError, match="must rise"):
        SimulatedJoint(low=10, high=90, home=0)


def test_faults_hold_for_their_part_and_their_time() -> None:
    faults = ActiveFaults()
    faults.add("refuse", 2.0, "voice", 10.0)
    faults.add("fail", 0.0, "", 10.0)
    assert faults.holding("refuse", "voice", 9.9) is None
    assert faults.holding("refuse", "voice", 10.0) is not None
    assert faults.holding("refuse", "body", 10.0) is None
    assert faults.holding("refuse", "", 10.0) is None
    assert faults.holding("refuse", "voice", 12.0) is None
    faults.expire(1000.0)
    assert faults.use_up("fail", "body", 1000.0) is not None
    assert faults.use_up("fail", "body", 1000.0) is None
