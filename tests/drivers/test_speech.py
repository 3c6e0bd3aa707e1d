"""The speech driver with programs that behave like espeak-ng and aplay, and the real espeak-ng."""

from __future__ import annotations

import asyncio
import os
import sys
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.pcm_audio import decode, rms
from woz_drivers.speech.driver import Speech
from woz_drivers.speech.settings import SpeechSettings
from woz_drivers.speech.synthesis import file_names, spoken_text
from woz_drivers.wav import parse

from tests.drivers.heard import Ordered, until
from tests.drivers.speech_desk import Desk, desk_in, said, say
from tests.fakes.disk import full_disk
from woz_tui.drivers.contract import DriverError, RejectedError, Written
from woz_tui.protocol.messages import Json, Notice, Reading


@pytest.fixture
async def desk(tmp_path: Path) -> AsyncIterator[Desk]:
    async with desk_in(tmp_path) as made:
        yield made


async def test_says_a_text_and_reports_it(desk: Desk) -> None:
    driver = await desk.open(voice="de")
    job = say("Hello there.")
    sent = await driver.perform(job)
    assert sent == {
        "text": "Hello there.",
        "seconds": 0.12,
        "source": "synthesised",
        "cached": False,
        "volume": 1.0,
        "delay": sent["delay"],
    }
    assert job.announced == [pytest.approx(0.12)]
    assert [line["do"] for line in desk.told()] == ["synthesise", "play", "played"]
    assert desk.told("synthesise")[0]["voice"] == "de"


async def test_what_was_said_once_comes_from_the_cache(desk: Desk) -> None:
    driver = await desk.open()
    await driver.perform(say("Hello"))
    again = await driver.perform(say("Hello"))
    assert (again["source"], again["cached"]) == ("cache", True)
    assert len(desk.told("synthesise")) == 1
    other = await desk.open(pitch=80)
    assert (await other.perform(say("Hello")))["cached"] is False


async def test_a_damaged_cache_file_is_made_anew(desk: Desk) -> None:
    driver = await desk.open()
    await driver.perform(say("Hello"))
    (cached,) = (desk.folder / "cache").glob("*.wav")
    cached.write_bytes(b"RIFF")
    assert (await driver.perform(say("Hello")))["cached"] is False
    assert (await driver.perform(say("Hello")))["cached"] is True


async def test_prepared_utterances_are_not_synthesised_again(desk: Desk) -> None:
    driver = await desk.open()
    await driver.prepare_say(said("One", "\0", "Two", "One"))
    assert [line["text"] for line in desk.told("synthesise")] == ["One\n", "Two\n"]
    assert desk.told("play") == []
    assert (await driver.perform(say("Two")))["cached"] is True


async def test_while_prepared_utterances_are_looked_up_others_have_their_turn(desk: Desk) -> None:
    for number in range(20):
        desk.wav(f"recordings/{number}.wav", 0.01)
    driver = await desk.open(recordings_folder="recordings")
    turns = 0

    async def others() -> None:
        nonlocal turns
        while True:
            await asyncio.sleep(0)
            turns += 1

    other = asyncio.create_task(others())
    await driver.prepare_say(said(*map(str, range(20))))
    other.cancel()
    assert turns > 20


async def test_one_utterance_may_have_another_voice(desk: Desk) -> None:
    words = ("--voice", "{voice} {language} {speed} {pitch}")
    driver = await desk.open(
        synthesise=desk.command("synthesise", "--wav", "{wav}", *words), voice="en-gb"
    )
    one: dict[str, Json] = {"text": "Hm", "language": "de", "speed": 90}
    other: dict[str, Json] = {"text": "Hm", "voice": "fr", "pitch": 70, "volume": 0.5}
    await driver.prepare_say([{"text": "Hm"}, one, other])
    assert [line["voice"] for line in desk.told("synthesise")] == [
        "en-gb  160 50",
        "de de 90 50",
        "fr  160 70",
    ]
    for args, volume in ((one, 1.0), (other, 0.5)):
        sent = await driver.perform(Ordered("say", args))
        assert (sent["cached"], sent["volume"]) == (True, volume)


@pytest.mark.parametrize(
    ("settings", "ignored"),
    [
        ({}, []),
        ({"synthesise": "pico2wave -l {language} -w {wav} {text}"}, ["voice", "speed", "pitch"]),
        ({"synthesise": "flite -voice {voice} -o {wav} -t {text}"}, ["speed", "pitch"]),
        ({"speak": "spd-say -r {speed} {text}"}, ["voice", "language", "pitch"]),
        ({"resident_voice": "python3 tones.py"}, []),
    ],
)
def test_voice_settings_that_a_command_does_not_take_are_remarked(
    settings: dict[str, Any], ignored: list[str], tmp_path: Path
) -> None:
    args: dict[str, Json] = {"text": "Hi", "voice": "a", "language": "de", "speed": 90, "pitch": 1}
    made = SpeechSettings(**settings)
    found = Speech.remarks(made, Written("say", args, tmp_path))
    assert [(one.level, one.subject) for one in found] == [("warning", name) for name in ignored]
    assert list(Speech.remarks(made, Written("say", {"text": "Hi"}, tmp_path))) == []


def test_a_voice_that_is_told_no_volume_offers_none(tmp_path: Path) -> None:
    told, untold = (SpeechSettings(speak=f"spd-say {more}") for more in ("-i {volume}", "-w"))
    offers = [{verb.name for verb in Speech.verbs(made)} for made in (told, untold)]
    assert offers == [{"say", "volume"}, {"say"}]
    assert SpeechSettings(speak=("mytts", "--volume={volume}")).takes_volume
    loud = Written("say", {"text": "Hi", "volume": 0.2}, tmp_path)
    assert [one.subject for one in Speech.remarks(untold, loud)] == ["volume"]
    assert not list(Speech.remarks(told, loud))


def test_a_voice_that_speaks_by_itself_plays_no_recordings() -> None:
    found = SpeechSettings(speak="spd-say", recordings={"Hello": "hello.wav"}).problems()
    assert [name for name, _ in found] == ["speak"]


async def test_how_many_utterances_are_ready_is_published(desk: Desk) -> None:
    driver = await desk.open()
    await driver.prepare_say(said("One", "Two", "Three"))
    told = [reading.text for reading in desk.heard.all(Reading) if reading.sensor == "prepared"]
    assert (told[0], told[-1]) == ("1 of 3", "3 of 3")


async def test_failed_preparation_is_one_notice(desk: Desk) -> None:
    driver = await desk.open(synthesise=("sh", "-c", "echo no voice >&2; exit 1"))
    await driver.prepare_say(said("One", "Two"))
    (notice,) = desk.heard.all(Notice)
    assert notice.text == "it: speech not prepared: sh failed: no voice"


async def test_closing_ends_the_preparation(desk: Desk) -> None:
    driver = await desk.open(
        synthesise=desk.command("synthesise", "--wav", "{wav}", "--delay", "1000")
    )
    preparing = asyncio.ensure_future(driver.prepare_say(said("One")))
    await until(lambda: len(desk.told("synthesise")) == 1)
    await driver.close()
    await preparing


@pytest.mark.parametrize(
    "options", [("--wav", "{wav}"), ("--wav", "{wav}", "--text", "{text}"), (), ("--text={text}",)]
)
async def test_text_arrives_whole_by_every_way(desk: Desk, options: tuple[str, ...]) -> None:
    driver = await desk.open(synthesise=desk.command("synthesise", *options))
    text = "--help 'a' \"b\" $HOME; `rm` <b>&amp;</b> {wav} % é"
    sent = await driver.perform(say(text))
    assert sent["text"] == text
    assert str(desk.told("synthesise")[0]["text"]).strip() == text
    assert desk.told("played")


async def test_texts_that_would_break_a_line_or_a_program(desk: Desk) -> None:
    driver = await desk.open()
    sent = await driver.perform(say("one\ntwo\r\n\x01\0three\u2028four\ud800 "))
    assert sent["text"] == "one two three four"
    assert desk.told("synthesise")[0]["text"] == "one two three four\n"
    for nothing in ("", " \n", "\0"):
        with pytest.raises(RejectedError, match="nothing to say"):
            await driver.perform(say(nothing))
    with pytest.raises(DriverError, match="cannot be started"):  # not on stdin: too long
        await (await desk.open(synthesise=desk.command("synthesise", "--text", "{text}"))).perform(
            say("x" * 200_000)
        )


@given(st.text(max_size=60))
def test_what_is_spoken_is_one_line_that_can_be_encoded(text: str) -> None:
    try:
        clean = spoken_text(text)
    except RejectedError:
        return
    assert clean.encode()
    assert clean.isprintable() or all(ord(c) >= 32 and ord(c) not in range(127, 160) for c in clean)
    assert clean.splitlines() == [clean]
    assert spoken_text(clean) == clean


async def test_sound_files(desk: Desk) -> None:
    desk.wav("sounds/beep.wav", 0.05)
    driver = await desk.open()
    sent = await driver.perform(Ordered("sound", {"file": "sounds/beep.wav"}))
    assert sent["file"] == "sounds/beep.wav"
    assert sent["seconds"] == 0.05
    assert desk.told("play")[0]["wav"] == str(desk.folder / "sounds/beep.wav")
    with pytest.raises(RejectedError, match="cannot be read"):
        await driver.perform(Ordered("sound", {"file": "nothing.wav"}))
    (desk.folder / "song.mp3").write_bytes(b"ID3" + bytes(100))
    with pytest.raises(RejectedError, match="no WAV file") as raised:
        await driver.perform(Ordered("sound", {"file": "song.mp3"}))
    assert raised.value.remedy.startswith("convert it: ffmpeg")


async def test_recordings_come_before_the_synthesiser(desk: Desk) -> None:
    desk.wav("hello.wav", 0.07)
    desk.wav("voice/Good bye!.wav", 0.08)
    desk.wav("voice/see-you-later.wav", 0.09)
    driver = await desk.open(recordings={"Hello  there": "hello.wav"}, recordings_folder="voice")
    for text, seconds in (("Hello there", 0.07), ("Good bye!", 0.08), ("See you: later?", 0.09)):
        sent = await driver.perform(say(text))
        assert (sent["source"], sent["seconds"]) == ("recording", seconds)
    assert (await driver.perform(say("../hello")))["source"] == "synthesised"
    assert len(desk.told("synthesise")) == 1


@given(st.text(max_size=300))
def test_no_text_names_a_file_elsewhere(text: str) -> None:
    for name in file_names(text):
        assert "/" not in name
        assert len(os.fsencode(name.encode("utf-8", "replace").decode())) <= 255


async def test_volume_softens_what_comes_next(desk: Desk) -> None:
    driver = await desk.open()
    assert await driver.perform(Ordered("volume", {"level": 0.5})) == {"level": 0.5}
    sent = await driver.perform(say("Hello"))
    assert sent["volume"] == 0.5
    assert desk.told("play")[0]["peak"] == pytest.approx(16384 * 0.5, abs=1)
    await driver.perform(Ordered("volume", {"level": 1}))
    await driver.perform(say("Hello"))
    assert desk.told("play")[1]["peak"] == 16384


async def test_without_room_for_the_softer_sound_it_says_so(desk: Desk) -> None:
    driver = await desk.open()
    await driver.perform(say("Hello"))
    await driver.perform(Ordered("volume", {"level": 0.5}))
    with full_disk(), pytest.raises(DriverError, match="no place for temporary files") as refused:
        await driver.perform(say("Hello"))
    assert "TMPDIR" in refused.value.remedy
    assert (await driver.perform(say("Hello")))["volume"] == 0.5


async def test_a_player_may_set_the_volume_itself(desk: Desk) -> None:
    play = (*desk.command("play", "--wav", "{wav}"), "--volume", "{volume}")
    driver = await desk.open(play=play, volume=0.25)
    await driver.perform(say("Hello"))
    assert desk.told("play")[0]["peak"] == 16384


async def test_a_program_that_speaks_by_itself(desk: Desk) -> None:
    speak = desk.command("speak", "--volume", "{volume}")
    driver = await desk.open(speak=speak, synthesise="", play="")
    assert [verb.name for verb in Speech.verbs(desk.settings(speak=speak, synthesise="", play=""))]
    job = say("-x Hello there")
    sent = await driver.perform(job)
    assert sent == {"text": "-x Hello there", "source": sys.executable, "volume": 1.0}
    assert desk.told("speak")[0]["text"] == "-x Hello there\n"
    assert desk.told("speak")[0]["volume"] == "100"
    assert len(job.announced) == 1
    await driver.prepare_say(said("never asked for"))
    assert len(desk.told()) == 1


# -- the real espeak-ng ------------------------------------------------------------------------


@pytest.mark.espeak
async def test_espeak_ng_speaks_whatever_is_typed(desk: Desk) -> None:
    driver = await desk.open(synthesise="")
    for text in ("Hi.", "-h", "<speak>x</speak> & {text}", "Grüß dich!"):
        sent = await driver.perform(say(text))
        assert sent["source"] == "synthesised"
        assert 0.1 < float(str(sent["seconds"])) < 10
    for file in (desk.folder / "cache").glob("*.wav"):
        made = parse(file.read_bytes())
        assert rms(decode(made.data, made.format, made.channels)) > 0.01
