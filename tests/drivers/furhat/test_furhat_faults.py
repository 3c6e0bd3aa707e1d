"""Loss and return, a frozen robot, wrong answers, a wrong key, a second program."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from robot_simulators import furhat as simulator
from robot_simulators.furhat import FurhatSimulator
from woz_drivers.furhat import Furhat, FurhatSettings, light, link, speech
from woz_drivers.furhat.head import direction_of
from woz_drivers.furhat.realtime_events import Place
from woz_drivers.furhat.settings import FurhatSensesSettings, FurhatVoiceSettings
from woz_drivers.lines import web_socket_line

from tests.drivers.furhat.furhat_rig import DEAF, QUIET, FurhatRig, connected_furhat
from tests.fakes.manual_pace import ManualPace
from woz_tui.drivers.contract import DeviceLostError, DriverError, Health
from woz_tui.system.clock import ManualClock
from woz_tui.testing import PlainJob, RecordingContext, until

LONG = "What I have to say has no end."


@pytest.fixture
async def rig(tmp_path: Path) -> AsyncIterator[FurhatRig]:
    async with connected_furhat(tmp_path, voice=FurhatVoiceSettings(volume=0.4)) as furhat_rig:
        yield furhat_rig


async def test_what_goes_on_ends_with_the_connection_and_comes_back_by_itself(
    rig: FurhatRig,
) -> None:
    await rig.do("eyes", color="green")
    await rig.do("emotion", emotion="happy")
    await rig.do("gaze", yaw=20.0, pitch=0.0)
    await rig.do("face", face="adult - Isabel")
    saying = rig.begin("say", text=LONG)
    playing = rig.begin("play", move="Roll")
    posing = rig.begin("pose", joints={"JAW_OPEN": 0.1}, seconds=60.0)
    await until(lambda: bool(rig.robot.speaking and rig.robot.gesturing))
    rig.robot.drop()
    for job in (saying, playing, posing):
        with pytest.raises(DeviceLostError):
            await job
    await rig.is_there()
    # What it still had to say it must not say now, and it looks as before.
    assert not rig.robot.speaking
    await rig.arrived()
    assert rig.robot.led == "#00ff00"
    assert rig.robot.face["MOUTH_SMILE_LEFT"] > 0.5
    assert rig.robot.attended == "location"
    assert rig.robot.face_id == "adult - Isabel"


@pytest.mark.parametrize("yaw", [0.0, 20.0])
async def test_a_robot_that_is_lost_in_a_gesture_of_ours_looks_as_before_when_it_is_back(
    rig: FurhatRig, yaw: float
) -> None:
    if yaw:
        await rig.do("gaze", yaw=yaw, pitch=0.0)
    playing = rig.begin("play", move="point-left", speed=0.1)
    await until(lambda: rig.robot.location[0] > 0.6)  # metres to its left: in the gesture
    rig.robot.drop()
    with pytest.raises(DeviceLostError):
        await playing
    await rig.is_there()
    await rig.arrived()
    assert direction_of(Place(*rig.robot.location)) == pytest.approx((yaw, 0.0), abs=0.01)


async def test_a_robot_that_was_started_anew_gets_everything_again(rig: FurhatRig) -> None:
    await rig.do("eyes", color="green")
    await rig.robot.close()
    await rig.is_lost()
    with pytest.raises(DeviceLostError):
        await rig.do("say", text=LONG)
    rig.robot.led, rig.robot.volume, rig.robot.face_id = "#000000", 90, "adult - Alex"
    await rig.robot.start()
    await rig.is_there()
    await rig.arrived()
    assert rig.robot.led == "#00ff00"
    assert rig.robot.requests("request.system.config")[-2] == {"volume": 40}


async def test_a_volume_that_nobody_asked_for_is_left_to_the_robot(tmp_path: Path) -> None:
    async with connected_furhat(tmp_path, voice=FurhatVoiceSettings()) as furhat_rig:
        await until(
            lambda: furhat_rig.settings_shown.get("volume") == furhat_rig.robot.volume / 100
        )
        await furhat_rig.robot.close()
        await furhat_rig.is_lost()
        furhat_rig.robot.volume = 90
        await furhat_rig.robot.start()
        await furhat_rig.is_there()
        await until(lambda: furhat_rig.settings_shown.get("volume") == 0.9)
        assert not furhat_rig.robot.requests("request.system.config")


async def test_a_light_that_comes_and_goes_does_so_again_when_the_robot_is_back(
    rig: FurhatRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(light, "_HALF_S", 0.02)
    await rig.do("eyes", color="green", animation="intermittent")
    rig.robot.drop()
    await rig.is_lost()
    await rig.is_there()
    before = len(rig.robot.requests("request.led.set"))
    await until(lambda: len(rig.robot.requests("request.led.set")) > before + 3)
    assert {"color": "#000000"} in rig.robot.requests("request.led.set")[before:]


async def test_a_face_that_the_robot_lacks_for_a_while_is_shown_when_it_has_it(
    rig: FurhatRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    await rig.do("face", face="adult - Isabel", blinking=False)
    monkeypatch.setattr(simulator, "FACES", ("adult - Alex",))
    rig.robot.face_id = "adult - Alex"
    rig.robot.drop()
    await rig.is_lost()
    await rig.is_there()
    assert "adult - Isabel" in rig.notices
    assert rig.settings_shown["face"] == "adult - Alex"
    assert rig.robot.requests("request.face.config")[-1] == {"blinking": False}
    monkeypatch.undo()
    rig.robot.drop()
    await rig.is_lost()
    await rig.is_there()
    await rig.arrived()
    assert rig.robot.face_id == "adult - Isabel"


async def test_a_frozen_robot_is_noticed_and_says_nothing_late(
    rig: FurhatRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(web_socket_line, "_PING_S", 0.05)
    monkeypatch.setattr(web_socket_line, "_SILENCE_S", 0.4)
    rig.robot.freeze()
    saying = rig.begin("say", text=LONG)
    with pytest.raises(DeviceLostError):
        await saying
    assert rig.healthy is Health.LOST
    rig.robot.thaw()
    await rig.is_there()
    assert not rig.robot.speaking


async def test_what_is_no_event_is_told_once_and_the_robot_goes_on(rig: FurhatRig) -> None:
    wrong = ("nonsense", "[" * 5000, "[1, 2]", '{"type": 7}', '{"type": "response.users.data"}')
    for nonsense in wrong:
        await rig.robot.send_raw(nonsense)
    await rig.robot.send_raw('{"type": "response.something.new", "more": [1]}')
    assert (await rig.do("say", text="Hello"))["text"] == "Hello"
    assert len(rig.context.notices) == 1
    assert rig.healthy is Health.CONNECTED


async def test_users_that_make_no_sense_are_left_out(tmp_path: Path) -> None:
    async with connected_furhat(
        tmp_path, senses=FurhatSensesSettings(loudness=False)
    ) as furhat_rig:
        await until(lambda: bool(furhat_rig.context.of("presence")))
        before = len(furhat_rig.context.readings)
        for distance in ("far", None, -3.0, 1e9):
            user = {"id": "u", "x": 1e12, "z": -1.0, "distance": distance}
            event = {"type": "response.users.data", "users": [user]}
            await furhat_rig.robot.send_raw(json.dumps(event))
        await furhat_rig.arrived()
        values = [
            one.value for one in furhat_rig.context.readings[before:] if one.sensor == "distance"
        ]
        assert all(value is None or 0 < value < 30 for value in values)


async def test_an_error_without_an_id_goes_to_the_request_that_is_open(rig: FurhatRig) -> None:
    saying = rig.begin("say", text=LONG)
    await until(lambda: bool(rig.robot.speaking))
    await rig.robot.send_raw('{"type": "response.error", "error": "the loudspeaker is broken"}')
    with pytest.raises(DriverError, match="the loudspeaker is broken"):
        await saying
    await rig.robot.send_raw('{"type": "response.error", "error": "too hot"}')
    await until(lambda: "too hot" in rig.notices)


async def test_events_without_an_id_answer_the_request_that_is_open(rig: FurhatRig) -> None:
    rig.robot.ignored.add("request.gesture.start")
    playing = rig.begin("play", move="nod")
    await until(lambda: bool(rig.robot.requests("request.gesture.start")))
    await rig.robot.send_raw('{"type": "response.gesture.start"}')
    await rig.robot.send_raw('{"type": "response.gesture.end"}')
    assert (await playing)["gesture"] == "Nod"


async def test_events_of_another_program_end_nothing_of_ours(rig: FurhatRig) -> None:
    saying = rig.begin("say", text=LONG)
    await until(lambda: bool(rig.robot.speaking))
    await rig.robot.send_raw('{"type": "response.speak.end", "request_id": "of-somebody-else"}')
    await rig.arrived()
    assert not saying.done()


async def test_late_answers_are_waited_for(rig: FurhatRig) -> None:
    rig.robot.faults.delay_s = 0.3
    assert (await rig.do("voice", name="Amy"))["voice"].startswith("Amy")  # type: ignore[union-attr]


async def test_an_answer_that_does_not_come_is_told(
    rig: FurhatRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig.robot.ignored.add("request.camera.once")
    monkeypatch.setattr(link.FurhatLink.ask, "__defaults__", (0.1,))
    with pytest.raises(DriverError, match=r"camera\.once"):
        await rig.begin("picture")
    assert rig.healthy is Health.CONNECTED


async def test_a_robot_that_lacks_something_is_played_without_it(tmp_path: Path) -> None:
    robot = FurhatSimulator(ManualPace(ManualClock()))
    robot.faults.refused["request.face.status"] = "unknown event"
    async with connected_furhat(tmp_path, robot) as furhat_rig:
        assert "unknown event" in furhat_rig.notices
        await furhat_rig.do("say", text="Hello")


@pytest.mark.parametrize("silent", [True, False])
async def test_a_robot_that_does_not_tell_its_volume_is_played_without_a_word(
    tmp_path: Path, silent: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = FurhatSimulator(ManualPace(ManualClock()))
    if silent:
        monkeypatch.setattr(speech, "_TELLS_WITHIN_S", 0.05)
        robot.ignored.add("request.system.status")
    else:
        robot.faults.refused["request.system.status"] = "unknown event"
    async with connected_furhat(tmp_path, robot) as furhat_rig:
        assert not furhat_rig.notices
        assert "volume" not in furhat_rig.settings_shown
        await furhat_rig.do("volume", level=0.4)
        assert furhat_rig.settings_shown["volume"] == 0.4


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
