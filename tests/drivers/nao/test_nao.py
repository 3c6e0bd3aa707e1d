"""A NAO over the wire: it walks, stops without falling, sits, shows feelings, has two cameras."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from woz_drivers.nao.driver import Nao
from woz_drivers.nao.settings import NaoSettings

from tests.drivers.pepper.played import Played, played
from woz_tui.drivers.contract import DriverError, Scope
from woz_tui.protocol.robot_outline import RobotOutline

pytestmark = pytest.mark.asyncio(loop_scope="module")


async def going(it: Played) -> set[str]:
    """What the robot is doing, but for its lights."""
    return {kind for kind, *_ in await it.robot.get("going")} - {"leds", "eyes"}


async def stands(it: Played) -> bool:
    return await it.robot.get("posture") == "Stand" and not any(await it.robot.get("velocity"))


# -- walking and its stop --------------------------------------------------------------------------


async def test_it_walks_and_says_how_long_that_takes(it: Played) -> None:
    before = await it.robot.get("pose")
    assert await it.do("drive", x=0.2, turn=30) == {"x": 0.2, "y": 0.0, "turn": 30}
    (called,) = await it.calls("ALMotion.moveTo")
    assert called == pytest.approx((0.2, 0.0, math.radians(30)), abs=1e-6)
    after = await it.robot.get("pose")
    assert math.dist(before[:2], after[:2]) == pytest.approx(0.2, abs=0.05)
    assert it.jobs[-1].announced == [pytest.approx(2.5)]


@pytest.mark.parametrize("scope", [Scope.ALL, Scope.DRIVE])
async def test_a_stop_ends_the_walk_on_its_feet(it: Played, scope: Scope) -> None:
    walk = it.begin("drive", x=5.0)
    await it.robot.called("ALMotion.moveTo")
    report = await it.stop(scope)
    assert "walking" in report.confirmed
    assert report.missing == ()
    assert await stands(it)
    assert await it.calls("ALMotion.killAll", "ALMotion.killMove") == []
    await it.cancel(walk) if not walk.done() else None
    await it.driver.resume()


async def test_a_step_that_outlasts_the_stop_is_told_when_it_has_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_drivers.confirmed_stop.STOP_S", 0.05)
    async with played(tmp_path, kind="nao", pace=0.5) as it:  # a step of 0.6 s
        it.begin("drive", x=5.0)
        await it.robot.called("ALMotion.moveTo")
        await it.robot.until(lambda: moves(it))
        assert "walking" in (await it.stop()).missing
        await it.heard.until(lambda: any("walking" in text for text in it.notices))
        assert await stands(it)


async def moves(it: Played) -> bool:
    return any(await it.robot.get("velocity"))


async def test_a_cancelled_walk_ends_on_its_feet(it: Played) -> None:
    walk = it.begin("drive", x=5.0)
    await it.robot.called("ALMotion.moveTo")
    await it.cancel(walk)
    await it.robot.until(lambda: stands(it))


async def test_the_stop_ends_everything_at_once(it: Played) -> None:
    it.begin("drive", x=5.0)
    await it.robot.called("ALMotion.moveTo")
    it.begin("say", text="A very long story. " * 100)
    it.begin("sound", file="/home/nao/sounds/music.mp3")
    it.begin("eyes", color="red", animation="intermittent")
    for name in ("ALAnimatedSpeech.say", "ALAudioPlayer.play", "ALLeds.fadeRGB"):
        await it.robot.called(name)
    report = await it.stop()
    assert report.missing == ()
    assert {"walking", "motion", "speech", "sounds"} <= set(report.confirmed)
    assert await going(it) == set()
    assert await stands(it)
    await it.driver.resume()
    await it.do("say", text="Hello", plain=True)


async def test_a_stop_ends_a_pose_of_arms_and_legs(it: Played) -> None:
    pose = it.begin("pose", joints={"RShoulderPitch": -60, "LKneePitch": 40}, seconds=50)
    await it.robot.called("ALMotion.angleInterpolation")
    assert "motion" in (await it.stop()).confirmed
    assert await going(it) == set()
    assert pose.done()
    await it.driver.resume()
    await it.do("home")


async def test_a_seated_robot_does_not_walk_and_says_what_to_do(it: Played) -> None:
    await it.do("posture", name="Sit")
    with pytest.raises(DriverError, match="Sitting") as refused:
        await it.do("drive", x=0.1)
    assert "posture: Stand" in refused.value.remedy
    assert await it.calls("ALMotion.moveTo") == []
    await it.do("home")
    assert await stands(it)


async def test_a_resting_robot_does_not_walk(it: Played) -> None:
    await it.do("torque", on=False)
    with pytest.raises(DriverError, match="at rest"):
        await it.do("drive", x=0.1)
    await it.do("torque", on=True)


# -- animations by posture -------------------------------------------------------------------------


async def test_an_animation_fits_the_posture(it: Played) -> None:
    assert await it.do("play", move="Happy_1") == {
        "move": "animations/Stand/Emotions/Positive/Happy_1"
    }
    await it.do("posture", name="Sit")
    assert await it.do("play", move="happy_1") == {
        "move": "animations/Sit/Emotions/Positive/Happy_1"
    }
    await it.robot.clear()
    for move in ("BowShort_1", "animations/Stand/Gestures/Hey_1"):
        with pytest.raises(DriverError, match="another posture") as refused:
            await it.do("play", move=move)
        assert "posture: Stand" in refused.value.remedy
    assert await it.calls("ALAnimationPlayer.run") == []
    await it.do("play", move="animations/[posture]/Gestures/Hey_3")
    await it.do("home")


# -- joints ----------------------------------------------------------------------------------------


async def test_the_head_turns_as_far_as_its_shell_lets_it(it: Played) -> None:
    sent = await it.do("gaze", yaw=87.49, pitch=40)
    assert sent == {"yaw": 87.49, "pitch": 11.46, "clamped": {"pitch": 40}}


# -- lights and cameras ----------------------------------------------------------------------------


async def test_feelings_are_colours_of_the_eyes(it: Played) -> None:
    await it.do("emotion", emotion="angry")
    assert await it.robot.get("eyes") == pytest.approx([1, 0, 0], abs=0.01)
    await it.do("emotion", emotion="angry", intensity=0.5)
    assert await it.robot.get("eyes") == pytest.approx([1, 0.5, 0.5], abs=0.01)
    shown = await it.shows(eyes="#ff8080")
    assert "eyes" not in shown.wanted


@pytest.mark.parametrize(
    ("group", "color", "shown"),
    [
        ("chest", "#00ff00", [0, 1, 0]),
        ("feet", "#0000ff", [0, 0, 1]),
        ("ears", "#800000", [0.5, 0.5, 0.5]),  # one colour: its brightness
    ],
)
async def test_lights_of_ears_chest_and_feet(
    it: Played, group: str, color: str, shown: list[float]
) -> None:
    await it.do("leds", group=group, color=color)
    assert await it.robot.get(group) == pytest.approx(shown, abs=0.01)


async def test_either_camera_gives_pictures(it: Played) -> None:
    top, bottom = await it.do("picture"), await it.do("picture", camera="bottom")
    assert [top["camera"], bottom["camera"]] == ["top", "bottom"]
    pictures = [(it.folder / str(one["file"])).read_bytes() for one in (top, bottom)]
    assert pictures[0] != pictures[1]
    await it.do("camera", which="bottom")
    await it.shows(camera="bottom")
    assert (await it.do("picture"))["camera"] == "bottom"
    cameras = [args[1] for args in await it.calls("ALVideoDevice.subscribeCamera")]
    assert cameras == [0, 1, 1]
    await it.do("camera", which="top")


# -- what it offers --------------------------------------------------------------------------------


async def test_the_screen_offers_its_postures_and_no_tablet(it: Played) -> None:
    told = RobotOutline.read(Nao.outline(NaoSettings(address="nao.local")))
    assert told is not None
    lines = {line.name: line for line in told.settings}
    assert "Sit" in lines["posture"].choices
    assert "tablet" not in lines
    assert told.robots == ["nao.local", "simulated"]
    assert not {"screen", "tablet", "hip"} & {verb.name for verb in Nao.verbs(NaoSettings())}
    shown = await it.tells(lambda one: set(lines) <= set(one.values))
    assert shown.values["posture"] == "Stand"


async def test_a_wrong_address_or_posture_is_found_before_the_session() -> None:
    wrong = NaoSettings(address="http://192.168.1.21", posture="Sitt")
    assert {path for path, _ in wrong.problems()} == {"address", "posture"}
    assert NaoSettings(address="nao.local", posture="Sit").problems() == []
    assert NaoSettings().problems() == []
