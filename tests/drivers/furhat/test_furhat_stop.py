"""The stop: everything ends at once, and each part is confirmed by the robot's own event."""

from __future__ import annotations

import asyncio
import struct
import wave
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from woz_drivers import confirmed_stop
from woz_drivers.furhat import furhat_face, furhat_light, furhat_speech
from woz_drivers.furhat.settings import FurhatSensesSettings

from tests.drivers.furhat.acted import SOMEBODY, Acted, acted
from woz_tui.bus.bus import Bus
from woz_tui.bus.hub import Hub
from woz_tui.drivers.contract import DeviceLostError, DriverError, Scope, StopReport
from woz_tui.protocol.messages import AnyMessage, Command, DriverConnected, Json, StopConfirmed
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
async def it(tmp_path: Path) -> AsyncIterator[Acted]:
    async with acted(tmp_path, senses=FurhatSensesSettings(loudness=False)) as it:
        yield it


async def busy(it: Acted) -> None:
    """Let it do everything at once."""
    it.robot.person = SOMEBODY
    await it.passes(0.2)
    await it.do("emotion", emotion="happy")
    await it.do("follow", user="closest")
    await it.do("eyes", color="red", animation="intermittent")
    it.begin("say", text=LONG)
    it.begin("play", move="Roll", speed=0.1)
    await until(lambda: bool(it.robot.speaking and it.robot.gesturing))
    await until(lambda: it.robot.attended == "user-1")
    await until(lambda: it.shown["attends"] == "user-1")


@pytest.mark.usefixtures("unhurried")
async def test_everything_ends_and_each_part_confirms(it: Acted) -> None:
    await busy(it)
    await it.arrived()
    face = dict(it.robot.face)
    report = await it.stop()
    assert report == StopReport(confirmed=PARTS)
    assert (it.robot.speaking, it.robot.gesturing) == ("", [])
    assert it.robot.attended == "location"  # where the person was, whom it follows no further
    assert it.robot.location[0] == pytest.approx(0.51, abs=0.05)
    await it.arrived()
    assert it.robot.face == face  # the expression stays
    assert it.robot.led == "#ff0000"
    await it.do("say", text="Hello")  # and all of it works again
    await it.do("play", move="nod")


@pytest.mark.usefixtures("unhurried")
async def test_with_nothing_going_on_whoever_speaks_through_it_falls_silent(it: Acted) -> None:
    await it.arrived()
    assert await it.stop() == StopReport(confirmed=PARTS)
    assert it.robot.calls[-2][0] == "request.speak.stop"


@pytest.mark.usefixtures("unhurried")
async def test_a_sound_and_a_gesture_of_ours_end(it: Acted, tmp_path: Path) -> None:
    with wave.open(str(tmp_path / "long.wav"), "wb") as made:
        made.setparams((1, 2, 8000, 0, "NONE", ""))
        made.writeframes(struct.pack("<80000h", *([1000] * 80000)))
    it.begin("sound", file="long.wav")
    it.begin("play", move="dance", speed=0.1)
    await until(lambda: bool(it.robot.speaking and it.robot.face))
    assert (await it.stop()).missing == ()
    assert not it.robot.speaking
    await it.arrived()
    sent = len(it.robot.calls)
    await it.arrived()
    assert len(it.robot.calls) - sent == 1  # nothing of either comes behind the stop


@pytest.mark.usefixtures("hurried")
async def test_a_gesture_that_the_robot_plays_to_its_end_is_named(it: Acted) -> None:
    it.robot.gestures_end_early = False
    await busy(it)
    report = await it.stop()
    assert "gesture" in report.missing
    assert it.robot.gesturing


@pytest.mark.usefixtures("hurried")
async def test_a_robot_that_does_not_end_its_speech_is_named(it: Acted) -> None:
    await busy(it)
    it.robot.ignored.add("request.speak.stop")
    assert "speech" in (await it.stop()).missing
    assert it.robot.speaking


@pytest.mark.usefixtures("hurried")
async def test_a_frozen_robot_confirms_nothing(it: Acted) -> None:
    await busy(it)
    it.robot.freeze()
    assert await it.stop() == StopReport(missing=PARTS)


@pytest.mark.usefixtures("unhurried")
@pytest.mark.parametrize(
    ("request_", "verb", "args"),
    [
        ("request.speak.text", "say", {"text": LONG}),
        ("request.gesture.start", "play", {"move": "nod"}),
    ],
)
async def test_what_the_robot_refused_is_nothing_that_has_to_end(
    it: Acted, request_: str, verb: str, args: dict[str, str]
) -> None:
    it.robot.faults.refused[request_] = "not now"
    with pytest.raises(DriverError, match="not now"):
        await it.do(verb, **args)
    assert await it.stop() == StopReport(confirmed=PARTS)


@pytest.mark.usefixtures("unhurried")
async def test_what_did_not_begin_in_time_is_ended_and_the_stop_waits_for_it_no_more(
    it: Acted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(furhat_speech, "_BEGINS_WITHIN_S", 0.1)
    monkeypatch.setattr(furhat_face, "_BEGINS_WITHIN_S", 0.1)
    it.robot.ignored |= {"request.speak.text", "request.gesture.start"}
    with pytest.raises(DriverError, match="did not begin"):
        await it.begin("say", text=LONG)
    resets = len(it.robot.requests("request.face.reset"))
    with pytest.raises(DriverError, match="Nod"):
        await it.begin("play", move="nod")
    await until(lambda: len(it.robot.requests("request.face.reset")) > resets)
    assert await it.stop() == StopReport(confirmed=PARTS)


@pytest.mark.usefixtures("unhurried")
@pytest.mark.parametrize("stopped", [True, False])
async def test_an_interrupted_gesture_of_ours_leaves_nothing_in_the_face(
    it: Acted, stopped: bool
) -> None:
    await it.do("pose", joints={"JAW_OPEN": 0.5})
    await it.do("emotion", emotion="friendly")
    await it.arrived()
    face = dict(it.robot.face)
    dancing = it.begin("play", move="dance", speed=0.5)
    await until(lambda: it.robot.face.get("NECK_ROLL", 0.0) > 1)
    if stopped:
        await it.stop()
    else:
        dancing.cancel()
    await until(lambda: {**it.robot.face, "NECK_ROLL": 0.0} == {**face, "NECK_ROLL": 0.0})
    assert it.robot.face["NECK_ROLL"] == 0.0
    await it.do("play", move="dance", speed=20.0)
    await it.arrived()
    assert it.robot.face == {**face, "NECK_ROLL": 0.0}


async def test_a_stop_beside_the_loss_names_what_may_go_on(it: Acted) -> None:
    for moments in range(12):
        await it.do("eyes", color="red", animation="intermittent")
        it.context.healths.clear()
        it.robot.drop()
        for _ in range(moments):
            await asyncio.sleep(0)
        report = await it.driver.stop(Scope.ALL)
        assert report in (None, StopReport(missing=PARTS))
        await until(lambda: bool(it.context.healths))
        await it.is_there()


async def test_a_robot_that_is_lost_has_nothing_to_confirm(it: Acted) -> None:
    saying = it.begin("say", text=LONG)
    await until(lambda: bool(it.robot.speaking))
    await it.robot.close()
    await it.is_lost()
    assert await it.driver.stop(Scope.ALL) is None
    with pytest.raises(DeviceLostError):
        await saying


async def test_a_robot_that_is_away_at_the_stop_follows_nobody_when_it_is_back(it: Acted) -> None:
    it.robot.person = SOMEBODY
    await it.do("follow", user="closest")
    await until(lambda: it.robot.attended == "user-1")
    await it.robot.close()
    await it.is_lost()
    assert await it.driver.stop(Scope.ALL) is None
    await it.robot.start()
    await it.is_there()
    await it.arrived()
    assert it.robot.requests("request.attend.user") == it.robot.requests("request.attend.user")[:1]


async def test_a_robot_that_followed_on_while_it_was_away_looks_straight_on(it: Acted) -> None:
    await it.do("follow", user="user-9")  # whom it has not seen yet
    await it.robot.close()
    await it.is_lost()
    assert await it.driver.stop(Scope.ALL) is None
    await it.robot.start()
    await it.is_there()
    await until(lambda: it.robot.attended == "location")


async def test_a_light_that_was_stopped_while_the_robot_was_away_stays(
    it: Acted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(furhat_light, "_HALF_S", 0.01)
    await it.do("eyes", color="red", animation="intermittent")
    await it.robot.close()
    await it.is_lost()
    assert await it.driver.stop(Scope.ALL) is None
    await it.robot.start()
    await it.is_there()
    await it.arrived()
    sent = len(it.robot.requests("request.led.set"))
    for _ in range(10):
        await it.arrived()
    assert len(it.robot.requests("request.led.set")) == sent
    assert it.robot.led == "#ff0000"


async def test_a_stop_of_driving_alone_does_not_silence_it(it: Acted) -> None:
    it.begin("say", text=LONG)
    await until(lambda: bool(it.robot.speaking))
    assert await it.driver.stop(Scope.DRIVE) is None
    assert it.robot.speaking


async def test_a_session_hears_which_part_did_not_confirm(it: Acted) -> None:
    """As the wizard's red bar names it."""
    messages: list[AnyMessage] = []
    hub = Hub(it.context.clock, lambda message, line: None)
    hub.listen(messages.append)
    bus = Bus(hub, {"it": it.driver}, {"it": it.driver.verbs(it.driver.settings)})
    hub.publish(DriverConnected(driver="it"))
    it.robot.gestures_end_early = False
    orders: dict[str, dict[str, Json]] = {
        "say": {"text": LONG},
        "play": {"move": "Roll", "speed": 0.1},
    }
    for verb, args in orders.items():
        command = Command(command=verb, driver="it", verb=verb, args=args, source="key")
        bus.submit(command)
    await until(lambda: bool(it.robot.speaking and it.robot.gesturing))
    await bus.stop("key")
    (confirmed,) = [one for one in messages if isinstance(one, StopConfirmed)]
    assert confirmed.missing == ["it"]
    assert "gesture" not in confirmed.parts.get("it", [])
    await until(lambda: not it.robot.speaking)
    bus.release("key")
    await bus.drain(2)
