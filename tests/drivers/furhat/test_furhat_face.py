"""Gestures, emotions, single parameters, and where it looks."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from robot_simulators import furhat as simulator
from woz_drivers.furhat import furhat_face
from woz_drivers.furhat.furhat_head import direction_of, place_of
from woz_drivers.furhat.furhat_moves import COMMON_GESTURES, EMOTIONS, GESTURES
from woz_drivers.furhat.realtime_events import Place
from woz_drivers.furhat.settings import FurhatGazeSettings, FurhatSensesSettings, GestureFrame

from tests.drivers.furhat.acted import SOMEBODY, Acted, acted, looks_often
from woz_tui.drivers.contract import DriverError, RejectedError
from woz_tui.protocol.messages import Json
from woz_tui.testing import until


@pytest.fixture
async def it(tmp_path: Path) -> AsyncIterator[Acted]:
    async with acted(tmp_path) as it:
        yield it


def test_the_simulated_robot_has_the_gestures_that_are_offered() -> None:
    assert {*GESTURES} == {*simulator.GESTURES}
    assert {*COMMON_GESTURES.values()} <= {*GESTURES}


async def test_a_common_gesture_is_the_robots_own_and_ends_with_it(it: Acted) -> None:
    playing = it.begin("play", move="nod", speed=2.0, amplitude=0.5)
    await until(lambda: it.robot.gesturing == ["Nod"])
    assert it.robot.requests("request.gesture.start") == [
        {"name": "Nod", "intensity": 0.5, "duration": 0.5, "monitor": True}
    ]
    assert not playing.done()
    assert await it.ended(playing) == {"move": "nod", "gesture": "Nod"}


async def test_the_robots_own_names_are_taken_too(it: Acted) -> None:
    assert (await it.do("play", move="ExpressSad"))["gesture"] == "ExpressSad"
    with pytest.raises(RejectedError):
        await it.do("play", move="somersault")


async def test_a_gesture_that_its_software_does_not_have_is_told(
    it: Acted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(furhat_face, "_BEGINS_WITHIN_S", 0.1)
    it.robot.ignored.add("request.gesture.start")
    with pytest.raises(DriverError, match="Wink"):
        await it.begin("play", move="wink")


async def test_a_cancelled_gesture_ends_and_the_emotion_stays(it: Acted) -> None:
    await it.do("emotion", emotion="happy")
    await it.arrived()
    happy = dict(it.robot.face)
    playing = it.begin("play", move="Roll")
    await until(lambda: bool(it.robot.gesturing))
    playing.cancel()
    await until(lambda: not it.robot.gesturing and it.robot.face == happy)


async def test_a_gesture_of_the_robot_file_is_face_and_head_over_time(tmp_path: Path) -> None:
    doubt = (
        GestureFrame(0.1, {"BROW_DOWN_LEFT": 1.0}, yaw=10.0),
        GestureFrame(0.05, {"BROW_DOWN_LEFT": 0.5, "JAW_OPEN": 0.2}),
    )
    async with acted(tmp_path, gestures={"doubt": doubt}) as it:
        await it.do("gaze", yaw=5.0, pitch=0.0)
        assert await it.do("play", move="doubt") == {"move": "doubt"}
        await it.arrived()
        params = it.robot.requests("request.face.params")
        brow = [sent["params"].get("BROW_DOWN_LEFT") for sent in params]
        assert 1.0 in brow
        assert it.robot.face["BROW_DOWN_LEFT"] == 0.0  # as before
        places = it.robot.requests("request.attend.location")
        yaws = [round(direction_of(_place(place))[0]) for place in places]
        assert yaws == [5, 15, 5]


async def test_moves_of_other_robots_are_done_with_the_head(it: Acted) -> None:
    await it.do("play", move="point-left", speed=4.0)
    await it.arrived()
    places = it.robot.requests("request.attend.location")
    assert max(place["x"] for place in places) > 0.5  # to its left
    assert direction_of(_place(places[-1])) == pytest.approx((0.0, 0.0))


async def test_an_emotion_comes_gradually_and_replaces_the_one_before(
    it: Acted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(furhat_face, "_FADE_S", 0.1)
    for emotion in ("amazed", "angry", "neutral", "happy"):
        await it.do("emotion", emotion=emotion, intensity=0.5)
        await it.arrived()
        shown = {name: share for name, share in it.robot.face.items() if share}
        wanted = {name: share * 0.5 for name, share in EMOTIONS[emotion].items()}
        assert shown == pytest.approx(wanted, abs=1e-3)
    monkeypatch.setattr(furhat_face, "_FADE_S", 600.0)
    it.begin("emotion", emotion="neutral")
    smile = it.robot.face["MOUTH_SMILE_LEFT"]
    await until(lambda: 0.0 < it.robot.face["MOUTH_SMILE_LEFT"] < smile)


async def test_poses_set_face_parameters_over_time(it: Acted) -> None:
    sent = await it.do(
        "poses",
        poses=[
            {"joints": {"JAW_OPEN": 1.0}, "seconds": 0.1},
            {"joints": {"JAW_OPEN": 0.25, "NECK_TILT": 90.0}, "seconds": 0.0},
        ],
    )
    assert sent == {"joints": {"JAW_OPEN": 0.25, "NECK_TILT": 30.0}}  # no farther than it may
    await until(lambda: it.robot.face.get("JAW_OPEN") == 0.25)
    await it.do("home")
    await until(lambda: not any(it.robot.face.values()))
    with pytest.raises(RejectedError):
        await it.do("pose", joints={"ELBOW": 1.0})


async def test_the_face_is_changed_and_what_it_does_not_have_is_refused(tmp_path: Path) -> None:
    async with acted(tmp_path, face="adult - Isabel") as it:
        assert it.robot.face_id == "adult - Isabel"
        sent = await it.do("face", face="child - Billy", blinking=False)
        assert sent == {"face": "child - Billy", "blinking": False}
        assert it.robot.face_id == "child - Billy"
        with pytest.raises(RejectedError) as refused:
            await it.do("face", face="adult - Isabell")
        assert "adult - Isabel" in refused.value.remedy


# -- where it looks --------------------------------------------------------------------------------


def _place(sent: dict[str, float]) -> Place:
    return Place(sent["x"], sent["y"], sent["z"])


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(("yaw", "pitch"), [(0, 0), (40, 0), (-75, 20), (10, -45), (0.5, 45)])
def test_a_direction_is_a_place_and_back(yaw: float, pitch: float, mirrored: bool) -> None:
    place = place_of(yaw, pitch, mirrored=mirrored)
    assert direction_of(place, mirrored=mirrored) == pytest.approx((yaw, pitch), abs=0.01)


async def test_left_is_positive_and_down_is_positive(it: Acted) -> None:
    assert await it.do("gaze", yaw=30.0, pitch=20.0) == {"yaw": 30.0, "pitch": 20.0}
    await until(lambda: it.robot.attended == "location")
    x, y, z = it.robot.location
    assert x > 0.5 and y < -0.3 and z > 0.5


async def test_a_mirrored_robot_is_told_the_other_side(tmp_path: Path) -> None:
    async with acted(tmp_path, attention=FurhatGazeSettings(mirrored=True)) as it:
        await it.do("gaze", yaw=30.0, pitch=0.0)
        await until(lambda: it.robot.attended == "location")
        assert it.robot.location[0] < -0.5


async def test_it_turns_no_farther_than_it_can(it: Acted) -> None:
    assert await it.do("gaze", yaw=170.0, pitch=-90.0) == {"yaw": 75.0, "pitch": -45.0}


async def test_a_step_begins_where_it_looks_also_at_somebody(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks_often(monkeypatch)
    async with acted(tmp_path, senses=FurhatSensesSettings(loudness=False)) as it:
        assert await it.do("nudge", yaw=10.0) == {"yaw": 10.0, "pitch": 0.0}
        assert await it.do("nudge", yaw=5.0, pitch=-5.0) == {"yaw": 15.0, "pitch": -5.0}
        it.robot.person = SOMEBODY
        await it.passes(0.2)
        await until(lambda: it.shown["seen"] == "user-1")  # and so the wizard knows whom to name
        await it.do("follow", user="closest")
        await until(lambda: it.shown["attends"] == "user-1")
        assert (await it.do("nudge", yaw=10.0))["yaw"] == pytest.approx(30.05, abs=0.1)
        await it.do("follow", user="closest")
        await it.do("play", move="bow", speed=4.0)
        await until(lambda: it.shown["attends"] == "user-1")
        await it.do("follow", user="nobody")
        await until(lambda: it.robot.attended == "nobody")


@pytest.mark.parametrize(("color", "led"), [("off", "#000000"), ("#102030", "#102030")])
async def test_eyes_colour_the_ring(it: Acted, color: str, led: str) -> None:
    await it.do("eyes", color="red")
    await until(lambda: it.robot.led == "#ff0000")
    await it.do("eyes", color=color)
    await until(lambda: it.robot.led == led)


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
    it: Acted, verb: str, args: dict[str, Json]
) -> None:
    foretold = await it.driver.predict(verb, args)
    await it.do(verb, **args)
    assert foretold.seconds == pytest.approx(it.jobs[-1].expected[0])
    assert (await it.driver.predict("gaze", {"yaw": 10.0})).seconds is None
