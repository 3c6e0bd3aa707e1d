"""Gestures, emotions, single parameters, and where it looks."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from robot_simulators import furhat as simulator
from woz_drivers.furhat import face
from woz_drivers.furhat.head import direction_of, place_of
from woz_drivers.furhat.moves import COMMON_GESTURES, EMOTIONS, GESTURES
from woz_drivers.furhat.realtime_events import Place
from woz_drivers.furhat.settings import FurhatGazeSettings, FurhatSensesSettings, GestureFrame

from tests.drivers.furhat.furhat_rig import SOMEBODY, FurhatRig, connected_furhat, looks_often
from woz_tui.drivers.contract import DriverError, RejectedError
from woz_tui.protocol.messages import Json
from woz_tui.testing import until


@pytest.fixture
async def rig(tmp_path: Path) -> AsyncIterator[FurhatRig]:
    async with connected_furhat(tmp_path) as furhat_rig:
        yield furhat_rig


def test_the_simulated_robot_has_the_gestures_that_are_offered() -> None:
    assert {*GESTURES} == {*simulator.GESTURES}
    assert {*COMMON_GESTURES.values()} <= {*GESTURES}


async def test_a_common_gesture_is_the_robots_own_and_ends_with_it(rig: FurhatRig) -> None:
    playing = rig.begin("play", move="nod", speed=2.0, amplitude=0.5)
    await until(lambda: rig.robot.gesturing == ["Nod"])
    assert rig.robot.requests("request.gesture.start") == [
        {"name": "Nod", "intensity": 0.5, "duration": 0.5, "monitor": True}
    ]
    assert not playing.done()
    assert await rig.ended(playing) == {"move": "nod", "gesture": "Nod"}


async def test_the_robots_own_names_are_taken_too(rig: FurhatRig) -> None:
    assert (await rig.do("play", move="ExpressSad"))["gesture"] == "ExpressSad"
    with pytest.raises(RejectedError):
        await rig.do("play", move="somersault")


async def test_a_gesture_that_its_software_does_not_have_is_told(
    rig: FurhatRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(face, "_BEGINS_WITHIN_S", 0.1)
    rig.robot.ignored.add("request.gesture.start")
    with pytest.raises(DriverError, match="Wink"):
        await rig.begin("play", move="wink")


async def test_a_cancelled_gesture_ends_and_the_emotion_stays(rig: FurhatRig) -> None:
    await rig.do("emotion", emotion="happy")
    await rig.arrived()
    happy = dict(rig.robot.face)
    playing = rig.begin("play", move="Roll")
    await until(lambda: bool(rig.robot.gesturing))
    playing.cancel()
    await until(lambda: not rig.robot.gesturing and rig.robot.face == happy)


async def test_a_gesture_of_the_robot_file_is_face_and_head_over_time(tmp_path: Path) -> None:
    doubt = (
        GestureFrame(0.1, {"BROW_DOWN_LEFT": 1.0}, yaw=10.0),
        GestureFrame(0.05, {"BROW_DOWN_LEFT": 0.5, "JAW_OPEN": 0.2}),
    )
    async with connected_furhat(tmp_path, gestures={"doubt": doubt}) as furhat_rig:
        await furhat_rig.do("gaze", yaw=5.0, pitch=0.0)
        assert await furhat_rig.do("play", move="doubt") == {"move": "doubt"}
        await furhat_rig.arrived()
        params = furhat_rig.robot.requests("request.face.params")
        brow = [sent["params"].get("BROW_DOWN_LEFT") for sent in params]
        assert 1.0 in brow
        assert furhat_rig.robot.face["BROW_DOWN_LEFT"] == 0.0  # as before
        places = furhat_rig.robot.requests("request.attend.location")
        yaws = [round(direction_of(_place(place))[0]) for place in places]
        assert yaws == [5, 15, 5]


async def test_moves_of_other_robots_are_done_with_the_head(rig: FurhatRig) -> None:
    await rig.do("play", move="point-left", speed=4.0)
    await rig.arrived()
    places = rig.robot.requests("request.attend.location")
    assert max(place["x"] for place in places) > 0.5  # to its left
    assert direction_of(_place(places[-1])) == pytest.approx((0.0, 0.0))


async def test_an_emotion_comes_gradually_and_replaces_the_one_before(
    rig: FurhatRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(face, "_FADE_S", 0.1)
    for emotion in ("amazed", "angry", "neutral", "happy"):
        await rig.do("emotion", emotion=emotion, intensity=0.5)
        await rig.arrived()
        shown = {name: share for name, share in rig.robot.face.items() if share}
        wanted = {name: share * 0.5 for name, share in EMOTIONS[emotion].items()}
        assert shown == pytest.approx(wanted, abs=1e-3)
    monkeypatch.setattr(face, "_FADE_S", 600.0)
    rig.begin("emotion", emotion="neutral")
    smile = rig.robot.face["MOUTH_SMILE_LEFT"]
    await until(lambda: 0.0 < rig.robot.face["MOUTH_SMILE_LEFT"] < smile)


async def test_poses_set_face_parameters_over_time(rig: FurhatRig) -> None:
    sent = await rig.do(
        "poses",
        poses=[
            {"joints": {"JAW_OPEN": 1.0}, "seconds": 0.1},
            {"joints": {"JAW_OPEN": 0.25, "NECK_TILT": 90.0}, "seconds": 0.0},
        ],
    )
    assert sent == {"joints": {"JAW_OPEN": 0.25, "NECK_TILT": 30.0}}  # no farther than it may
    await until(lambda: rig.robot.face.get("JAW_OPEN") == 0.25)
    await rig.do("home")
    await until(lambda: not any(rig.robot.face.values()))
    with pytest.raises(RejectedError):
        await rig.do("pose", joints={"ELBOW": 1.0})


async def test_the_face_is_changed_and_what_it_does_not_have_is_refused(tmp_path: Path) -> None:
    async with connected_furhat(tmp_path, face="adult - Isabel") as furhat_rig:
        assert furhat_rig.robot.face_id == "adult - Isabel"
        sent = await furhat_rig.do("face", face="child - Billy", blinking=False)
        assert sent == {"face": "child - Billy", "blinking": False}
        assert furhat_rig.robot.face_id == "child - Billy"
        with pytest.raises(RejectedError) as raised:
            await furhat_rig.do("face", face="adult - Isabell")
        assert "adult - Isabel" in raised.value.remedy


# -- where it looks --------------------------------------------------------------------------------


def _place(sent: dict[str, float]) -> Place:
    return Place(sent["x"], sent["y"], sent["z"])


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(("yaw", "pitch"), [(0, 0), (40, 0), (-75, 20), (10, -45), (0.5, 45)])
def test_a_direction_is_a_place_and_back(yaw: float, pitch: float, mirrored: bool) -> None:
    place = place_of(yaw, pitch, mirrored=mirrored)
    assert direction_of(place, mirrored=mirrored) == pytest.approx((yaw, pitch), abs=0.01)


async def test_left_is_positive_and_down_is_positive(rig: FurhatRig) -> None:
    assert await rig.do("gaze", yaw=30.0, pitch=20.0) == {"yaw": 30.0, "pitch": 20.0}
    await until(lambda: rig.robot.attended == "location")
    x, y, z = rig.robot.location
    assert x > 0.5 and y < -0.3 and z > 0.5


async def test_a_mirrored_robot_is_told_the_other_side(tmp_path: Path) -> None:
    async with connected_furhat(
        tmp_path, attention=FurhatGazeSettings(mirrored=True)
    ) as furhat_rig:
        await furhat_rig.do("gaze", yaw=30.0, pitch=0.0)
        await until(lambda: furhat_rig.robot.attended == "location")
        assert furhat_rig.robot.location[0] < -0.5


async def test_it_turns_no_farther_than_it_can(rig: FurhatRig) -> None:
    assert await rig.do("gaze", yaw=170.0, pitch=-90.0) == {"yaw": 75.0, "pitch": -45.0}


async def test_a_step_begins_where_it_looks_also_at_somebody(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks_often(monkeypatch)
    async with connected_furhat(
        tmp_path, senses=FurhatSensesSettings(loudness=False)
    ) as furhat_rig:
        assert await furhat_rig.do("nudge", yaw=10.0) == {"yaw": 10.0, "pitch": 0.0}
        assert await furhat_rig.do("nudge", yaw=5.0, pitch=-5.0) == {"yaw": 15.0, "pitch": -5.0}
        furhat_rig.robot.person = SOMEBODY
        await furhat_rig.passes(0.2)
        await until(
            lambda: furhat_rig.settings_shown["seen"] == "user-1"
        )  # and so the wizard knows whom to name
        await furhat_rig.do("follow", user="closest")
        await until(lambda: furhat_rig.settings_shown["attends"] == "user-1")
        assert (await furhat_rig.do("nudge", yaw=10.0))["yaw"] == pytest.approx(30.05, abs=0.1)
        await furhat_rig.do("follow", user="closest")
        await furhat_rig.do("play", move="bow", speed=4.0)
        await until(lambda: furhat_rig.settings_shown["attends"] == "user-1")
        await furhat_rig.do("follow", user="nobody")
        await until(lambda: furhat_rig.robot.attended == "nobody")


@pytest.mark.parametrize(("color", "led"), [("off", "#000000"), ("#102030", "#102030")])
async def test_eyes_colour_the_ring(rig: FurhatRig, color: str, led: str) -> None:
    await rig.do("eyes", color="red")
    await until(lambda: rig.robot.led == "#ff0000")
    await rig.do("eyes", color=color)
    await until(lambda: rig.robot.led == led)


# -- how long it will take -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("verb", "args"),
    [
        ("say", {"text": "Hello there."}),
        ("play", {"move": "nod", "speed": 2.0}),
        ("play", {"move": "look-around", "speed": 1.5}),
        ("poses", {"poses": [{"joints": {"BROW_DOWN_LEFT": 0.5}, "seconds": 0.4}] * 2}),
        ("home", {"seconds": 0.5}),
    ],
)
async def test_what_is_foretold_is_what_the_wizard_sees_counted_down(
    rig: FurhatRig, verb: str, args: dict[str, Json]
) -> None:
    foretold = await rig.driver.predict(verb, args)
    await rig.do(verb, **args)
    assert foretold.seconds == pytest.approx(rig.jobs[-1].expected[0])
    assert (await rig.driver.predict("gaze", {"yaw": 10.0})).seconds is None
