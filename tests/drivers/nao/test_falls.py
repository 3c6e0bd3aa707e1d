"""A NAO that falls: told at once, left alone until it is up again, and stopped as ever."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
import pytest_asyncio
from woz_drivers.nao.falls import FALLEN, FALLING, KEYS

from tests.drivers.pepper.connection_rig import patience
from tests.drivers.pepper.robot_rig import RobotRig, connected_driver, connected_robot, settings_for
from tests.fakes.naoqi import stand_in
from woz_tui.drivers.contract import DriverError, RejectedError
from woz_tui.protocol.messages import DriverConnected, DriverFaulted, Notice

pytestmark = pytest.mark.asyncio(loop_scope="module")

#: What is sent to a robot by verbs that would move it.
MOTION = (
    *(f"ALMotion.{one}" for one in ("moveTo", "setAngles", "angleInterpolation", "wakeUp", "rest")),
    *("ALMotion.setStiffnesses", "ALAnimationPlayer.run", "ALAnimatedSpeech.say"),
    *("ALAutonomousLife.setState", "ALRobotPosture.goToPosture"),
)


@pytest.fixture(autouse=True)
def soon_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """It need not stand for a whole second before it counts as up."""
    monkeypatch.setattr("woz_drivers.nao.falls.UPRIGHT_US", 50_000)


@pytest_asyncio.fixture(loop_scope="module")
async def fallen(robot_rig: RobotRig) -> AsyncIterator[RobotRig]:
    """It lies, and the wizard knows; up again afterwards."""
    await robot_rig.robot.fault("fall")
    await robot_rig.published.first(DriverFaulted)
    await robot_rig.robot.clear()
    yield robot_rig
    await robot_rig.do("posture", name="Stand", speed=1.0)
    await robot_rig.published.first(DriverConnected)


async def test_a_fall_is_told_with_a_remedy_and_so_is_the_rising(robot_rig: RobotRig) -> None:
    assert robot_rig.published.values("fallen")[-1:] in ([], [0.0])
    await robot_rig.robot.fault("fall:back")
    faulted = await robot_rig.published.first(DriverFaulted)
    assert "fallen" in faulted.detail
    assert "posture: Stand" in faulted.remedy
    assert robot_rig.published.values("fallen")[-1] == 1.0
    await robot_rig.tells(lambda settings_shown: "fallen" in "".join(settings_shown.conflicts[:1]))
    told = [one for one in robot_rig.published.all(Notice) if one.level == "error"]
    assert len(told) == 1
    assert "posture: Stand" in told[0].remedy
    await robot_rig.do("posture", name="Stand", speed=1.0)
    await robot_rig.published.first(DriverConnected)
    await robot_rig.published.until(lambda: robot_rig.published.values("fallen")[-1] == 0.0)
    assert await robot_rig.robot.get(f"memory:{FALLEN}") is False
    await robot_rig.do("drive", x=0.05)


MOVING: list[tuple[str, dict[str, Any]]] = [
    ("drive", {"x": 0.1}),
    ("gaze", {"yaw": 10}),
    ("nudge", {"yaw": 10}),
    ("play", {"move": "Hey_1"}),
    ("pose", {"joints": {"RShoulderPitch": 0}}),
    ("torque", {"on": True}),
    ("torque", {"on": False}),
    ("naoqi", {"call": "ALMotion.openHand", "args": '["LHand"]'}),
    ("naoqi", {"call": "ALRobotPosture.goToPosture", "args": '["Sit", 0.5]'}),
    ("autonomy", {"state": "interactive"}),
]


async def test_no_motion_is_sent_to_it(fallen: RobotRig) -> None:
    for verb, args in MOVING:
        with pytest.raises(DriverError, match="fallen") as raised:
            await fallen.do(verb, **args)
        assert "posture: Stand" in raised.value.remedy
    assert await fallen.calls(*MOTION) == []


async def test_everything_else_works(fallen: RobotRig) -> None:
    await fallen.do("say", text="Ouch.")
    assert await fallen.calls("ALTextToSpeech.say") == [("Ouch.",)]
    assert await fallen.calls("ALAnimatedSpeech.say") == []
    await fallen.do("eyes", color="red")
    await fallen.do("volume", level=0.5)
    await fallen.do("naoqi", call="ALMotion.getAngles", args='["HeadYaw", true]')


async def test_the_stop_still_works(fallen: RobotRig) -> None:
    report = await fallen.stop()
    assert report.missing == ()
    assert {"walking", "motion", "speech"} <= set(report.confirmed)
    await fallen.driver.resume()


async def test_left_alone_it_is_left_as_it_lies(fallen: RobotRig) -> None:
    await fallen.driver.rest()
    assert await fallen.calls(*MOTION) == []


async def test_home_gets_it_up_too(fallen: RobotRig) -> None:
    await fallen.do("home")
    assert await fallen.robot.get("posture") == "Stand"


async def test_a_fall_in_the_middle_of_a_walk_ends_it_with_that_reason(robot_rig: RobotRig) -> None:
    walk = robot_rig.begin("drive", x=5.0)
    await robot_rig.robot.called("ALMotion.moveTo")
    await robot_rig.robot.fault("fall")
    with pytest.raises(DriverError, match="fallen"):
        await walk
    await robot_rig.published.first(DriverFaulted)
    await robot_rig.do("posture", name="Stand", speed=1.0)
    await robot_rig.published.first(DriverConnected)


async def test_who_lifts_it_ends_that_too(robot_rig: RobotRig) -> None:
    await robot_rig.robot.fault("fall")
    await robot_rig.published.first(DriverFaulted)
    with pytest.raises(RejectedError):
        await robot_rig.do("drive", x=0.1)
    await robot_rig.robot.set("posture", "Crouch")
    await robot_rig.published.first(DriverConnected)
    await robot_rig.do("torque", on=True)
    await robot_rig.do("home")


async def test_a_fall_is_believed_before_the_posture_knows_of_it(robot_rig: RobotRig) -> None:
    await robot_rig.robot.set(f"memory:{FALLING}", True)
    await robot_rig.published.first(DriverFaulted)
    assert await robot_rig.robot.get("posture") == "Stand"
    await robot_rig.published.first(DriverConnected)


async def test_nonsense_about_a_fall_is_told_and_changes_nothing(robot_rig: RobotRig) -> None:
    await robot_rig.robot.set(f"memory:{FALLEN}", "perhaps")
    await robot_rig.published.state("fallen", "stale")
    assert robot_rig.published.all(DriverFaulted) == []
    await robot_rig.do("gaze", yaw=5)
    await robot_rig.robot.set(f"memory:{FALLEN}", False)
    await robot_rig.published.state("fallen", "ok")


async def test_who_lies_when_it_is_found_is_not_moved(tmp_path: Path) -> None:
    with patience():
        async with stand_in(options=("--robot", "nao")) as robot:
            await robot.fault("fall")
            await robot.clear()
            naoqi_settings = settings_for("nao", robot.address)
            rig = await connected_driver(robot, tmp_path, naoqi_settings, DriverFaulted)
            try:
                with pytest.raises(DriverError, match="fallen"):
                    await rig.do("gaze", yaw=5)
                assert await rig.calls(*MOTION) == []
            finally:
                await rig.close()


async def test_a_fall_of_yesterday_is_no_fall(tmp_path: Path) -> None:
    """Nothing on the robot takes the values back; its posture says that it stands."""
    async with connected_robot(tmp_path, kind="nao") as rig:
        for key in KEYS:
            await rig.robot.set(f"memory:{key}", True)
        robot_rig = await connected_driver(
            rig.robot, tmp_path, settings_for("nao", rig.robot.address)
        )
        try:
            assert await rig.robot.get(f"memory:{FALLING}") is False
            await robot_rig.do("gaze", yaw=5)
            assert robot_rig.published.all(DriverFaulted) == []
        finally:
            await robot_rig.close()
