"""What it sees and hears: people as the engagement model takes them, speech with its texts."""

from __future__ import annotations

import asyncio
import errno
import json
import math
import os
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
from naoqi_simulator.visitor import SimulatedPerson
from woz_drivers.furhat import hearing
from woz_drivers.furhat.settings import FurhatListeningSettings, FurhatSensesSettings

from tests.drivers.furhat.furhat_rig import SOMEBODY, FurhatRig, connected_furhat, looks_often
from woz_tui.drivers.contract import DriverError, Health
from woz_tui.drivers.sound_feeds import LISTENED, SOUND, LiveSound, SoundListened
from woz_tui.protocol.camera_pictures import PICTURE, WATCHED, CameraWatched, Picture
from woz_tui.protocol.messages import SpeechEnded, SpeechStarted, SpeechText
from woz_tui.testing import until


@pytest.fixture
async def rig(tmp_path: Path) -> AsyncIterator[FurhatRig]:
    """Everything is read, and it listens."""
    listening = FurhatListeningSettings(phrases=("Furhat",))
    async with connected_furhat(
        tmp_path, senses=FurhatSensesSettings(), listening=listening
    ) as furhat_rig:
        await until(lambda: furhat_rig.robot.listening)
        yield furhat_rig


def users(*found: dict[str, Any]) -> str:
    return json.dumps({"type": "response.users.data", "users": list(found)})


async def reads(furhat_rig: FurhatRig, sensor: str, value: float | None) -> None:
    """Let the robot's time pass until this is read."""
    async with asyncio.timeout(10):
        while not furhat_rig.context.of(sensor) or furhat_rig.context.of(sensor)[-1].value != value:
            await furhat_rig.passes(0.1)


async def test_somebody_is_there_near_to_the_left_and_looks(rig: FurhatRig) -> None:
    await reads(rig, "presence", 0.0)
    rig.robot.person = SOMEBODY
    await reads(rig, "presence", 1.0)
    assert rig.context.latest("people") == 1.0
    assert rig.context.latest("distance") == pytest.approx(1.2)
    assert rig.context.latest("direction") == pytest.approx(20.0, abs=0.2)
    assert rig.context.latest("gaze") == 1.0
    rig.robot.person = SimulatedPerson(1, 2.0, -0.35, looking=False, talking=True)
    await reads(rig, "gaze", 0.0)
    assert rig.context.latest("direction") < -15
    rig.robot.person = None
    await reads(rig, "presence", 0.0)
    assert rig.context.of("distance")[-1].value is None


async def test_the_nearest_of_several_counts_and_other_forms_of_a_place_are_read(
    rig: FurhatRig,
) -> None:
    await rig.robot.send_raw(
        users(
            {"id": 1, "location": {"x": 2.0, "y": 0.0, "z": 2.0}, "attending": False},
            {"id": "b", "x": -0.5, "z": 0.5, "attending": True},
        )
    )
    await until(lambda: bool(rig.context.of("people")) and rig.context.latest("people") == 2.0)
    assert rig.context.latest("distance") == pytest.approx(0.707, abs=0.001)
    assert rig.context.latest("direction") == pytest.approx(-45.0)
    assert rig.context.latest("gaze") == 1.0


async def test_a_user_whose_place_is_no_number_is_somebody(rig: FurhatRig) -> None:
    rig.robot.person = None
    await reads(rig, "presence", 0.0)
    lost = {"id": 1, "location": {"x": math.nan, "y": 0.0, "z": math.inf}, "attending": math.nan}
    await rig.robot.send_raw(users(lost, {"id": 2, "x": 0.0, "z": 1.0, "distance": -math.inf}))
    await until(lambda: bool(rig.context.of("people")) and rig.context.latest("people") == 2.0)
    assert rig.context.latest("presence") == 1.0
    assert rig.context.latest("distance") == 1.0
    assert not rig.context.notices


async def test_a_robot_that_does_not_say_who_looks_is_taken_as_it_is(rig: FurhatRig) -> None:
    await rig.robot.send_raw(users({"id": "a", "x": 0.0, "y": 0.1, "z": 1.0}))
    await until(lambda: ("gaze", "stale") in [state[:2] for state in rig.context.states])
    assert rig.context.latest("presence") == 1.0
    assert {one.value for one in rig.context.of("gaze")} <= {0.0}  # while nobody was there


async def test_a_robot_that_tells_of_people_on_a_change_alone_is_asked(
    rig: FurhatRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks_often(monkeypatch)
    rig.robot.person = SOMEBODY  # no time of the robot passes, so it tells nothing by itself
    await until(lambda: bool(rig.robot.requests("request.users.once")))
    await until(lambda: bool(rig.context.of("presence")) and rig.context.latest("presence") == 1.0)


async def test_loudness_is_that_of_the_microphone(rig: FurhatRig) -> None:
    await reads_loudness(rig, 0.0, 0.01)
    rig.robot.person = SimulatedPerson(1, 1.0, 0.0, looking=True, talking=True)
    await reads_loudness(rig, 0.03, 0.2)


async def reads_loudness(furhat_rig: FurhatRig, low: float, high: float) -> None:
    async with asyncio.timeout(10):
        while (
            not furhat_rig.context.of("loudness")
            or not low <= furhat_rig.context.latest("loudness") <= high
        ):
            await furhat_rig.passes(0.1)


@pytest.mark.parametrize("loudness", [True, False])
async def test_its_microphone_is_heard_live_while_somebody_listens(
    tmp_path: Path, loudness: bool
) -> None:
    senses = FurhatSensesSettings(users=False, loudness=loudness)
    async with connected_furhat(tmp_path, senses=senses) as furhat_rig:
        feed, wish = furhat_rig.context.feed(SOUND), furhat_rig.context.feed(LISTENED)
        await furhat_rig.passes(0.3)
        assert feed.latest().serial == 0, "nobody listens"
        assert bool(furhat_rig.robot.requests("request.audio.start")) is loudness
        wish.put(SoundListened(furhat_rig.context.clock.now_us() + 600_000_000))
        async with asyncio.timeout(10):
            while feed.latest().serial < 2:
                await furhat_rig.passes(0.1)
        sound = feed.latest().value
        assert isinstance(sound, LiveSound)
        assert (sound.rate, len(sound.blocks[-1].pcm)) == (16_000, 3200)
        await furhat_rig.robot.send_raw(
            '{"type": "response.audio.data", "microphone": "no base64!"}'
        )
        await furhat_rig.robot.send_raw('{"type": "response.audio.data", "microphone": "AAAA"}')
        wish.put(SoundListened(0))
        await until(lambda: bool(furhat_rig.robot.requests("request.audio.stop")) is not loudness)
        assert furhat_rig.notices == ""


async def test_nothing_is_asked_for_that_nobody_wants(tmp_path: Path) -> None:
    async with connected_furhat(tmp_path) as furhat_rig:
        kinds = {kind for kind, _ in furhat_rig.robot.calls}
        assert not kinds & {"request.users.start", "request.audio.start", "request.listen.start"}


# -- speech ----------------------------------------------------------------------------------------


async def hears(furhat_rig: FurhatRig, text: str) -> None:
    speaking = asyncio.create_task(furhat_rig.robot.hear(text))
    async with asyncio.timeout(20):
        while not speaking.done():
            await furhat_rig.passes(0.1)


async def test_speech_is_told_from_its_begin_to_its_text_and_meanwhile_as_far_as_it_is_known(
    rig: FurhatRig,
) -> None:
    await hears(rig, "my name is Kim")
    await until(lambda: len(rig.context.told) == 3)
    began, ended, text = rig.context.told
    assert isinstance(began, SpeechStarted) and began.segment == 1
    assert isinstance(ended, SpeechEnded) and ended.began == began.began <= ended.ended
    assert isinstance(text, SpeechText) and (text.segment, text.text) == (1, "my name is Kim")
    so_far = [reading.text for reading in rig.context.of("speech")]
    assert so_far == ["my", "my name", "my name is", "my name is Kim", "my name is Kim"]
    await hears(rig, "and yours")
    await until(lambda: len(rig.context.told) == 6)
    assert rig.context.told[-1].segment == 2
    assert rig.robot.listening  # and goes on
    assert rig.robot.requests("request.listen.config")[0] == {
        "languages": ["en-US"],
        "phrases": ["Furhat"],
    }


async def test_it_does_not_listen_to_itself_and_listens_again_afterwards(rig: FurhatRig) -> None:
    saying = rig.begin("say", text="Good morning to everybody")
    await rig.passes(0.3)
    await until(lambda: bool(rig.robot.speaking))
    assert not rig.robot.listening
    await rig.ended(saying)
    await until(lambda: rig.robot.listening)
    states = [state for sensor, state, _ in rig.context.states if sensor == "speech"]
    assert states[-3:] == ["ready", "paused", "ready"]


async def test_a_robot_that_ends_listening_again_and_again_is_asked_ever_more_rarely(
    rig: FurhatRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks_often(monkeypatch)
    monkeypatch.setattr(hearing, "_AGAIN_S", 0.01)
    loop = asyncio.get_running_loop()

    async def ends() -> float:
        asked, begun = len(rig.robot.requests("request.listen.start")), loop.time()
        await rig.robot.send_raw('{"type": "response.listen.end", "cause": "no service"}')
        await until(lambda: len(rig.robot.requests("request.listen.start")) > asked)
        return loop.time() - begun

    apart = [await ends() for _ in range(5)]
    assert apart[4] > 0.15
    assert rig.notices.count("no service") == 1
    await hears(rig, "Hello")  # whoever is heard has it begin anew
    for _ in range(4):
        await ends()
    assert rig.notices.count("no service") == 2


async def test_a_night_of_ended_listening_loses_no_robot(rig: FurhatRig) -> None:
    for _ in range(1100):
        await rig.robot.send_raw('{"type": "response.listen.end", "cause": "no service"}')
    await rig.arrived()
    assert rig.healthy is Health.CONNECTED


async def test_who_is_interrupted_by_the_robot_still_has_a_text(rig: FurhatRig) -> None:
    for event in ("hear.start", 'hear.partial", "text": "but I', "listen.end", "listen.start"):
        await rig.robot.send_raw(f'{{"type": "response.{event}"}}')
    await rig.robot.send_raw('{"type": "response.hear.end", "text": "but I think"}')
    await until(lambda: len(rig.context.told) == 3)
    assert [type(one) for one in rig.context.told] == [SpeechStarted, SpeechEnded, SpeechText]
    assert {one.segment for one in rig.context.told} == {1}
    ended = rig.context.told[1]
    assert isinstance(ended, SpeechEnded) and not ended.detail  # nothing went wrong


async def test_listening_ends_and_begins_by_command(rig: FurhatRig) -> None:
    await rig.do("listen", on=False)
    await until(lambda: not rig.robot.listening)
    await hears(rig, "nobody hears this")
    assert not rig.context.told
    await rig.do("listen", on=True)
    await until(lambda: rig.robot.listening)


async def test_a_robot_that_stops_listening_by_itself_is_asked_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks_often(monkeypatch)
    async with connected_furhat(tmp_path, listening=FurhatListeningSettings()) as furhat_rig:
        await until(lambda: furhat_rig.robot.listening)
        await furhat_rig.robot.send_raw(
            '{"type": "response.listen.end", "cause": "silence_timeout"}'
        )
        await until(lambda: len(furhat_rig.robot.requests("request.listen.start")) == 2)


async def test_an_utterance_that_the_robots_loss_cuts_off_has_an_end(rig: FurhatRig) -> None:
    await rig.robot.send_raw('{"type": "response.hear.start"}')
    await until(lambda: len(rig.context.told) == 1)
    rig.robot.drop()
    await rig.is_lost()
    ended = rig.context.told[-1]
    assert isinstance(ended, SpeechEnded) and "not connected" in ended.detail
    await rig.is_there()
    await until(lambda: rig.robot.listening)


# -- pictures --------------------------------------------------------------------------------------


async def test_a_picture_is_kept_as_it_came(rig: FurhatRig, tmp_path: Path) -> None:
    kept = await rig.do("picture")
    assert (tmp_path / str(kept["file"])).read_bytes().startswith(b"\xff\xd8")
    assert len(pictures(tmp_path)) == 1


def pictures(folder: Path) -> list[Path]:
    return list(folder.rglob("*picture-*"))


async def test_a_full_disk_is_told_and_leaves_no_part_of_a_picture(
    rig: FurhatRig, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(DriverError, match="could not be kept") as raised:
        await rig.do("picture")
    assert "free some space" in raised.value.remedy
    assert not pictures(tmp_path)


async def test_pictures_are_shown_while_somebody_watches(rig: FurhatRig) -> None:
    assert not rig.robot.requests("request.camera.once")
    until_us = rig.context.clock.now_us() + 60_000_000
    rig.context.feed(WATCHED).put(CameraWatched(until_us, 320, 10.0))
    await until(lambda: isinstance(rig.context.feed(PICTURE).latest().value, Picture))
    picture = rig.context.feed(PICTURE).latest().value
    assert isinstance(picture, Picture)
    assert (picture.width, picture.height) == (160, 120)
    assert len(picture.rgb) == 3 * 160 * 120
    rig.context.feed(WATCHED).put(CameraWatched(0, 320, 10.0))
