"""ALAutonomousLife and the abilities, ALLeds, ALSystem, ALBattery."""

from __future__ import annotations

import asyncio
import json

import pytest

from tests.drivers.naoqi.robot_callers import RobotCallError, SimulatedRobotRig

ABILITIES = (
    "ALBasicAwareness",
    "ALAutonomousBlinking",
    "ALListeningMovement",
    "ALSpeakingMovement",
)
ONE_EYE = [f"RightFaceLed{number}" for number in range(1, 9)]


async def enabled(rig: SimulatedRobotRig) -> list[bool]:
    return [await rig.call(f"{name}.isEnabled") for name in ABILITIES]


async def test_each_state_switches_what_it_does_by_itself(rig: SimulatedRobotRig) -> None:
    assert await enabled(rig) == [True, True, True, True]
    await rig.call("ALAutonomousLife.setState", "safeguard")
    assert await enabled(rig) == [False, False, False, False]
    assert await rig.call("ALAutonomousLife.getState") == "safeguard"
    task = await rig.begin("ALAutonomousLife.setState", "disabled", kind="posture")
    await rig.time.advance(3)
    await rig.done(task)
    assert await enabled(rig) == [False, False, False, True]


async def test_each_state_changes_how_it_engages(rig: SimulatedRobotRig) -> None:
    await rig.call("ALBasicAwareness.setEngagementMode", "SemiEngaged")
    await rig.call("ALAutonomousLife.setState", "interactive")
    assert await rig.call("ALBasicAwareness.getEngagementMode") == "FullyEngaged"


async def test_the_way_back_from_interactive_to_solitary_is_refused(rig: SimulatedRobotRig) -> None:
    await rig.call("ALAutonomousLife.setState", "interactive")
    with pytest.raises(RobotCallError, match="interactive to solitary"):
        await rig.call("ALAutonomousLife.setState", "solitary")
    assert await rig.call("ALAutonomousLife.getState") == "interactive"


async def test_what_a_client_switched_off_comes_back_with_the_state(rig: SimulatedRobotRig) -> None:
    await rig.call("ALAutonomousBlinking.setEnabled", False)
    await rig.call("ALMotion.setBreathEnabled", "Body", False)
    assert await rig.call("ALAutonomousBlinking.isEnabled") is False
    await rig.call("ALAutonomousLife.setState", "interactive")
    assert await rig.call("ALAutonomousBlinking.isEnabled") is True
    assert await rig.call("ALMotion.getBreathEnabled", "Body") is True


async def test_disabled_makes_it_rest_and_solitary_wakes_it(rig: SimulatedRobotRig) -> None:
    task = await rig.begin("ALAutonomousLife.setState", "disabled", kind="posture")
    await rig.time.advance(3)
    await rig.done(task)
    assert await rig.call("ALMotion.robotIsWakeUp") is False
    task = await rig.begin("ALAutonomousLife.setState", "solitary", kind="posture")
    await rig.time.advance(3)
    await rig.done(task)
    assert await rig.call("ALMotion.robotIsWakeUp") is True


async def test_an_unknown_state_is_refused(rig: SimulatedRobotRig) -> None:
    with pytest.raises(RobotCallError, match="happy"):
        await rig.call("ALAutonomousLife.setState", "happy")
    assert await rig.call("ALAutonomousLife.getState") == "solitary"


async def test_it_changes_by_itself_when_told_to(rig: SimulatedRobotRig) -> None:
    before = await enabled(rig), await rig.call("ALAutonomousLife.getState")
    await rig.robot.set("drift", 1)
    after = await enabled(rig), await rig.call("ALAutonomousLife.getState")
    assert before != after
    assert "by itself" in str(await rig.robot.get("notes"))


async def test_a_moody_robot_changes_by_itself_again_and_again(rig: SimulatedRobotRig) -> None:
    await rig.robot.fault("moody")
    await rig.pass_by(120)
    notes = await rig.robot.get("notes")
    assert len(notes) > 3
    assert all(note.startswith("by itself") for note in notes)


async def test_engagement_modes(rig: SimulatedRobotRig) -> None:
    await rig.call("ALBasicAwareness.setEngagementMode", "FullyEngaged")
    assert await rig.call("ALBasicAwareness.getEngagementMode") == "FullyEngaged"
    with pytest.raises(RobotCallError, match="Bored"):
        await rig.call("ALBasicAwareness.setEngagementMode", "Bored")


async def test_awareness_turns_the_head_to_a_visitor(rig: SimulatedRobotRig) -> None:
    await rig.robot.person({"angle": 0.6})
    await rig.pass_by(2)
    assert (await rig.call("ALMotion.getAngles", "HeadYaw", True))[0] == pytest.approx(0.6)


async def test_without_awareness_the_head_stays(rig: SimulatedRobotRig) -> None:
    await rig.call("ALBasicAwareness.setEnabled", False)
    await rig.robot.person({"angle": 0.6})
    await rig.pass_by(2)
    assert await rig.call("ALMotion.getAngles", "HeadYaw", True) == [0.0]


async def test_eyes_fade_to_a_colour(rig: SimulatedRobotRig) -> None:
    task = await rig.begin("ALLeds.fadeRGB", "FaceLeds", 1.0, 0.0, 0.5, 2.0, kind="leds")
    await rig.time.advance(1.0)
    assert await rig.call("ALLeds.getIntensity", "RightFaceLed1") == pytest.approx([0.75, 0.5, 1.0])
    await rig.time.advance(1.1)
    await rig.done(task)
    # Blue, green, red.
    assert await rig.call("ALLeds.getIntensity", "LeftFaceLed8") == pytest.approx([0.5, 0, 1])
    assert await rig.call("ALLeds.getIntensity", "ChestLed") == [1, 1, 1]


@pytest.mark.parametrize(("color", "bgr"), [(0x00FF00, [0, 1, 0]), ("blue", [1, 0, 0])])
async def test_colours_as_numbers_and_names(
    rig: SimulatedRobotRig, color: int | str, bgr: list[int]
) -> None:
    task = asyncio.ensure_future(rig.call("ALLeds.fadeRGB", "FaceLeds", color, 0.0))
    await rig.robot.called("ALLeds.fadeRGB")
    await rig.time.advance(0.1)
    await rig.done(task)
    assert await rig.call("ALLeds.getIntensity", "RightFaceLed1") == bgr


async def test_intensity_is_white_of_that_brightness(rig: SimulatedRobotRig) -> None:
    await rig.call("ALLeds.setIntensity", "FaceLeds", 0.25)
    assert await rig.call("ALLeds.getIntensity", "RightFaceLed3") == [0.25, 0.25, 0.25]


async def test_unknown_leds_are_refused(rig: SimulatedRobotRig) -> None:
    with pytest.raises(RobotCallError, match="NoseLed"):
        await rig.call("ALLeds.setIntensity", "NoseLed", 0.5)


@pytest.mark.parametrize(
    ("name", "args"),
    [("rasta", (2.0,)), ("randomEyes", (2.0,)), ("rotateEyes", (0xFF0000, 1.0, 2.0))],
)
async def test_eye_animations_run_for_their_time(
    rig: SimulatedRobotRig, name: str, args: tuple[float, ...]
) -> None:
    before = await rig.robot.get("eyes")
    task = await rig.begin(f"ALLeds.{name}", *args, kind="eyes")
    shown = set()
    for _ in range(6):
        await rig.time.advance(0.3)
        colors = [await rig.call("ALLeds.getIntensity", led) for led in ONE_EYE]
        shown.add(json.dumps(colors))
    assert len(shown) > 1
    await rig.time.advance(0.1)
    assert (await rig.robot.get("eyes.animation")).startswith(name)
    assert await rig.pending(task)
    await rig.time.advance(0.2)
    await rig.done(task)
    assert await rig.robot.get("eyes.animation") == ""
    assert await rig.robot.get("eyes") == before


async def test_what_it_is_and_how_full(rig: SimulatedRobotRig) -> None:
    assert await rig.call("ALSystem.systemVersion") == "2.5.10.7"
    await rig.robot.set("battery", 42)
    assert await rig.call("ALBattery.getBatteryCharge") == 42
    key = "Device/SubDeviceList/Battery/Charge/Sensor/Value"
    assert await rig.call("ALMemory.getData", key) == pytest.approx(0.42)


async def test_the_battery_goes_down(rig: SimulatedRobotRig) -> None:
    await rig.robot.set("battery", 50)
    await rig.time.advance(3600)
    assert 35 < await rig.call("ALBattery.getBatteryCharge") < 45
