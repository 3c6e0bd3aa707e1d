"""What it sees and hears: people as the engagement model takes them, speech with its texts."""

from __future__ import annotations

import asyncio
import errno
import json
import os
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
from naoqi_simulator.visitor import SimulatedPerson
from woz_drivers.furhat import furhat_hearing
from woz_drivers.furhat.settings import FurhatListeningSettings, FurhatSensesSettings

from tests.drivers.furhat.acted import SOMEBODY, Acted, acted, looks_often
from woz_tui.drivers.contract import DriverError, Health
from woz_tui.drivers.sound_feeds import LISTENED, SOUND, LiveSound, SoundListened
from woz_tui.protocol.camera_pictures import PICTURE, WATCHED, CameraWatched, Picture
from woz_tui.protocol.messages import SpeechEnded, SpeechStarted, SpeechText
from woz_tui.testing import until


@pytest.fixture
async def it(tmp_path: Path) -> AsyncIterator[Acted]:
    """Everything is read, and it listens."""
    listening = FurhatListeningSettings(phrases=("Furhat",))
    async with acted(tmp_path, senses=FurhatSensesSettings(), listening=listening) as it:
        await until(lambda: it.robot.listening)
        yield it


def users(*found: dict[str, Any]) -> str:
    return json.dumps({"type": "response.users.data", "users": list(found)})


async def reads(it: Acted, sensor: str, value: float | None) -> None:
    """Let the robot's time pass until this is read."""
    async with asyncio.timeout(10):
        while not it.context.of(sensor) or it.context.of(sensor)[-1].value != value:
            await it.passes(0.1)


async def test_somebody_is_there_near_to_the_left_and_looks(it: Acted) -> None:
    await reads(it, "presence", 0.0)
    it.robot.person = SOMEBODY
    await reads(it, "presence", 1.0)
    assert it.context.latest("people") == 1.0
    assert it.context.latest("distance") == pytest.approx(1.2)
    assert it.context.latest("direction") == pytest.approx(20.0, abs=0.2)
    assert it.context.latest("gaze") == 1.0
    it.robot.person = SimulatedPerson(1, 2.0, -0.35, looking=False, talking=True)
    await reads(it, "gaze", 0.0)
    assert it.context.latest("direction") < -15
    it.robot.person = None
    await reads(it, "presence", 0.0)
    assert it.context.of("distance")[-1].value is None


async def test_the_nearest_of_several_counts_and_other_forms_of_a_place_are_read(it: Acted) -> None:
    await it.robot.send_raw(
        users(
            {"id": 1, "location": {"x": 2.0, "y": 0.0, "z": 2.0}, "attending": False},
            {"id": "b", "x": -0.5, "z": 0.5, "attending": True},
        )
    )
    await until(lambda: bool(it.context.of("people")) and it.context.latest("people") == 2.0)
    assert it.context.latest("distance") == pytest.approx(0.707, abs=0.001)
    assert it.context.latest("direction") == pytest.approx(-45.0)
    assert it.context.latest("gaze") == 1.0


async def test_a_robot_that_does_not_say_who_looks_is_taken_as_it_is(it: Acted) -> None:
    await it.robot.send_raw(users({"id": "a", "x": 0.0, "y": 0.1, "z": 1.0}))
    await until(lambda: ("gaze", "stale") in [state[:2] for state in it.context.states])
    assert it.context.latest("presence") == 1.0
    assert {one.value for one in it.context.of("gaze")} <= {0.0}  # while nobody was there


async def test_a_robot_that_tells_of_people_on_a_change_alone_is_asked(
    it: Acted, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks_often(monkeypatch)
    it.robot.person = SOMEBODY  # no time of the robot passes, so it tells nothing by itself
    await until(lambda: bool(it.robot.requests("request.users.once")))
    await until(lambda: bool(it.context.of("presence")) and it.context.latest("presence") == 1.0)


async def test_loudness_is_that_of_the_microphone(it: Acted) -> None:
    await reads_loudness(it, 0.0, 0.01)
    it.robot.person = SimulatedPerson(1, 1.0, 0.0, looking=True, talking=True)
    await reads_loudness(it, 0.03, 0.2)


async def reads_loudness(it: Acted, low: float, high: float) -> None:
    async with asyncio.timeout(10):
        while not it.context.of("loudness") or not low <= it.context.latest("loudness") <= high:
            await it.passes(0.1)


@pytest.mark.parametrize("loudness", [True, False])
async def test_its_microphone_is_heard_live_while_somebody_listens(
    tmp_path: Path, loudness: bool
) -> None:
    senses = FurhatSensesSettings(users=False, loudness=loudness)
    async with acted(tmp_path, senses=senses) as it:
        feed, wish = it.context.feed(SOUND), it.context.feed(LISTENED)
        await it.passes(0.3)
        assert feed.latest().serial == 0, "nobody listens"
        assert bool(it.robot.requests("request.audio.start")) is loudness
        wish.put(SoundListened(it.context.clock.now_us() + 600_000_000))
        async with asyncio.timeout(10):
            while feed.latest().serial < 2:
                await it.passes(0.1)
        sound = feed.latest().value
        assert isinstance(sound, LiveSound)
        assert (sound.rate, len(sound.blocks[-1].pcm)) == (16_000, 3200)
        await it.robot.send_raw('{"type": "response.audio.data", "microphone": "no base64!"}')
        await it.robot.send_raw('{"type": "response.audio.data", "microphone": "AAAA"}')
        wish.put(SoundListened(0))
        await until(lambda: bool(it.robot.requests("request.audio.stop")) is not loudness)
        assert it.notices == ""


async def test_nothing_is_asked_for_that_nobody_wants(tmp_path: Path) -> None:
    async with acted(tmp_path) as it:
        kinds = {kind for kind, _ in it.robot.calls}
        assert not kinds & {"request.users.start", "request.audio.start", "request.listen.start"}


# -- speech ----------------------------------------------------------------------------------------


async def hears(it: Acted, text: str) -> None:
    hearing = asyncio.create_task(it.robot.hear(text))
    async with asyncio.timeout(20):
        while not hearing.done():
            await it.passes(0.1)


async def test_speech_is_told_from_its_begin_to_its_text_and_meanwhile_as_far_as_it_is_known(
    it: Acted,
) -> None:
    await hears(it, "my name is Kim")
    await until(lambda: len(it.context.told) == 3)
    began, ended, text = it.context.told
    assert isinstance(began, SpeechStarted) and began.segment == 1
    assert isinstance(ended, SpeechEnded) and ended.began == began.began <= ended.ended
    assert isinstance(text, SpeechText) and (text.segment, text.text) == (1, "my name is Kim")
    so_far = [reading.text for reading in it.context.of("speech")]
    assert so_far == ["my", "my name", "my name is", "my name is Kim", "my name is Kim"]
    await hears(it, "and yours")
    await until(lambda: len(it.context.told) == 6)
    assert it.context.told[-1].segment == 2
    assert it.robot.listening  # and goes on
    assert it.robot.requests("request.listen.config")[0] == {
        "languages": ["en-US"],
        "phrases": ["Furhat"],
    }


async def test_it_does_not_listen_to_itself_and_listens_again_afterwards(it: Acted) -> None:
    saying = it.begin("say", text="Good morning to everybody")
    await it.passes(0.3)
    await until(lambda: bool(it.robot.speaking))
    assert not it.robot.listening
    await it.ended(saying)
    await until(lambda: it.robot.listening)
    states = [state for sensor, state, _ in it.context.states if sensor == "speech"]
    assert states[-3:] == ["ready", "paused", "ready"]


async def test_a_robot_that_ends_listening_again_and_again_is_asked_ever_more_rarely(
    it: Acted, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks_often(monkeypatch)
    monkeypatch.setattr(furhat_hearing, "_AGAIN_S", 0.01)
    loop = asyncio.get_running_loop()

    async def ends() -> float:
        asked, begun = len(it.robot.requests("request.listen.start")), loop.time()
        await it.robot.send_raw('{"type": "response.listen.end", "cause": "no service"}')
        await until(lambda: len(it.robot.requests("request.listen.start")) > asked)
        return loop.time() - begun

    apart = [await ends() for _ in range(5)]
    assert apart[4] > 0.15
    assert it.notices.count("no service") == 1
    await hears(it, "Hello")  # whoever is heard has it begin anew
    for _ in range(4):
        await ends()
    assert it.notices.count("no service") == 2


async def test_a_night_of_ended_listening_loses_no_robot(it: Acted) -> None:
    for _ in range(1100):
        await it.robot.send_raw('{"type": "response.listen.end", "cause": "no service"}')
    await it.arrived()
    assert it.healthy is Health.CONNECTED


async def test_who_is_interrupted_by_the_robot_still_has_a_text(it: Acted) -> None:
    for event in ("hear.start", 'hear.partial", "text": "but I', "listen.end", "listen.start"):
        await it.robot.send_raw(f'{{"type": "response.{event}"}}')
    await it.robot.send_raw('{"type": "response.hear.end", "text": "but I think"}')
    await until(lambda: len(it.context.told) == 3)
    assert [type(one) for one in it.context.told] == [SpeechStarted, SpeechEnded, SpeechText]
    assert {one.segment for one in it.context.told} == {1}
    ended = it.context.told[1]
    assert isinstance(ended, SpeechEnded) and not ended.detail  # nothing went wrong


async def test_listening_ends_and_begins_by_command(it: Acted) -> None:
    await it.do("listen", on=False)
    await until(lambda: not it.robot.listening)
    await hears(it, "nobody hears this")
    assert not it.context.told
    await it.do("listen", on=True)
    await until(lambda: it.robot.listening)


async def test_a_robot_that_stops_listening_by_itself_is_asked_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks_often(monkeypatch)
    async with acted(tmp_path, listening=FurhatListeningSettings()) as it:
        await until(lambda: it.robot.listening)
        await it.robot.send_raw('{"type": "response.listen.end", "cause": "silence_timeout"}')
        await until(lambda: len(it.robot.requests("request.listen.start")) == 2)


async def test_an_utterance_that_the_robots_loss_cuts_off_has_an_end(it: Acted) -> None:
    await it.robot.send_raw('{"type": "response.hear.start"}')
    await until(lambda: len(it.context.told) == 1)
    it.robot.drop()
    await it.is_lost()
    ended = it.context.told[-1]
    assert isinstance(ended, SpeechEnded) and "not connected" in ended.detail
    await it.is_there()
    await until(lambda: it.robot.listening)


# -- pictures --------------------------------------------------------------------------------------


async def test_a_picture_is_kept_as_it_came(it: Acted, tmp_path: Path) -> None:
    kept = await it.do("picture")
    assert (tmp_path / str(kept["file"])).read_bytes().startswith(b"\xff\xd8")
    assert len(pictures(tmp_path)) == 1


def pictures(folder: Path) -> list[Path]:
    return list(folder.rglob("*picture-*"))


async def test_a_full_disk_is_told_and_leaves_no_part_of_a_picture(
    it: Acted, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(DriverError, match="could not be kept") as told:
        await it.do("picture")
    assert "free some space" in told.value.remedy
    assert not pictures(tmp_path)


async def test_pictures_are_shown_while_somebody_watches(it: Acted) -> None:
    assert not it.robot.requests("request.camera.once")
    until_us = it.context.clock.now_us() + 60_000_000
    it.context.feed(WATCHED).put(CameraWatched(until_us, 320, 10.0))
    await until(lambda: isinstance(it.context.feed(PICTURE).latest().value, Picture))
    picture = it.context.feed(PICTURE).latest().value
    assert isinstance(picture, Picture)
    assert (picture.width, picture.height) == (160, 120)
    assert len(picture.rgb) == 3 * 160 * 120
    it.context.feed(WATCHED).put(CameraWatched(0, 320, 10.0))
