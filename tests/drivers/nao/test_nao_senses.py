"""What a NAO feels: touches, sonars, the warmth of its motors, its battery."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.nao import hot_motors
from woz_drivers.nao.hot_motors import EVERY_S, MotorWatch
from woz_drivers.naoqi_robot.memory import BATTERY

from tests.drivers.pepper.robot_rig import RobotRig
from tests.drivers.published_messages import PublishedMessages
from woz_tui.protocol.messages import Notice, SensorChanged

pytestmark = pytest.mark.asyncio(loop_scope="module")

KNEE = "Device/SubDeviceList/LKneePitch/Temperature/Sensor"


async def reads(rig: RobotRig, sensor: str, value: float | None) -> None:
    await rig.published.until(lambda: rig.published.values(sensor)[-1:] == [value])


@pytest.mark.parametrize(
    ("part", "sensor"),
    [
        ("Head/Touch/Front", "touch.head.front"),
        ("Head/Touch/Middle", "touch.head.middle"),
        ("Head/Touch/Rear", "touch.head.rear"),
        ("LHand/Touch/Back", "touch.hand.left"),
        ("RHand/Touch/Right", "touch.hand.right"),
        ("LFoot/Bumper/Left", "bumper.left"),
        ("RFoot/Bumper/Right", "bumper.right"),
        ("ChestBoard/Button", "button"),
    ],
)
async def test_a_touch_comes_and_goes(robot_rig: RobotRig, part: str, sensor: str) -> None:
    await robot_rig.robot.set("touched", [part])
    await reads(robot_rig, sensor, 1.0)
    await robot_rig.robot.set("touched", [])
    await reads(robot_rig, sensor, 0.0)


async def test_two_sonars_and_the_nearest_of_both(robot_rig: RobotRig) -> None:
    await robot_rig.robot.person({"distance": 0.7, "angle": 0.6})
    await reads(robot_rig, "distance.left", 0.7)
    await reads(robot_rig, "distance.right", 5.0)
    await reads(robot_rig, "distance", 0.7)
    await robot_rig.robot.person(None)
    await reads(robot_rig, "distance", 5.0)


async def test_a_sonar_that_says_nonsense_leaves_the_other(robot_rig: RobotRig) -> None:
    await robot_rig.robot.set("front", 0.9)
    await reads(robot_rig, "distance", 0.9)
    key = "Device/SubDeviceList/US/Left/Sensor/Value"
    await robot_rig.robot.set(f"memory:{key}", "near")
    await robot_rig.published.state("distance.left", "stale")
    await reads(robot_rig, "distance.left", None)
    await reads(robot_rig, "distance", 0.9)


# -- motors and battery, without a robot -----------------------------------------------------------


def watched(published: PublishedMessages, watch: MotorWatch, **celsius: tuple[float, int]) -> None:
    values: dict[str, Any] = {}
    for joint, (degrees, status) in celsius.items():
        key = f"Device/SubDeviceList/{joint}/Temperature/Sensor"
        values |= {f"{key}/Value": degrees, f"{key}/Status": status}
    watch.take(values)


def notices(published: PublishedMessages) -> list[str]:
    return [one.text for one in published.all(Notice)]


async def test_a_hot_motor_is_warned_of_once_and_again_when_it_is_hotter(tmp_path: Path) -> None:
    published = PublishedMessages(tmp_path)
    watch = MotorWatch(published.context)
    watched(published, watch, LKneePitch=(60.0, 0), RKneePitch=(58.0, 0))
    assert published.values("temperature") == [60.0]
    assert [(one.state, one.every_s) for one in published.all(SensorChanged)] == [("ok", EVERY_S)]
    assert notices(published) == []
    for _ in range(3):
        watched(published, watch, LKneePitch=(76.0, 1), RKneePitch=(75.0, 1))
    assert len(notices(published)) == 1
    assert "LKneePitch is hot (76 degrees), RKneePitch is hot (75" in notices(published)[0]
    assert "sit" in published.all(Notice)[0].remedy
    watched(published, watch, LKneePitch=(86.0, 3), RKneePitch=(75.0, 1))
    assert len(notices(published)) == 2
    assert "LKneePitch is critically hot" in notices(published)[1]
    assert "RKneePitch" not in notices(published)[1]
    watched(published, watch, LKneePitch=(60.0, 0), RKneePitch=(60.0, 0))
    watched(published, watch, LKneePitch=(76.0, 1), RKneePitch=(60.0, 0))
    assert len(notices(published)) == 3


async def test_a_low_battery_is_warned_of_at_each_limit(tmp_path: Path) -> None:
    published = PublishedMessages(tmp_path)
    watch = MotorWatch(published.context)
    for charge in (0.5, 0.21, 0.19, 0.19, 0.15, 0.09, 0.05):
        watch.take({BATTERY: charge})
    assert [one.split()[-2] for one in notices(published)] == ["19", "9"]


@given(
    st.dictionaries(
        st.sampled_from(hot_motors.keys()),
        st.one_of(
            st.none(),
            st.booleans(),
            st.text(max_size=3),
            st.floats(),
            st.integers(),
            st.lists(st.none()),
        ),
    )
)
async def test_nothing_that_a_robot_says_of_its_motors_raises(values: dict[str, Any]) -> None:
    published = PublishedMessages(Path())
    MotorWatch(published.context).take(values)
    told = published.values("temperature")
    assert len(told) == 1
    assert told[0] is None or -20 <= told[0] <= 150


async def test_a_motor_of_the_robot_grows_hot(robot_rig: RobotRig) -> None:
    await robot_rig.robot.set("temperatures", {"RShoulderPitch": 81})
    await reads(robot_rig, "temperature", 81.0)
    assert "RShoulderPitch is very hot" in robot_rig.notices[-1]
    await robot_rig.tells(
        lambda settings_shown: "RShoulderPitch" in " ".join(settings_shown.conflicts)
    )
    await robot_rig.robot.set("temperatures", {"RShoulderPitch": 40})
    await reads(robot_rig, "temperature", 40.0)
