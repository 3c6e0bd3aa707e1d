"""A real Piper speaks and a real Whisper understands it, both loaded once.

The word errors that this prints are figures of these sentences and models, not of people's speech.
"""

from __future__ import annotations

import re
import sys
from collections.abc import AsyncIterator, Sequence
from pathlib import Path

import numpy as np
import pytest
import pytest_asyncio
from woz_drivers.microphone import whisper_transcriber
from woz_drivers.microphone.transcriber import TRANSCRIBER, Transcript
from woz_drivers.programs.resident_program import ResidentProgram
from woz_drivers.sound import pcm_audio
from woz_drivers.sound.wav import Wav
from woz_drivers.speech import piper_voice
from woz_drivers.speech.settings import SynthesisSettings, VoiceChoice
from woz_drivers.speech.synthesis import SpeechSynthesis

from tests.drivers.microphones import microphone_opener
from tests.peers.places import place
from woz_tui.drivers.contract import SPEECH, DriverError
from woz_tui.protocol.messages import Reading, SpeechEnded, SpeechText
from woz_tui.system.clock import RealClock

SENTENCES = (
    "Good morning, and welcome to the museum.",
    "What would you like to see today?",
    "The blue whale is the largest animal that has ever lived.",
    "Please come a little closer to the robot.",
    "I think that the second picture is better than the first one.",
    "Could you tell me what time the exhibition closes?",
)
#: Of the words at most; a wrong rate, a wrong language or cut sound cost far more.
MOST_WRONG = 0.3
LIMIT_S = 60.0


def whisper() -> tuple[str, ...]:
    there = place("whisper")
    words = (str(there / "bin" / "python"), whisper_transcriber.__file__)
    return (*words, "--model", str(there / "model"))


def piper_settings(cache: Path) -> SynthesisSettings:
    there = place("piper")
    return SynthesisSettings(
        resident_voice=(
            *("{python}", "-m", piper_voice.__name__, "--piper", str(there / "bin" / "piper")),
            *("--voices", str(there / "voices"), "--model", "en_US-joe-medium"),
        ),
        cache=str(cache),
    )


@pytest_asyncio.fixture
async def piper(tmp_path: Path) -> AsyncIterator[SpeechSynthesis]:
    voice = SpeechSynthesis(piper_settings(tmp_path / "cache"), tmp_path)
    yield voice
    await voice.close()


@pytest_asyncio.fixture
async def transcriber(tmp_path: Path) -> AsyncIterator[ResidentProgram]:
    program = ResidentProgram(whisper(), tmp_path)
    yield program
    await program.close()


def words_of(text: str) -> list[str]:
    return re.findall(r"[a-z']+", text.lower())


def word_errors(said: Sequence[str], heard: Sequence[str]) -> int:
    """Words to replace, leave out and put in: the edit distance."""
    row = list(range(len(heard) + 1))
    for number, one in enumerate(said, 1):
        before, row = row, [number]
        for place_, other in enumerate(heard, 1):
            row.append(min(before[place_] + 1, row[-1] + 1, before[place_ - 1] + (one != other)))
    return row[-1]


async def understood(
    transcriber: ResidentProgram, voice: SpeechSynthesis, folder: Path
) -> tuple[float, list[Transcript]]:
    """The share of wrong words in all sentences, and what was understood of each."""
    wrong, transcripts = 0, []
    for text in SENTENCES:
        sound = (await voice.utterance(text)).sound
        file = folder / "said.wav"
        file.write_bytes(sound.to_bytes())
        transcript = await transcriber.ask({"file": str(file)}, Transcript, LIMIT_S)
        wrong += word_errors(words_of(text), words_of(transcript.text))
        transcripts.append(transcript)
        for one, other in zip(transcript.words, transcript.words[1:], strict=False):
            assert 0 <= one.begin <= one.end <= other.end <= sound.seconds + 1
    return wrong / sum(len(words_of(text)) for text in SENTENCES), transcripts


def _tell(capsys: pytest.CaptureFixture[str], figure: str) -> None:
    with capsys.disabled():
        sys.stdout.write(f"\n{figure}\n")


async def test_what_piper_says_is_understood(
    piper: SpeechSynthesis,
    transcriber: ResidentProgram,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    share, transcripts = await understood(transcriber, piper, tmp_path)
    _tell(capsys, f"Piper joe, tiny.en: {share:.1%} of the words are wrong")
    assert share <= MOST_WRONG
    assert all(0 < (transcript.confidence or 0) <= 1 for transcript in transcripts)


async def test_what_espeak_says_is_understood(
    transcriber: ResidentProgram, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    voice = SpeechSynthesis(SynthesisSettings(cache=str(tmp_path / "cache")), tmp_path)
    share, _ = await understood(transcriber, voice, tmp_path)
    _tell(capsys, f"espeak-ng, tiny.en: {share:.1%} of the words are wrong")
    assert share <= 2 * MOST_WRONG, "its voice is hard to understand"


async def test_piper_takes_speed_and_refuses_voices_that_are_not_there(
    piper: SpeechSynthesis,
) -> None:
    usual = VoiceChoice("", "", 160, 50)
    lengths = [
        (await piper.utterance(SENTENCES[2], usual.changed({"speed": speed}))).sound.seconds
        for speed in (120, 160, 220)
    ]
    # The voice has chance in it: a sentence is up to a tenth longer or shorter each time.
    assert lengths[0] > lengths[1] > lengths[2]
    assert lengths[0] > 1.4 * lengths[2]
    with pytest.raises(DriverError, match="en_US-joe-medium"):
        await piper.utterance("Hello", usual.changed({"language": "de"}))
    assert (await piper.utterance("And again.")).source == "synthesised"


async def test_a_sentence_from_a_loudspeaker_to_the_log(
    piper: SpeechSynthesis, tmp_path: Path
) -> None:
    """The microphone hears it from a file, cuts it, and has it understood."""
    wav = (await piper.utterance(SENTENCES[2])).sound
    quiet = bytes(2 * wav.rate)
    (tmp_path / "said.raw").write_bytes(quiet + wav.data + 2 * quiet)
    async with microphone_opener(tmp_path) as some:
        _, published = await some.open(
            RealClock(),
            command="sh -c 'cat said.raw; sleep 60'",
            rate=wav.rate,
            resident_transcriber=whisper(),
            threshold=0.01,
        )
        text = await published.first(SpeechText)
        speech_ended = published.all(SpeechEnded)[0]
    assert text.detail == ""
    assert word_errors(words_of(SENTENCES[2]), words_of(text.text)) <= 4
    assert speech_ended.began <= text.words[0].began < text.words[-1].ended <= speech_ended.ended
    (delay,) = [one for one in published.all(Reading) if one.sensor == TRANSCRIBER]
    assert delay.unit == "s"
    assert [one for one in published.all(Reading) if one.sensor == SPEECH] == []


async def test_silence_has_no_words(transcriber: ResidentProgram, tmp_path: Path) -> None:
    file = tmp_path / "quiet.wav"
    quiet = pcm_audio.encode(np.zeros(16_000, np.float32), "S16_LE")
    file.write_bytes(Wav("S16_LE", 16_000, 1, quiet).to_bytes())
    transcript = await transcriber.ask({"file": str(file)}, Transcript, LIMIT_S)
    assert len(words_of(transcript.text)) <= 2
    with pytest.raises(DriverError, match="no-such"):
        await transcriber.ask({"file": str(tmp_path / "no-such.wav")}, Transcript, LIMIT_S)
