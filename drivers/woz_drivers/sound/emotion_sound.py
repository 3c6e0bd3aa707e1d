"""Sounds without words that go with a mood: a few notes whose tempo, level, register, mode and so
on come from a table of cues (`emotion_cues.json`, which names the source of each).

The same mood, length and seed give the same samples. Whether people hear in them what is meant
nobody has measured: `docs/how-to/emotion-sounds.md` says how a lab does that.
"""

from __future__ import annotations

import functools
import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import msgspec
import numpy as np
import numpy.typing as npt

from woz_drivers.sound import pcm_audio
from woz_drivers.sound.wav import Wav
from woz_tui.motion.emotions import NEUTRAL, emotion_affect

#: Frames a second of a sound that is made here.
RATE = 16_000
#: Middle pitch of a robot that has no other, in Hz.
REGISTER = 440.0
#: Semitones above the first note of scales of five notes, beside that note and the third.
_WITH_MAJOR, _WITH_MINOR = (2.0, 7.0, 9.0), (5.0, 7.0, 10.0)
_MAJOR_THIRD = 4.0
#: The flutter that makes a sound rough, in Hz; how long a note takes to go, in seconds.
_FLUTTER_HZ, _RELEASE_S = 70.0, 0.02
#: No sample is louder, of full scale; no partial is higher, of the frames a second.
_LOUDEST, _HIGHEST = 0.95, 0.45

Samples = npt.NDArray[np.float64]


class Cue(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One row of the table: what of a sound changes with the mood, and who says so.

    It goes from `low` at -1 to `high` at 1 of what it is `by`; scale `ratio`: in equal ratios,
    `step`: `low` below 0, `high` from there on. `times`: it counts as much as there is of this,
    and below nothing not at all.
    """

    name: str
    what: str
    unit: str
    by: Literal["arousal", "valence"]
    low: float = msgspec.field(name="from")
    high: float = msgspec.field(name="to")
    scale: Literal["linear", "ratio", "step"]
    sources: list[str]
    times: Literal["", "arousal"] = ""

    def at(self, mood: Mapping[str, float]) -> float:
        """Its value at a place of the circle of moods."""
        place = min(1.0, max(-1.0, mood[self.by]))
        share = (place + 1) / 2
        if self.scale == "step":
            return self.high if place >= 0 else self.low
        if self.scale == "ratio":
            return float(self.low * (self.high / self.low) ** share)
        value = self.low + (self.high - self.low) * share
        return max(0.0, value) * (mood[self.times] + 1) / 2 if self.times else value


class CueTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """All rows, and the sources that they name."""

    sources: dict[str, str]
    cues: list[Cue]


@functools.cache
def cue_table() -> CueTable:
    """The table as it is installed."""
    return msgspec.json.decode(
        Path(__file__).with_name("emotion_cues.json").read_bytes(), type=CueTable
    )


@dataclass(frozen=True, slots=True)
class SoundCues:
    """The table at one mood; the table has what each means, and its unit."""

    tempo: float
    register: float
    range: float
    level: float
    attack: float
    held: float
    harmonics: float
    slope: float
    third: float
    contour: float
    glide: float
    roughness: float

    def notes(self, seconds: float) -> int:
        """How many notes or syllables fill the time; at least one."""
        return max(1, round(seconds * self.tempo))


def cues(valence: float, arousal: float) -> SoundCues:
    """What a sound of this mood is made of; both from -1 to 1."""
    mood = {"valence": valence, "arousal": arousal}
    return SoundCues(**{cue.name: cue.at(mood) for cue in cue_table().cues})


def mood(args: Mapping[str, Any]) -> tuple[float, float]:
    """Valence and arousal of a command `utter`: as they are given, else those of its emotion."""
    emotion = str(args.get("emotion") or NEUTRAL)
    named = emotion_affect(emotion, args.get("intensity", 1.0))
    given = [args.get(name) for name in ("valence", "arousal")]
    valence, arousal = (
        own if one is None else float(one) for one, own in zip(given, named, strict=True)
    )
    return valence, arousal


def emotion_sound(
    valence: float, arousal: float, seconds: float, seed: int, *, register: float = REGISTER
) -> Wav:
    """A sound of this mood, one channel at `RATE`; `register` is the robot's middle pitch in Hz."""
    made = cues(valence, arousal)
    chance = random.Random(seed)
    count = made.notes(seconds)
    frames = round(seconds * RATE)
    sound = np.zeros(frames)
    for number, pitch in enumerate(_pitches(made, count, chance)):
        begin, end = (round(frames * each / count) for each in (number, number + 1))
        held = max(1, round((end - begin) * made.held))
        glide = made.contour if count == 1 else made.glide
        note = _note(made, register * 2 ** (made.register + pitch / 12), glide, held)
        sound[begin : begin + held] = note
    return _wav(bounded(rough(sound, made.roughness)))


def levelled(samples: Samples, level: float) -> Samples:
    """The same with `level` as its RMS, in dB of full scale; what is silent stays so."""
    rms = float(np.sqrt(np.mean(np.square(samples)))) if samples.size else 0.0
    return samples * (10 ** (level / 20) / rms) if rms else samples


def rough(samples: Samples, depth: float, rate: int = RATE) -> Samples:
    """The same with a flutter that takes up to `depth` (0 to 1) of it away, as loud as before."""
    if not depth:
        return samples
    flutter = 0.5 + 0.5 * np.sin(2 * np.pi * _FLUTTER_HZ * np.arange(samples.size) / rate)
    fluttering = 1 - depth * flutter
    roughened: Samples = samples * fluttering / np.sqrt(np.mean(np.square(fluttering)))
    return roughened


def bounded(samples: Samples) -> Samples:
    """The same, softer if any of it were cut off."""
    loudest = float(np.max(np.abs(samples), initial=0.0))
    return samples * (_LOUDEST / loudest) if loudest > _LOUDEST else samples


def voiced_level(sound: Wav, every: float) -> tuple[float, ...]:
    """How loud a sound is, each `every` seconds: 0 to 1, 1 where it is loudest."""
    samples = pcm_audio.one_channel(pcm_audio.decode(sound.data, sound.format, sound.channels), 0)
    frames = max(1, round(every * sound.rate))
    pieces = [samples[at : at + frames] for at in range(0, samples.size, frames)]
    loud = [float(np.sqrt(np.mean(np.square(piece)))) for piece in pieces]
    loudest = max(loud, default=0.0)
    return tuple(round(each / loudest, 3) if loudest else 0.0 for each in loud)


def _pitches(made: SoundCues, count: int, chance: random.Random) -> Iterator[float]:
    """Semitones from the register, note by note: along the contour, with jumps by chance, each on
    the nearest note of the scale.
    """
    scale = _scale(made.third)
    for number in range(count):
        along = number / (count - 1) - 0.5 if count > 1 else 0.0
        wanted = made.contour * along + chance.uniform(-made.range / 2, made.range / 2)
        yield min(scale, key=functools.partial(_distance, wanted))


def _distance(one: float, other: float) -> float:
    return abs(one - other)


@functools.cache
def _scale(third: float) -> Sequence[float]:
    """The notes of the scale with this third, in two octaves below its first note and two above."""
    others = _WITH_MINOR if third < _MAJOR_THIRD else _WITH_MAJOR
    octaves = (-24.0, -12.0, 0.0, 12.0)
    return tuple(octave + degree for octave in octaves for degree in (0.0, third, *others))


def _note(made: SoundCues, pitch: float, glide: float, frames: int) -> Samples:
    """One note of `frames`, which rises by `glide` semitones."""
    place = np.arange(frames) / frames
    phase = 2 * np.pi * np.cumsum(pitch * 2 ** (glide * (place - 0.5) / 12)) / RATE
    note = np.zeros(frames)
    for partial in range(1, int(made.harmonics) + 2):
        share = min(1.0, made.harmonics - partial + 1)  # half a partial is half as loud
        if share > 0 and pitch * partial * 2 ** (abs(glide) / 24) < _HIGHEST * RATE:
            note += share * partial**-made.slope * np.sin(partial * phase)
    rise = min(frames, max(1, round(made.attack / 1000 * RATE)))
    fall = min(frames, round(_RELEASE_S * RATE))
    note = levelled(note, made.level)
    note[:rise] *= 0.5 - 0.5 * np.cos(np.pi * np.arange(rise) / rise)
    note[frames - fall :] *= 0.5 + 0.5 * np.cos(np.pi * np.arange(fall) / fall)
    return note


def _wav(samples: Samples) -> Wav:
    return Wav("S16_LE", RATE, 1, pcm_audio.encode(samples.astype(np.float32), "S16_LE"))
