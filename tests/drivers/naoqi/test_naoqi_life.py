"""ALAutonomousLife and the abilities, ALLeds, ALSystem, ALBattery."""

from __future__ import annotations

import asyncio
import json

import pytest

from tests.drivers.naoqi.hands import Said, Wired

ABILITIES = (
    "ALBasicAwareness",
    "ALAutonomousBlinking",
    "ALListeningMovement",
    "ALSpeakingMovement",
)
ONE_EYE = [f"RightFaceLed{number}" for number in range(1, 9)]


async def enabled(wired: Wired) -> list[bool]:
    return [await wired.call(f"{name}.isEnabled") for name in ABILITIES]


async def test_each_state_switches_what_it_does_by_itself(wired: Wired) -> None:
    assert await enabled(wired) == [True, True, True, True]
    await wired.call("ALAutonomousLife.setState", "safeguard")
    assert await enabled(wired) == [False, False, False, False]
    assert await wired.call("ALAutonomousLife.getState") == "safeguard"
    task = await wired.begin("ALAutonomousLife.setState", "disabled", kind="posture")
    await wired.time.advance(3)
    await wired.done(task)
    assert await enabled(wired) == [False, False, False, True]


async def test_each_state_changes_how_it_engages(wired: Wired) -> None:
    await wired.call("ALBasicAwareness.setEngagementMode", "SemiEngaged")
    await wired.call("ALAutonomousLife.setState", "interactive")
    assert await wired.call("ALBasicAwareness.getEngagementMode") == "FullyEngaged"


async def test_the_way_back_from_interactive_to_solitary_is_refused(wired: Wired) -> None:
    await wired.call("ALAutonomousLife.setState", "interactive")
    with pytest.raises(Said, match="interactive to solitary"):
        await wired.call("ALAutonomousLife.setState", "solitary")
    assert await wired.call("ALAutonomousLife.getState") == "interactive"


async def test_what_a_client_switched_off_comes_back_with_the_state(wired: Wired) -> None:
    await wired.call("ALAutonomousBlinking.setEnabled", False)
    await wired.call("ALMotion.setBreathEnabled", "Body", False)
    assert await wired.call("ALAutonomousBlinking.isEnabled") is False
    await wired.call("ALAutonomousLife.setState", "interactive")
    assert await wired.call("ALAutonomousBlinking.isEnabled") is True
    assert await wired.call("ALMotion.getBreathEnabled", "Body") is True


async def test_disabled_makes_it_rest_and_solitary_wakes_it(wired: Wired) -> None:
    task = await wired.begin("ALAutonomousLife.setState", "disabled", kind="posture")
    await wired.time.advance(3)
    await wired.done(task)
    assert await wired.call("ALMotion.robotIsWakeUp") is False
    task = await wired.begin("ALAutonomousLife.setState", "solitary", kind="posture")
    await wired.time.advance(3)
    await wired.done(task)
    assert await wired.call("ALMotion.robotIsWakeUp") is True


async def test_an_unknown_state_is_refused(wired: Wired) -> None:
    with pytest.raises(Said, match="happy"):
        await wired.call("ALAutonomousLife.setState", "happy")
    assert await wired.call("ALAutonomousLife.getState") == "solitary"


async def test_it_changes_by_itself_when_told_to(wired: Wired) -> None:
    before = await enabled(wired), await wired.call("ALAutonomousLife.getState")
    await wired.robot.set("drift", 1)
    after = await enabled(wired), await wired.call("ALAutonomousLife.getState")
    assert before != after
    assert "by itself" in str(await wired.robot.get("notes"))


async def test_a_moody_robot_changes_by_itself_again_and_again(wired: Wired) -> None:
    await wired.robot.fault("moody")
    await wired.pass_by(120)
    notes = await wired.robot.get("notes")
    assert len(notes) > 3
    assert all(note.startswith("by itself") for note in notes)


async def test_engagement_modes(wired: Wired) -> None:
    await wired.call("ALBasicAwareness.setEngagementMode", "FullyEngaged")
    assert await wired.call("ALBasicAwareness.getEngagementMode") == "FullyEngaged"
    with pytest.raises(Said, match="Bored"):
        await wired.call("ALBasicAwareness.setEngagementMode", "Bored")


async def test_awareness_turns_the_head_to_a_visitor(wired: Wired) -> None:
    await wired.robot.person({"angle": 0.6})
    await wired.pass_by(2)
    assert (await wired.call("ALMotion.getAngles", "HeadYaw", True))[0] == pytest.approx(0.6)


async def test_without_awareness_the_head_stays(wired: Wired) -> None:
    await wired.call("ALBasicAwareness.setEnabled", False)
    await wired.robot.person({"angle": 0.6})
    await wired.pass_by(2)
    assert await wired.call("ALMotion.getAngles", "HeadYaw", True) == [0.0]


async def test_eyes_fade_to_a_colour(wired: Wired) -> None:
    task = await wired.begin("ALLeds.fadeRGB", "FaceLeds", 1.0, 0.0, 0.5, 2.0, kind="leds")
    await wired.time.advance(1.0)
    assert await wired.call("ALLeds.getIntensity", "RightFaceLed1") == pytest.approx(
        [0.75, 0.5, 1.0]
    )
    await wired.time.advance(1.1)
    await wired.done(task)
    # Blue, green, red.
    assert await wired.call("ALLeds.getIntensity", "LeftFaceLed8") == pytest.approx([0.5, 0, 1])
    assert await wired.call("ALLeds.getIntensity", "ChestLed") == [1, 1, 1]


@pytest.mark.parametrize(("color", "bgr"), [(0x00FF00, [0, 1, 0]), ("blue", [1, 0, 0])])
async def test_colours_as_numbers_and_names(wired: Wired, color: int | str, bgr: list[int]) -> None:
    task = asyncio.ensure_future(wired.call("ALLeds.fadeRGB", "FaceLeds", color, 0.0))
    await wired.robot.called("ALLeds.fadeRGB")
    await wired.time.advance(0.1)
    await wired.done(task)
    assert await wired.call("ALLeds.getIntensity", "RightFaceLed1") == bgr


async def test_intensity_is_white_of_that_brightness(wired: Wired) -> None:
    await wired.call("ALLeds.setIntensity", "FaceLeds", 0.25)
    assert await wired.call("ALLeds.getIntensity", "RightFaceLed3") == [0.25, 0.25, 0.25]


async def test_unknown_leds_are_refused(wired: Wired) -> None:
    with pytest.raises(Said, match="NoseLed"):
        await wired.call("ALLeds.setIntensity", "NoseLed", 0.5)


@pytest.mark.parametrize(
    ("name", "args"),
    [("rasta", (2.0,)), ("randomEyes", (2.0,)), ("rotateEyes", (0xFF0000, 1.0, 2.0))],
)
async def test_eye_animations_run_for_their_time(
    wired: Wired, name: str, args: tuple[float, ...]
) -> None:
    before = await wired.robot.get("eyes")
    task = await wired.begin(f"ALLeds.{name}", *args, kind="eyes")
    shown = set()
    for _ in range(6):
        await wired.time.advance(0.3)
        colors = [await wired.call("ALLeds.getIntensity", led) for led in ONE_EYE]
        shown.add(json.dumps(colors))
    assert len(shown) > 1
    await wired.time.advance(0.1)
    assert (await wired.robot.get("eyes.animation")).startswith(name)
    assert await wired.pending(task)
    await wired.time.advance(0.2)
    await wired.done(task)
    assert await wired.robot.get("eyes.animation") == ""
    assert await wired.robot.get("eyes") == before


async def test_what_it_is_and_how_full(wired: Wired) -> None:
    assert await wired.call("ALSystem.systemVersion") == "2.5.10.7"
    await wired.robot.set("battery", 42)
    assert await wired.call("ALBattery.getBatteryCharge") == 42
    key = "Device/SubDeviceList/Battery/Charge/Sensor/Value"
    assert await wired.call("ALMemory.getData", key) == pytest.approx(0.42)


async def test_the_battery_goes_down(wired: Wired) -> None:
    await wired.robot.set("battery", 50)
    await wired.time.advance(3600)
    assert 35 < await wired.call("ALBattery.getBatteryCharge") < 45
