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
from woz_drivers.sound.emotion_sound import cues
from woz_drivers.sound.pcm_audio import decode, rms
from woz_drivers.sound.wav import parse
from woz_drivers.speech.driver import Speech
from woz_drivers.speech.gibberish import gibberish, phonemes
from woz_drivers.speech.settings import SpeechSettings
from woz_drivers.speech.synthesis import file_names, spoken_text

from tests.drivers.published_messages import BusJob, until
from tests.drivers.speech_rig import SpeechRig, desk_in, say, say_arguments
from tests.fakes.full_disk import full_disk
from woz_tui.drivers.contract import DriverError, RejectedError, Scope, Written
from woz_tui.motion.body_feeds import VOICE
from woz_tui.protocol.messages import Json, Notice, Reading


@pytest.fixture
async def rig(tmp_path: Path) -> AsyncIterator[SpeechRig]:
    async with desk_in(tmp_path) as speech_rig:
        yield speech_rig


async def test_says_a_text_and_reports_it(rig: SpeechRig) -> None:
    driver = await rig.open(voice="de")
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
    assert [line["do"] for line in rig.journal_entries()] == ["synthesise", "play", "played"]
    assert rig.journal_entries("synthesise")[0]["voice"] == "de"


async def test_what_was_said_once_comes_from_the_cache(rig: SpeechRig) -> None:
    driver = await rig.open()
    await driver.perform(say("Hello"))
    again = await driver.perform(say("Hello"))
    assert (again["source"], again["cached"]) == ("cache", True)
    assert len(rig.journal_entries("synthesise")) == 1
    other = await rig.open(pitch=80)
    assert (await other.perform(say("Hello")))["cached"] is False


async def test_a_pause_is_silence_between_what_is_said(rig: SpeechRig) -> None:
    driver = await rig.open()
    sent = await driver.perform(say("Hello \\pau=500\\ there \\pau=250\\"))
    assert (sent["text"], sent["source"]) == ("Hello there", "synthesised")
    assert [line["text"] for line in rig.journal_entries("synthesise")] == ["Hello\n", "there\n"]
    words = [await driver.perform(say(text)) for text in ("Hello", "there")]
    assert [each["source"] for each in words] == ["cache", "cache"]
    assert sent["seconds"] == pytest.approx(
        0.75 + sum(float(str(each["seconds"])) for each in words), abs=0.002
    )


async def test_nothing_is_said_where_there_are_only_pauses(rig: SpeechRig) -> None:
    driver = await rig.open()
    with pytest.raises(RejectedError, match="nothing to say"):
        await driver.perform(say("\\pau=500\\"))


async def test_pauses_longer_than_speech_may_be_are_refused(rig: SpeechRig) -> None:
    driver = await rig.open()
    with pytest.raises(RejectedError, match="its pauses alone take 180 s"):
        await driver.perform(say("Hello " + "\\pau=60000\\ there " * 3))
    assert rig.journal_entries("synthesise") == []


async def test_a_damaged_cache_file_is_made_anew(rig: SpeechRig) -> None:
    driver = await rig.open()
    await driver.perform(say("Hello"))
    (cached,) = (rig.folder / "cache").glob("*.wav")
    cached.write_bytes(b"RIFF")
    assert (await driver.perform(say("Hello")))["cached"] is False
    assert (await driver.perform(say("Hello")))["cached"] is True


async def test_prepared_utterances_are_not_synthesised_again(rig: SpeechRig) -> None:
    driver = await rig.open()
    await driver.prepare_say(say_arguments("One", "\0", "Two", "One"))
    assert [line["text"] for line in rig.journal_entries("synthesise")] == ["One\n", "Two\n"]
    assert rig.journal_entries("play") == []
    assert (await driver.perform(say("Two")))["cached"] is True


async def test_while_prepared_utterances_are_looked_up_others_have_their_turn(
    rig: SpeechRig,
) -> None:
    for number in range(20):
        rig.wav(f"recordings/{number}.wav", 0.01)
    driver = await rig.open(recordings_folder="recordings")
    turns = 0

    async def others() -> None:
        nonlocal turns
        while True:
            await asyncio.sleep(0)
            turns += 1

    other = asyncio.create_task(others())
    await driver.prepare_say(say_arguments(*map(str, range(20))))
    other.cancel()
    assert turns > 20


async def test_one_utterance_may_have_another_voice(rig: SpeechRig) -> None:
    words = ("--voice", "{voice} {language} {speed} {pitch}")
    driver = await rig.open(
        synthesise=rig.command("synthesise", "--wav", "{wav}", *words), voice="en-gb"
    )
    one: dict[str, Json] = {"text": "Hm", "language": "de", "speed": 90}
    other: dict[str, Json] = {"text": "Hm", "voice": "fr", "pitch": 70, "volume": 0.5}
    await driver.prepare_say([{"text": "Hm"}, one, other])
    assert [line["voice"] for line in rig.journal_entries("synthesise")] == [
        "en-gb  160 50",
        "de de 90 50",
        "fr  160 70",
    ]
    for args, volume in ((one, 1.0), (other, 0.5)):
        sent = await driver.perform(BusJob("say", args))
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
    speech_settings = SpeechSettings(**settings)
    found = Speech.remarks(speech_settings, Written("say", args, tmp_path))
    assert [(one.level, one.subject) for one in found] == [("warning", name) for name in ignored]
    assert list(Speech.remarks(speech_settings, Written("say", {"text": "Hi"}, tmp_path))) == []


def test_a_voice_that_is_told_no_volume_offers_none(tmp_path: Path) -> None:
    speech_settings, untold = (
        SpeechSettings(speak=f"spd-say {more}") for more in ("-i {volume}", "-w")
    )
    offers = [
        {verb.name for verb in Speech.offer(speech_settings).verbs}
        for speech_settings in (speech_settings, untold)
    ]
    assert offers == [{"say", "volume"}, {"say"}]
    assert SpeechSettings(speak=("mytts", "--volume={volume}")).takes_volume
    loud = Written("say", {"text": "Hi", "volume": 0.2}, tmp_path)
    assert [one.subject for one in Speech.remarks(untold, loud)] == ["volume"]
    assert not list(Speech.remarks(speech_settings, loud))


def test_a_voice_that_speaks_by_itself_plays_no_recordings() -> None:
    found = SpeechSettings(speak="spd-say", recordings={"Hello": "hello.wav"}).problems()
    assert [name for name, _ in found] == ["speak"]


async def test_how_many_utterances_are_ready_is_published(rig: SpeechRig) -> None:
    driver = await rig.open()
    await driver.prepare_say(say_arguments("One", "Two", "Three"))
    told = [reading.text for reading in rig.published.all(Reading) if reading.sensor == "prepared"]
    assert (told[0], told[-1]) == ("1 of 3", "3 of 3")


async def test_failed_preparation_is_one_notice(rig: SpeechRig) -> None:
    driver = await rig.open(synthesise=("sh", "-c", "echo no voice >&2; exit 1"))
    await driver.prepare_say(say_arguments("One", "Two"))
    (notice,) = rig.published.all(Notice)
    assert notice.text == "it: speech not prepared: sh failed: no voice"


async def test_closing_ends_the_preparation(rig: SpeechRig) -> None:
    driver = await rig.open(
        synthesise=rig.command("synthesise", "--wav", "{wav}", "--delay", "1000")
    )
    preparing = asyncio.ensure_future(driver.prepare_say(say_arguments("One")))
    await until(lambda: len(rig.journal_entries("synthesise")) == 1)
    await driver.close()
    await preparing


@pytest.mark.parametrize(
    "options", [("--wav", "{wav}"), ("--wav", "{wav}", "--text", "{text}"), (), ("--text={text}",)]
)
async def test_text_arrives_whole_by_every_way(rig: SpeechRig, options: tuple[str, ...]) -> None:
    driver = await rig.open(synthesise=rig.command("synthesise", *options))
    text = "--help 'a' \"b\" $HOME; `rm` <b>&amp;</b> {wav} % é"
    sent = await driver.perform(say(text))
    assert sent["text"] == text
    assert str(rig.journal_entries("synthesise")[0]["text"]).strip() == text
    assert rig.journal_entries("played")


async def test_texts_that_would_break_a_line_or_a_program(rig: SpeechRig) -> None:
    driver = await rig.open()
    sent = await driver.perform(say("one\ntwo\r\n\x01\0three\u2028four\ud800 "))
    assert sent["text"] == "one two three four"
    assert rig.journal_entries("synthesise")[0]["text"] == "one two three four\n"
    for nothing in ("", " \n", "\0"):
        with pytest.raises(RejectedError, match="nothing to say"):
            await driver.perform(say(nothing))
    with pytest.raises(DriverError, match="cannot be started"):  # not on stdin: too long
        await (await rig.open(synthesise=rig.command("synthesise", "--text", "{text}"))).perform(
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


async def test_sound_files(rig: SpeechRig) -> None:
    rig.wav("sounds/beep.wav", 0.05)
    driver = await rig.open()
    sent = await driver.perform(BusJob("sound", {"file": "sounds/beep.wav"}))
    assert sent["file"] == "sounds/beep.wav"
    assert sent["seconds"] == 0.05
    assert rig.journal_entries("play")[0]["wav"] == str(rig.folder / "sounds/beep.wav")
    with pytest.raises(RejectedError, match="cannot be read"):
        await driver.perform(BusJob("sound", {"file": "nothing.wav"}))
    (rig.folder / "song.mp3").write_bytes(b"ID3" + bytes(100))
    with pytest.raises(RejectedError, match="no WAV file") as raised:
        await driver.perform(BusJob("sound", {"file": "song.mp3"}))
    assert raised.value.remedy.startswith("convert it: ffmpeg")


def utter(**args: Json) -> BusJob:
    return BusJob("utter", {"seconds": 0.5, "intensity": 1.0, "voice": "notes", "seed": 3, **args})


@pytest.mark.toolkit("X5")
async def test_a_mood_is_heard_at_the_volume_and_told(rig: SpeechRig) -> None:
    driver = await rig.open()
    job = utter(valence=0.9, arousal=0.4)
    assert await driver.perform(job) == {
        **{"voice": "notes", "valence": 0.9, "arousal": 0.4, "seed": 3},
        **{"seconds": 0.5, "volume": 1.0},
    }
    assert job.announced == [0.5]
    await driver.perform(BusJob("volume", {"level": 0.5}))
    await driver.perform(utter(valence=0.9, arousal=0.4))
    await driver.perform(BusJob("volume", {"level": 0.0}))
    await driver.perform(utter(valence=0.9, arousal=0.4))
    loud, soft, mute = (float(str(line["peak"])) for line in rig.journal_entries("play"))
    assert soft == pytest.approx(loud / 2, abs=2)
    assert mute == 0


async def test_a_stop_ends_a_sound_and_shuts_the_mouth(rig: SpeechRig) -> None:
    driver = await rig.open()
    mouth = rig.published.context.feed(VOICE)
    sounding = asyncio.create_task(driver.perform(utter(emotion="happy", seconds=10.0)))
    await until(lambda: bool(rig.journal_entries("play")))
    await until(lambda: mouth.latest().value is not None and mouth.latest().value.levels)
    await driver.stop(Scope.ALL)
    assert sounding.cancelled()
    assert rig.journal_entries("played") == []
    assert mouth.latest().value.levels == ()


async def test_what_is_said_moves_the_mouth_too(rig: SpeechRig) -> None:
    rig.wav("long.wav", 3.0)
    driver = await rig.open(recordings={"A long tale": "long.wav"})
    mouth = rig.published.context.feed(VOICE)
    telling = asyncio.create_task(driver.perform(say("A long tale")))
    await until(lambda: mouth.latest().value is not None and mouth.latest().value.levels)
    assert len(mouth.latest().value.levels) == 75
    await driver.stop(Scope.ALL)
    assert telling.cancelled()


async def test_gibberish_without_espeak_ng_is_refused_by_name(
    rig: SpeechRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    driver = await rig.open()
    monkeypatch.setenv("PATH", str(rig.folder))
    with pytest.raises(RejectedError, match="gibberish needs espeak-ng") as raised:
        await driver.perform(utter(emotion="happy", voice="gibberish"))
    assert "apt install espeak-ng" in raised.value.remedy


@pytest.mark.espeak
async def test_gibberish_is_the_same_by_its_seed_and_quicker_when_excited(rig: SpeechRig) -> None:
    spoken = [
        await gibberish(cues(0.0, arousal), 3.0, seed, folder=rig.folder)
        for arousal, seed in ((0.5, 1), (0.5, 1), (0.5, 2), (-0.5, 1))
    ]
    assert spoken[0] == spoken[1] != spoken[2]
    assert 1.5 < spoken[0].seconds < 4.5
    slow, quick = (phonemes(cues(0.0, arousal), 3.0, 1) for arousal in (-0.5, 0.5))
    vowels = [sum(map(text.count, "aeiou")) for text in (slow, quick)]
    assert vowels[0] / spoken[3].seconds < vowels[1] / spoken[0].seconds


async def test_recordings_come_before_the_synthesiser(rig: SpeechRig) -> None:
    rig.wav("hello.wav", 0.07)
    rig.wav("voice/Good bye!.wav", 0.08)
    rig.wav("voice/see-you-later.wav", 0.09)
    driver = await rig.open(recordings={"Hello  there": "hello.wav"}, recordings_folder="voice")
    for text, seconds in (("Hello there", 0.07), ("Good bye!", 0.08), ("See you: later?", 0.09)):
        sent = await driver.perform(say(text))
        assert (sent["source"], sent["seconds"]) == ("recording", seconds)
    assert (await driver.perform(say("../hello")))["source"] == "synthesised"
    assert len(rig.journal_entries("synthesise")) == 1


@given(st.text(max_size=300))
def test_no_text_names_a_file_elsewhere(text: str) -> None:
    for name in file_names(text):
        assert "/" not in name
        assert len(os.fsencode(name.encode("utf-8", "replace").decode())) <= 255


async def test_volume_softens_what_comes_next(rig: SpeechRig) -> None:
    driver = await rig.open()
    assert await driver.perform(BusJob("volume", {"level": 0.5})) == {"level": 0.5}
    sent = await driver.perform(say("Hello"))
    assert sent["volume"] == 0.5
    assert rig.journal_entries("play")[0]["peak"] == pytest.approx(16384 * 0.5, abs=1)
    await driver.perform(BusJob("volume", {"level": 1}))
    await driver.perform(say("Hello"))
    assert rig.journal_entries("play")[1]["peak"] == 16384


async def test_without_room_for_the_softer_sound_it_says_so(rig: SpeechRig) -> None:
    driver = await rig.open()
    await driver.perform(say("Hello"))
    await driver.perform(BusJob("volume", {"level": 0.5}))
    with full_disk(), pytest.raises(DriverError, match="no place for temporary files") as raised:
        await driver.perform(say("Hello"))
    assert "TMPDIR" in raised.value.remedy
    assert (await driver.perform(say("Hello")))["volume"] == 0.5


async def test_a_player_may_set_the_volume_itself(rig: SpeechRig) -> None:
    play = (*rig.command("play", "--wav", "{wav}"), "--volume", "{volume}")
    driver = await rig.open(play=play, volume=0.25)
    await driver.perform(say("Hello"))
    assert rig.journal_entries("play")[0]["peak"] == 16384


async def test_a_program_that_speaks_by_itself(rig: SpeechRig) -> None:
    speak = rig.command("speak", "--volume", "{volume}")
    driver = await rig.open(speak=speak, synthesise="", play="")
    assert [
        verb.name for verb in Speech.offer(rig.settings(speak=speak, synthesise="", play="")).verbs
    ]
    job = say("-x Hello there")
    sent = await driver.perform(job)
    assert sent == {"text": "-x Hello there", "source": sys.executable, "volume": 1.0}
    assert rig.journal_entries("speak")[0]["text"] == "-x Hello there\n"
    assert rig.journal_entries("speak")[0]["volume"] == "100"
    assert len(job.announced) == 1
    await driver.prepare_say(say_arguments("never asked for"))
    assert len(rig.journal_entries()) == 1


# -- the real espeak-ng ------------------------------------------------------------------------


@pytest.mark.espeak
async def test_espeak_ng_speaks_whatever_is_typed(rig: SpeechRig) -> None:
    driver = await rig.open(synthesise="")
    for text in ("Hi.", "-h", "<speak>x</speak> & {text}", "Grüß dich!"):
        sent = await driver.perform(say(text))
        assert sent["source"] == "synthesised"
        assert 0.1 < float(str(sent["seconds"])) < 10
    for file in (rig.folder / "cache").glob("*.wav"):
        wav = parse(file.read_bytes())
        assert rms(decode(wav.data, wav.format, wav.channels)) > 0.01
