"""Syllables without a meaning, spoken by espeak-ng as the table of cues has it for a mood.

They are phonemes, not letters, so that no language's rules of spelling make words of them. Two or
three by chance may sound like a word all the same, in whatever language is spoken there.
"""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np

from woz_drivers.programs import child_process, command_lines
from woz_drivers.sound import emotion_sound, pcm_audio, wav
from woz_drivers.sound.emotion_sound import SoundCues
from woz_drivers.sound.wav import Wav
from woz_drivers.speech.synthesis import finish
from woz_tui.drivers.contract import DriverError, RejectedError

PROGRAM = "espeak-ng"
#: Its names of phonemes that every one of its languages has.
_CONSONANTS, _VOWELS = ("b", "d", "g", "l", "m", "n", "p", "t", "k"), ("a", "e", "i", "o", "u")
_VOICE = "en"
#: Syllables of one word.
_SYLLABLES = (2, 3)
#: Words a minute at which it speaks one syllable a second, and what it takes; its pitch (0 to 99)
#: in the middle, and for an octave.
_SPEED, _SPEEDS, _PITCH, _OCTAVE = 27.0, (80, 400), 50, 60.0
#: Below so many syllables a second, which is as slow as it speaks, vowels are long.
_SLOW, _LONG = 2.5, ":"
#: So much of the silence at its end is kept, in seconds.
_END_S = 0.05
#: It may take so long, in seconds.
_PATIENCE_S = 10.0


def phonemes(made: SoundCues, seconds: float, seed: int) -> str:
    """Words without a meaning that take about this time; the same seed gives the same."""
    chance = random.Random(seed)
    left, length = made.notes(seconds), _LONG if made.tempo < _SLOW else ""
    words = []
    while left > 0:
        count = min(left, chance.randint(*_SYLLABLES))
        syllables = (
            chance.choice(_CONSONANTS) + chance.choice(_VOWELS) + length for _ in range(count)
        )
        words.append("'" + "".join(syllables))
        left -= count
    return f"[[{' '.join(words)}]]"


def found(folder: Path) -> None:
    """Raise `RejectedError` unless espeak-ng is there."""
    try:
        command_lines.find(PROGRAM, folder)
    except DriverError as error:
        raise RejectedError(
            f"gibberish needs {PROGRAM}, and it is not installed",
            f"sudo apt install {PROGRAM}, or do without `voice: gibberish`",
        ) from error


async def gibberish(made: SoundCues, seconds: float, seed: int, *, folder: Path) -> Wav:
    """Such words as sound, at tempo, pitch, level and roughness of the table.

    Raises `RejectedError` where espeak-ng is missing.
    """
    found(folder)
    slowest, fastest = _SPEEDS
    speed = min(fastest, max(slowest, round(_SPEED * made.tempo)))
    pitch = min(99, max(0, round(_PITCH + _OCTAVE * made.register)))
    with child_process.temporary_file("gibberish.wav") as path:
        values = ("-v", _VOICE, "-s", str(speed), "-p", str(pitch), "-w", str(path))
        words = (PROGRAM, *values, phonemes(made, seconds, seed))
        await finish(await child_process.start(words, folder), _PATIENCE_S)
        content = path.read_bytes()
    spoken = wav.parse(content).without_end(_END_S)
    samples = pcm_audio.decode(spoken.data, spoken.format, spoken.channels)[:, 0].astype(np.float64)
    felt = emotion_sound.rough(
        emotion_sound.levelled(samples, made.level), made.roughness, spoken.rate
    )
    data = pcm_audio.encode(emotion_sound.bounded(felt).astype(np.float32), spoken.format)
    return Wav(spoken.format, spoken.rate, 1, data)
