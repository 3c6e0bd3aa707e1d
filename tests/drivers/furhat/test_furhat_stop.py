"""The stop: everything ends at once, and each part is confirmed by the robot's own event."""

from __future__ import annotations

import asyncio
import struct
import wave
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from woz_drivers.furhat import face, light, speech
from woz_drivers.furhat.settings import FurhatSensesSettings

from tests.drivers.furhat.furhat_rig import SOMEBODY, FurhatRig, connected_furhat
from woz_tui.bus.bus import Bus
from woz_tui.bus.hub import Hub
from woz_tui.drivers import confirmed_stop
from woz_tui.drivers.contract import DeviceLostError, DriverError, Scope, StopReport
from woz_tui.protocol.messages import Command, DriverConnected, Json, Message, StopConfirmed
from woz_tui.testing import until

pytestmark = pytest.mark.safety

LONG = "A very long story that nobody wants to hear to its end. " * 10
PARTS = ("gaze", "gesture", "speech")


@pytest.fixture
def unhurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """A busy machine takes its time; that a stop waits no longer is another test's."""
    monkeypatch.setattr(confirmed_stop, "STOP_S", 20.0)


@pytest.fixture
def hurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """What does not confirm need not be waited for."""
    monkeypatch.setattr(confirmed_stop, "STOP_S", 0.15)


@pytest.fixture
async def rig(tmp_path: Path) -> AsyncIterator[FurhatRig]:
    async with connected_furhat(
        tmp_path, senses=FurhatSensesSettings(loudness=False)
    ) as furhat_rig:
        yield furhat_rig


async def busy(furhat_rig: FurhatRig) -> None:
    """Let it do everything at once."""
    furhat_rig.robot.person = SOMEBODY
    await furhat_rig.passes(0.2)
    await furhat_rig.do("emotion", emotion="happy")
    await furhat_rig.do("follow", user="closest")
    await furhat_rig.do("eyes", color="red", animation="intermittent")
    furhat_rig.begin("say", text=LONG)
    furhat_rig.begin("play", move="Roll", speed=0.1)
    await until(lambda: bool(furhat_rig.robot.speaking and furhat_rig.robot.gesturing))
    await until(lambda: furhat_rig.robot.attended == "user-1")
    await until(lambda: furhat_rig.settings_shown["attends"] == "user-1")


@pytest.mark.usefixtures("unhurried")
async def test_everything_ends_and_each_part_confirms(rig: FurhatRig) -> None:
    await busy(rig)
    await rig.arrived()
    face = dict(rig.robot.face)
    report = await rig.stop()
    assert report == StopReport(confirmed=PARTS)
    assert (rig.robot.speaking, rig.robot.gesturing) == ("", [])
    assert rig.robot.attended == "location"  # where the person was, whom it follows no further
    assert rig.robot.location[0] == pytest.approx(0.51, abs=0.05)
    await rig.arrived()
    assert rig.robot.face == face  # the expression stays
    assert rig.robot.led == "#ff0000"
    await rig.do("say", text="Hello")  # and all of it works again
    await rig.do("play", move="nod")


@pytest.mark.usefixtures("unhurried")
async def test_with_nothing_going_on_whoever_speaks_through_it_falls_silent(rig: FurhatRig) -> None:
    await rig.arrived()
    assert await rig.stop() == StopReport(confirmed=PARTS)
    assert rig.robot.calls[-2][0] == "request.speak.stop"


@pytest.mark.usefixtures("unhurried")
async def test_a_sound_and_a_gesture_of_ours_end(rig: FurhatRig, tmp_path: Path) -> None:
    with wave.open(str(tmp_path / "long.wav"), "wb") as made:
        made.setparams((1, 2, 8000, 0, "NONE", ""))
        made.writeframes(struct.pack("<80000h", *([1000] * 80000)))
    rig.begin("sound", file="long.wav")
    rig.begin("play", move="dance", speed=0.1)
    await until(lambda: bool(rig.robot.speaking and rig.robot.face))
    assert (await rig.stop()).missing == ()
    assert not rig.robot.speaking
    await rig.arrived()
    sent = len(rig.robot.calls)
    await rig.arrived()
    assert len(rig.robot.calls) - sent == 1  # nothing of either comes behind the stop


@pytest.mark.usefixtures("hurried")
async def test_a_gesture_that_the_robot_plays_to_its_end_is_named(rig: FurhatRig) -> None:
    rig.robot.gestures_end_early = False
    await busy(rig)
    report = await rig.stop()
    assert "gesture" in report.missing
    assert rig.robot.gesturing


@pytest.mark.usefixtures("hurried")
async def test_a_robot_that_does_not_end_its_speech_is_named(rig: FurhatRig) -> None:
    await busy(rig)
    rig.robot.ignored.add("request.speak.stop")
    assert "speech" in (await rig.stop()).missing
    assert rig.robot.speaking


@pytest.mark.usefixtures("hurried")
async def test_a_frozen_robot_confirms_nothing(rig: FurhatRig) -> None:
    await busy(rig)
    rig.robot.freeze()
    assert await rig.stop() == StopReport(missing=PARTS)


@pytest.mark.usefixtures("unhurried")
@pytest.mark.parametrize(
    ("request_", "verb", "args"),
    [
        ("request.speak.text", "say", {"text": LONG}),
        ("request.gesture.start", "play", {"move": "nod"}),
    ],
)
async def test_what_the_robot_refused_is_nothing_that_has_to_end(
    rig: FurhatRig, request_: str, verb: str, args: dict[str, str]
) -> None:
    rig.robot.faults.refused[request_] = "not now"
    with pytest.raises(DriverError, match="not now"):
        await rig.do(verb, **args)
    assert await rig.stop() == StopReport(confirmed=PARTS)


@pytest.mark.usefixtures("unhurried")
async def test_what_did_not_begin_in_time_is_ended_and_the_stop_waits_for_it_no_more(
    rig: FurhatRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(speech, "_BEGINS_WITHIN_S", 0.1)
    monkeypatch.setattr(face, "_BEGINS_WITHIN_S", 0.1)
    rig.robot.ignored |= {"request.speak.text", "request.gesture.start"}
    with pytest.raises(DriverError, match="did not begin"):
        await rig.begin("say", text=LONG)
    resets = len(rig.robot.requests("request.face.reset"))
    with pytest.raises(DriverError, match="Nod"):
        await rig.begin("play", move="nod")
    await until(lambda: len(rig.robot.requests("request.face.reset")) > resets)
    assert await rig.stop() == StopReport(confirmed=PARTS)


@pytest.mark.usefixtures("unhurried")
@pytest.mark.parametrize("stopped", [True, False])
async def test_an_interrupted_gesture_of_ours_leaves_nothing_in_the_face(
    rig: FurhatRig, stopped: bool
) -> None:
    await rig.do("pose", joints={"JAW_OPEN": 0.5})
    await rig.do("emotion", emotion="friendly")
    await rig.arrived()
    face = dict(rig.robot.face)
    dancing = rig.begin("play", move="dance", speed=0.5)
    await until(lambda: rig.robot.face.get("NECK_ROLL", 0.0) > 1)
    if stopped:
        await rig.stop()
    else:
        dancing.cancel()
    await until(lambda: {**rig.robot.face, "NECK_ROLL": 0.0} == {**face, "NECK_ROLL": 0.0})
    assert rig.robot.face["NECK_ROLL"] == 0.0
    await rig.do("play", move="dance", speed=20.0)
    await rig.arrived()
    assert rig.robot.face == {**face, "NECK_ROLL": 0.0}


async def test_a_stop_beside_the_loss_names_what_may_go_on(rig: FurhatRig) -> None:
    for moments in range(12):
        await rig.do("eyes", color="red", animation="intermittent")
        rig.context.healths.clear()
        rig.robot.drop()
        for _ in range(moments):
            await asyncio.sleep(0)
        report = await rig.driver.stop(Scope.ALL)
        assert report in (None, StopReport(missing=PARTS))
        await until(lambda: bool(rig.context.healths))
        await rig.is_there()


async def test_a_robot_that_is_lost_has_nothing_to_confirm(rig: FurhatRig) -> None:
    saying = rig.begin("say", text=LONG)
    await until(lambda: bool(rig.robot.speaking))
    await rig.robot.close()
    await rig.is_lost()
    assert await rig.driver.stop(Scope.ALL) is None
    with pytest.raises(DeviceLostError):
        await saying


async def test_a_robot_that_is_away_at_the_stop_follows_nobody_when_it_is_back(
    rig: FurhatRig,
) -> None:
    rig.robot.person = SOMEBODY
    await rig.do("follow", user="closest")
    await until(lambda: rig.robot.attended == "user-1")
    await rig.robot.close()
    await rig.is_lost()
    assert await rig.driver.stop(Scope.ALL) is None
    await rig.robot.start()
    await rig.is_there()
    await rig.arrived()
    assert (
        rig.robot.requests("request.attend.user") == rig.robot.requests("request.attend.user")[:1]
    )


async def test_a_robot_that_followed_on_while_it_was_away_looks_straight_on(rig: FurhatRig) -> None:
    await rig.do("follow", user="user-9")  # whom it has not seen yet
    await rig.robot.close()
    await rig.is_lost()
    assert await rig.driver.stop(Scope.ALL) is None
    await rig.robot.start()
    await rig.is_there()
    await until(lambda: rig.robot.attended == "location")


async def test_a_light_that_was_stopped_while_the_robot_was_away_stays(
    rig: FurhatRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(light, "_HALF_S", 0.01)
    await rig.do("eyes", color="red", animation="intermittent")
    await rig.robot.close()
    await rig.is_lost()
    assert await rig.driver.stop(Scope.ALL) is None
    await rig.robot.start()
    await rig.is_there()
    await rig.arrived()
    sent = len(rig.robot.requests("request.led.set"))
    for _ in range(10):
        await rig.arrived()
    assert len(rig.robot.requests("request.led.set")) == sent
    assert rig.robot.led == "#ff0000"


async def test_a_stop_of_driving_alone_does_not_silence_it(rig: FurhatRig) -> None:
    rig.begin("say", text=LONG)
    await until(lambda: bool(rig.robot.speaking))
    assert await rig.driver.stop(Scope.DRIVE) is None
    assert rig.robot.speaking


async def test_a_session_hears_which_part_did_not_confirm(rig: FurhatRig) -> None:
    """As the wizard's red bar names it."""
    messages: list[Message] = []
    hub = Hub(rig.context.clock, lambda message, line: None)
    hub.listen(messages.append)
    bus = Bus(hub, {"it": rig.driver}, {"it": rig.driver.offer(rig.driver.settings).verbs})
    hub.publish(DriverConnected(driver="it"))
    rig.robot.gestures_end_early = False
    orders: dict[str, dict[str, Json]] = {
        "say": {"text": LONG},
        "play": {"move": "Roll", "speed": 0.1},
    }
    for verb, args in orders.items():
        command = Command(command=verb, driver="it", verb=verb, args=args, source="key")
        bus.submit(command)
    await until(lambda: bool(rig.robot.speaking and rig.robot.gesturing))
    await bus.stop("key")
    (confirmed,) = [one for one in messages if isinstance(one, StopConfirmed)]
    assert confirmed.missing == ["it"]
    assert "gesture" not in confirmed.parts.get("it", [])
    await until(lambda: not rig.robot.speaking)
    bus.release("key")
    await bus.drain(2)
