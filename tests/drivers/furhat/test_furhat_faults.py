"""Loss and return, a frozen robot, wrong answers, a wrong key, a second program."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from robot_simulators import furhat as simulator
from robot_simulators.furhat import FurhatSimulator
from woz_drivers import web_socket_line
from woz_drivers.furhat import Furhat, FurhatSettings, furhat_light, furhat_link, furhat_speech
from woz_drivers.furhat.furhat_head import direction_of
from woz_drivers.furhat.realtime_events import Place
from woz_drivers.furhat.settings import FurhatSensesSettings, FurhatVoiceSettings

from tests.drivers.furhat.acted import DEAF, QUIET, Acted, acted
from tests.fakes.manual_pace import ManualPace
from woz_tui.drivers.contract import DeviceLostError, DriverError, Health
from woz_tui.system.clock import ManualClock
from woz_tui.testing import PlainJob, RecordingContext, until

LONG = "What I have to say has no end."


@pytest.fixture
async def it(tmp_path: Path) -> AsyncIterator[Acted]:
    async with acted(tmp_path, voice=FurhatVoiceSettings(volume=0.4)) as it:
        yield it


async def test_what_goes_on_ends_with_the_connection_and_comes_back_by_itself(it: Acted) -> None:
    await it.do("eyes", color="green")
    await it.do("emotion", emotion="happy")
    await it.do("gaze", yaw=20.0, pitch=0.0)
    await it.do("face", face="adult - Isabel")
    saying = it.begin("say", text=LONG)
    playing = it.begin("play", move="Roll")
    posing = it.begin("pose", joints={"JAW_OPEN": 0.1}, seconds=60.0)
    await until(lambda: bool(it.robot.speaking and it.robot.gesturing))
    it.robot.drop()
    for job in (saying, playing, posing):
        with pytest.raises(DeviceLostError):
            await job
    await it.is_there()
    # What it still had to say it must not say now, and it looks as before.
    assert not it.robot.speaking
    await it.arrived()
    assert it.robot.led == "#00ff00"
    assert it.robot.face["MOUTH_SMILE_LEFT"] > 0.5
    assert it.robot.attended == "location"
    assert it.robot.face_id == "adult - Isabel"


@pytest.mark.parametrize("yaw", [0.0, 20.0])
async def test_a_robot_that_is_lost_in_a_gesture_of_ours_looks_as_before_when_it_is_back(
    it: Acted, yaw: float
) -> None:
    if yaw:
        await it.do("gaze", yaw=yaw, pitch=0.0)
    playing = it.begin("play", move="point-left", speed=0.1)
    await until(lambda: it.robot.location[0] > 0.6)  # metres to its left: in the gesture
    it.robot.drop()
    with pytest.raises(DeviceLostError):
        await playing
    await it.is_there()
    await it.arrived()
    assert direction_of(Place(*it.robot.location)) == pytest.approx((yaw, 0.0), abs=0.01)


async def test_a_robot_that_was_started_anew_gets_everything_again(it: Acted) -> None:
    await it.do("eyes", color="green")
    await it.robot.close()
    await it.is_lost()
    with pytest.raises(DeviceLostError):
        await it.do("say", text=LONG)
    it.robot.led, it.robot.volume, it.robot.face_id = "#000000", 90, "adult - Alex"
    await it.robot.start()
    await it.is_there()
    await it.arrived()
    assert it.robot.led == "#00ff00"
    assert it.robot.requests("request.system.config")[-2] == {"volume": 40}


async def test_a_volume_that_nobody_asked_for_is_left_to_the_robot(tmp_path: Path) -> None:
    async with acted(tmp_path, voice=FurhatVoiceSettings()) as it:
        await until(lambda: it.shown.get("volume") == it.robot.volume / 100)
        await it.robot.close()
        await it.is_lost()
        it.robot.volume = 90
        await it.robot.start()
        await it.is_there()
        await until(lambda: it.shown.get("volume") == 0.9)
        assert not it.robot.requests("request.system.config")


async def test_a_light_that_comes_and_goes_does_so_again_when_the_robot_is_back(
    it: Acted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(furhat_light, "_HALF_S", 0.02)
    await it.do("eyes", color="green", animation="intermittent")
    it.robot.drop()
    await it.is_lost()
    await it.is_there()
    before = len(it.robot.requests("request.led.set"))
    await until(lambda: len(it.robot.requests("request.led.set")) > before + 3)
    assert {"color": "#000000"} in it.robot.requests("request.led.set")[before:]


async def test_a_face_that_the_robot_lacks_for_a_while_is_shown_when_it_has_it(
    it: Acted, monkeypatch: pytest.MonkeyPatch
) -> None:
    await it.do("face", face="adult - Isabel", blinking=False)
    monkeypatch.setattr(simulator, "FACES", ("adult - Alex",))
    it.robot.face_id = "adult - Alex"
    it.robot.drop()
    await it.is_lost()
    await it.is_there()
    assert "adult - Isabel" in it.notices
    assert it.shown["face"] == "adult - Alex"
    assert it.robot.requests("request.face.config")[-1] == {"blinking": False}
    monkeypatch.undo()
    it.robot.drop()
    await it.is_lost()
    await it.is_there()
    await it.arrived()
    assert it.robot.face_id == "adult - Isabel"


async def test_a_frozen_robot_is_noticed_and_says_nothing_late(
    it: Acted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(web_socket_line, "_PING_S", 0.05)
    monkeypatch.setattr(web_socket_line, "_SILENCE_S", 0.4)
    it.robot.freeze()
    saying = it.begin("say", text=LONG)
    with pytest.raises(DeviceLostError):
        await saying
    assert it.healthy is Health.LOST
    it.robot.thaw()
    await it.is_there()
    assert not it.robot.speaking


async def test_what_is_no_event_is_told_once_and_the_robot_goes_on(it: Acted) -> None:
    wrong = ("nonsense", "[" * 5000, "[1, 2]", '{"type": 7}', '{"type": "response.users.data"}')
    for nonsense in wrong:
        await it.robot.send_raw(nonsense)
    await it.robot.send_raw('{"type": "response.something.new", "more": [1]}')
    assert (await it.do("say", text="Hello"))["text"] == "Hello"
    assert len(it.context.notices) == 1
    assert it.healthy is Health.CONNECTED


async def test_users_that_make_no_sense_are_left_out(tmp_path: Path) -> None:
    async with acted(tmp_path, senses=FurhatSensesSettings(loudness=False)) as it:
        await until(lambda: bool(it.context.of("presence")))
        before = len(it.context.readings)
        for distance in ("far", None, -3.0, 1e9):
            user = {"id": "u", "x": 1e12, "z": -1.0, "distance": distance}
            event = {"type": "response.users.data", "users": [user]}
            await it.robot.send_raw(json.dumps(event))
        await it.arrived()
        values = [one.value for one in it.context.readings[before:] if one.sensor == "distance"]
        assert all(value is None or 0 < value < 30 for value in values)


async def test_an_error_without_an_id_goes_to_the_request_that_is_open(it: Acted) -> None:
    saying = it.begin("say", text=LONG)
    await until(lambda: bool(it.robot.speaking))
    await it.robot.send_raw('{"type": "response.error", "error": "the loudspeaker is broken"}')
    with pytest.raises(DriverError, match="the loudspeaker is broken"):
        await saying
    await it.robot.send_raw('{"type": "response.error", "error": "too hot"}')
    await until(lambda: "too hot" in it.notices)


async def test_events_without_an_id_answer_the_request_that_is_open(it: Acted) -> None:
    it.robot.ignored.add("request.gesture.start")
    playing = it.begin("play", move="nod")
    await until(lambda: bool(it.robot.requests("request.gesture.start")))
    await it.robot.send_raw('{"type": "response.gesture.start"}')
    await it.robot.send_raw('{"type": "response.gesture.end"}')
    assert (await playing)["gesture"] == "Nod"


async def test_events_of_another_program_end_nothing_of_ours(it: Acted) -> None:
    saying = it.begin("say", text=LONG)
    await until(lambda: bool(it.robot.speaking))
    await it.robot.send_raw('{"type": "response.speak.end", "request_id": "of-somebody-else"}')
    await it.arrived()
    assert not saying.done()


async def test_late_answers_are_waited_for(it: Acted) -> None:
    it.robot.faults.delay_s = 0.3
    assert (await it.do("voice", name="Amy"))["voice"].startswith("Amy")  # type: ignore[union-attr]


async def test_an_answer_that_does_not_come_is_told(
    it: Acted, monkeypatch: pytest.MonkeyPatch
) -> None:
    it.robot.ignored.add("request.camera.once")
    monkeypatch.setattr(furhat_link.FurhatLink.ask, "__defaults__", (0.1,))
    with pytest.raises(DriverError, match=r"camera\.once"):
        await it.begin("picture")
    assert it.healthy is Health.CONNECTED


async def test_a_robot_that_lacks_something_is_played_without_it(tmp_path: Path) -> None:
    robot = FurhatSimulator(ManualPace(ManualClock()))
    robot.faults.refused["request.face.status"] = "unknown event"
    async with acted(tmp_path, robot) as it:
        assert "unknown event" in it.notices
        await it.do("say", text="Hello")


@pytest.mark.parametrize("silent", [True, False])
async def test_a_robot_that_does_not_tell_its_volume_is_played_without_a_word(
    tmp_path: Path, silent: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = FurhatSimulator(ManualPace(ManualClock()))
    if silent:
        monkeypatch.setattr(furhat_speech, "_TELLS_WITHIN_S", 0.05)
        robot.ignored.add("request.system.status")
    else:
        robot.faults.refused["request.system.status"] = "unknown event"
    async with acted(tmp_path, robot) as it:
        assert not it.notices
        assert "volume" not in it.shown
        await it.do("volume", level=0.4)
        assert it.shown["volume"] == 0.4


# -- the key ---------------------------------------------------------------------------------------

KEY = "s3cr3t-k3y"


async def test_a_wrong_key_is_told_with_its_variable_and_never_itself(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MY_KEY", "wrong-" + KEY)
    async with FurhatSimulator(ManualPace(ManualClock()), key=KEY) as robot:
        context = RecordingContext(tmp_path)
        settings = FurhatSettings(address=robot.address, key="MY_KEY", senses=QUIET, listening=DEAF)
        driver = Furhat("it", settings, context)
        await driver.open()
        await until(lambda: context.healths[-1][0] is Health.LOST)
        assert "MY_KEY" in context.healths[-1][2]
        with pytest.raises(DeviceLostError):
            await driver.perform(PlainJob("say", {"text": LONG}))
        monkeypatch.setenv("MY_KEY", KEY)  # it is read anew each time
        await until(lambda: context.healths[-1][0] is Health.CONNECTED)
        await driver.close()
        assert KEY not in f"{context.healths}{context.notices}{context.shown}"
