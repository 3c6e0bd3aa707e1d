"""A NAO over the wire: it walks, stops without falling, sits, shows feelings, has two cameras."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from woz_drivers.nao.driver import Nao
from woz_drivers.nao.settings import NaoSettings

from tests.drivers.pepper.robot_rig import RobotRig, connected_robot
from woz_tui.drivers.contract import DriverError, Scope
from woz_tui.protocol.robot_outline import RobotOutline

pytestmark = pytest.mark.asyncio(loop_scope="module")


async def going(rig: RobotRig) -> set[str]:
    """What the robot is doing, but for its lights."""
    return {kind for kind, *_ in await rig.robot.get("going")} - {"leds", "eyes"}


async def stands(rig: RobotRig) -> bool:
    return await rig.robot.get("posture") == "Stand" and not any(await rig.robot.get("velocity"))


# -- walking and its stop --------------------------------------------------------------------------


async def test_it_walks_and_says_how_long_that_takes(robot_rig: RobotRig) -> None:
    before = await robot_rig.robot.get("pose")
    assert await robot_rig.do("drive", x=0.2, turn=30) == {"x": 0.2, "y": 0.0, "turn": 30}
    (called,) = await robot_rig.calls("ALMotion.moveTo")
    assert called == pytest.approx((0.2, 0.0, math.radians(30)), abs=1e-6)
    after = await robot_rig.robot.get("pose")
    assert math.dist(before[:2], after[:2]) == pytest.approx(0.2, abs=0.05)
    assert robot_rig.jobs[-1].announced == [pytest.approx(2.5)]


@pytest.mark.parametrize("scope", [Scope.ALL, Scope.DRIVE])
async def test_a_stop_ends_the_walk_on_its_feet(robot_rig: RobotRig, scope: Scope) -> None:
    walk = robot_rig.begin("drive", x=5.0)
    await robot_rig.robot.called("ALMotion.moveTo")
    report = await robot_rig.stop(scope)
    assert "walking" in report.confirmed
    assert report.missing == ()
    assert await stands(robot_rig)
    assert await robot_rig.calls("ALMotion.killAll", "ALMotion.killMove") == []
    await robot_rig.cancel(walk) if not walk.done() else None
    await robot_rig.driver.resume()


async def test_a_step_that_outlasts_the_stop_is_told_when_it_has_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_tui.drivers.confirmed_stop.STOP_S", 0.05)
    async with connected_robot(tmp_path, kind="nao", pace=0.5) as rig:  # a step of 0.6 s
        rig.begin("drive", x=5.0)
        await rig.robot.called("ALMotion.moveTo")
        await rig.robot.until(lambda: moves(rig))
        assert "walking" in (await rig.stop()).missing
        await rig.published.until(lambda: any("walking" in text for text in rig.notices))
        assert await stands(rig)


async def moves(rig: RobotRig) -> bool:
    return any(await rig.robot.get("velocity"))


async def test_a_cancelled_walk_ends_on_its_feet(robot_rig: RobotRig) -> None:
    walk = robot_rig.begin("drive", x=5.0)
    await robot_rig.robot.called("ALMotion.moveTo")
    await robot_rig.cancel(walk)
    await robot_rig.robot.until(lambda: stands(robot_rig))


async def test_the_stop_ends_everything_at_once(robot_rig: RobotRig) -> None:
    robot_rig.begin("drive", x=5.0)
    await robot_rig.robot.called("ALMotion.moveTo")
    robot_rig.begin("say", text="A very long story. " * 100)
    robot_rig.begin("sound", file="/home/nao/sounds/music.mp3")
    robot_rig.begin("eyes", color="red", animation="intermittent")
    for name in ("ALAnimatedSpeech.say", "ALAudioPlayer.play", "ALLeds.fadeRGB"):
        await robot_rig.robot.called(name)
    report = await robot_rig.stop()
    assert report.missing == ()
    assert {"walking", "motion", "speech", "sounds"} <= set(report.confirmed)
    assert await going(robot_rig) == set()
    assert await stands(robot_rig)
    await robot_rig.driver.resume()
    await robot_rig.do("say", text="Hello", plain=True)


async def test_a_stop_ends_a_pose_of_arms_and_legs(robot_rig: RobotRig) -> None:
    pose = robot_rig.begin("pose", joints={"RShoulderPitch": -60, "LKneePitch": 40}, seconds=50)
    await robot_rig.robot.called("ALMotion.angleInterpolation")
    assert "motion" in (await robot_rig.stop()).confirmed
    assert await going(robot_rig) == set()
    assert pose.done()
    await robot_rig.driver.resume()
    await robot_rig.do("home")


async def test_a_seated_robot_does_not_walk_and_says_what_to_do(robot_rig: RobotRig) -> None:
    await robot_rig.do("posture", name="Sit")
    with pytest.raises(DriverError, match="Sitting") as raised:
        await robot_rig.do("drive", x=0.1)
    assert "posture: Stand" in raised.value.remedy
    assert await robot_rig.calls("ALMotion.moveTo") == []
    await robot_rig.do("home")
    assert await stands(robot_rig)


async def test_a_resting_robot_does_not_walk(robot_rig: RobotRig) -> None:
    await robot_rig.do("torque", on=False)
    with pytest.raises(DriverError, match="at rest"):
        await robot_rig.do("drive", x=0.1)
    await robot_rig.do("torque", on=True)


# -- animations by posture -------------------------------------------------------------------------


async def test_an_animation_fits_the_posture(robot_rig: RobotRig) -> None:
    assert await robot_rig.do("play", move="Happy_1") == {
        "move": "animations/Stand/Emotions/Positive/Happy_1"
    }
    await robot_rig.do("posture", name="Sit")
    assert await robot_rig.do("play", move="happy_1") == {
        "move": "animations/Sit/Emotions/Positive/Happy_1"
    }
    await robot_rig.robot.clear()
    for move in ("BowShort_1", "animations/Stand/Gestures/Hey_1"):
        with pytest.raises(DriverError, match="another posture") as raised:
            await robot_rig.do("play", move=move)
        assert "posture: Stand" in raised.value.remedy
    assert await robot_rig.calls("ALAnimationPlayer.run") == []
    await robot_rig.do("play", move="animations/[posture]/Gestures/Hey_3")
    await robot_rig.do("home")


# -- joints ----------------------------------------------------------------------------------------


async def test_the_head_turns_as_far_as_its_shell_lets_it(robot_rig: RobotRig) -> None:
    sent = await robot_rig.do("gaze", yaw=87.49, pitch=40)
    assert sent == {"yaw": 87.49, "pitch": 11.46, "clamped": {"pitch": 40}}


# -- lights and cameras ----------------------------------------------------------------------------


async def test_feelings_are_colours_of_the_eyes(robot_rig: RobotRig) -> None:
    await robot_rig.do("emotion", emotion="angry")
    assert await robot_rig.robot.get("eyes") == pytest.approx([1, 0, 0], abs=0.01)
    await robot_rig.do("emotion", emotion="angry", intensity=0.5)
    assert await robot_rig.robot.get("eyes") == pytest.approx([1, 0.5, 0.5], abs=0.01)
    settings_shown = await robot_rig.shows(eyes="#ff8080")
    assert "eyes" not in settings_shown.wanted


@pytest.mark.parametrize(
    ("group", "color", "shown"),
    [
        ("chest", "#00ff00", [0, 1, 0]),
        ("feet", "#0000ff", [0, 0, 1]),
        ("ears", "#800000", [0.5, 0.5, 0.5]),  # one colour: its brightness
    ],
)
async def test_lights_of_ears_chest_and_feet(
    robot_rig: RobotRig, group: str, color: str, shown: list[float]
) -> None:
    await robot_rig.do("leds", group=group, color=color)
    assert await robot_rig.robot.get(group) == pytest.approx(shown, abs=0.01)


async def test_either_camera_gives_pictures(robot_rig: RobotRig) -> None:
    top, bottom = await robot_rig.do("picture"), await robot_rig.do("picture", camera="bottom")
    assert [top["camera"], bottom["camera"]] == ["top", "bottom"]
    pictures = [(robot_rig.folder / str(one["file"])).read_bytes() for one in (top, bottom)]
    assert pictures[0] != pictures[1]
    await robot_rig.do("camera", which="bottom")
    await robot_rig.shows(camera="bottom")
    assert (await robot_rig.do("picture"))["camera"] == "bottom"
    cameras = [args[1] for args in await robot_rig.calls("ALVideoDevice.subscribeCamera")]
    assert cameras == [0, 1, 1]
    await robot_rig.do("camera", which="top")


# -- what it offers --------------------------------------------------------------------------------


async def test_the_screen_offers_its_postures_and_no_tablet(robot_rig: RobotRig) -> None:
    told = RobotOutline.read(Nao.offer(NaoSettings(address="nao.local")).outline)
    assert told is not None
    lines = {line.name: line for line in told.settings}
    assert "Sit" in lines["posture"].choices
    assert "tablet" not in lines
    assert told.robots == ["nao.local", "simulated"]
    assert not {"screen", "tablet", "hip"} & {verb.name for verb in Nao.offer(NaoSettings()).verbs}
    settings_shown = await robot_rig.tells(lambda one: set(lines) <= set(one.values))
    assert settings_shown.values["posture"] == "Stand"


async def test_a_wrong_address_or_posture_is_found_before_the_session() -> None:
    wrong = NaoSettings(address="http://192.168.1.21", posture="Sitt")
    assert {path for path, _ in wrong.problems()} == {"address", "posture"}
    assert NaoSettings(address="nao.local", posture="Sit").problems() == []
    assert NaoSettings().problems() == []
