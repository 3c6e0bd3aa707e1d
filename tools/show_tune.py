"""Makes the music of the show, a tune of our own: `python -m tools.show_tune [folder]`.

`tune.wav` lasts as long as a dance of the happy robot and can follow itself without a gap;
`run-down.wav` is the same tune, played by somebody who breaks down.
"""

from __future__ import annotations

import sys
import wave
from collections.abc import Iterator
from pathlib import Path

from tools import EXPERIMENTS

FOLDER = EXPERIMENTS / "media"
#: Samples a second, of one byte each: it is to sound like a robot, and to be small.
RATE = 8000
#: Joy's tempo (2.7 beats a second) at its speed (1.2).
BEATS_A_SECOND = 3.24
#: Notes as semitones above middle C, two to a beat, for four bars; None is a rest.
MELODY = (
    *(12, None, 16, 19, None, 16, 12, None),
    *(14, None, 17, 21, None, 17, 14, None),
    *(16, 19, 24, 19, 21, 19, 17, 14),
    *(16, None, 14, None, 12, 12, 12, None),
)
#: The same for the bass, one to a beat.
BASS = (-12, -5, -12, -5, -10, -3, -10, -3, -8, -1, -7, 0, -5, -5, -12, -12)
MIDDLE_C = 261.63
SILENCE = 128


def tune() -> bytes:
    """Four bars."""
    length = round(len(BASS) / BEATS_A_SECOND * RATE)
    return bytes(_at(index / RATE * BEATS_A_SECOND) for index in range(length))


def run_down(seconds: float = 3.0) -> bytes:
    """The tune from its beginning, slower and deeper until it stands still."""
    return bytes(_at(beat) for beat in _slower(seconds))


def _slower(seconds: float) -> Iterator[float]:
    beat = 0.0
    for index in range(round(seconds * RATE)):
        yield beat
        left = 1.0 - index / (seconds * RATE)
        beat += left * left * BEATS_A_SECOND / RATE


def _at(beat: float) -> int:
    """The sample at a moment, counted in beats."""
    melody, bass = MELODY[int(2 * beat) % len(MELODY)], BASS[int(beat) % len(BASS)]
    loud = _square(melody, beat, 2 * beat % 1.0, 34) + _square(bass, beat, beat % 1.0, 26)
    return SILENCE + loud


def _square(semitones: int | None, beat: float, since: float, size: int) -> int:
    """A square wave that fades by the share `since` of its note."""
    if semitones is None:
        return 0
    pitch = MIDDLE_C * 2.0 ** (semitones / 12)
    turns = pitch * beat / BEATS_A_SECOND
    return round(size * (1.0 - since)) * (1 if turns % 1.0 < 0.5 else -1)


def write(path: Path, samples: bytes) -> None:
    """A WAV file of one channel."""
    with wave.open(str(path), "wb") as sound:
        sound.setnchannels(1)
        sound.setsampwidth(1)
        sound.setframerate(RATE)
        sound.writeframes(samples)


def main() -> None:
    """Write both files."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    write(folder / "tune.wav", tune())
    write(folder / "run-down.wav", run_down())


if __name__ == "__main__":
    main()
