"""When does somebody speak? Levels of 20 ms blocks in, states out; free of input and output."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from woz_drivers.sound import Samples, clipped, rms

#: Length of a block, in seconds.
BLOCK_S = 0.02
#: A state that a single block brings about (clipping) is shown for so long, in seconds.
_SHOWN_S = 1.0
#: So many samples of a block at full scale are clipping; a lone peak may just touch it.
_CLIPS = 3
#: A threshold is never learned lower than this: dither of a 16-bit converter is 1e-5.
LEAST_THRESHOLD = 0.001
_MOST_THRESHOLD = 0.9


@dataclass(frozen=True, slots=True)
class Ear:
    """What counts as speech; durations in seconds.

    A block is loud if its RMS lies strictly above `threshold`. `onset` of loud blocks in a row
    begin speech, `hang_over` of quiet ones end it. All zeros for `silent_after` mean that the
    microphone is off or muted: a live one always has some noise.
    """

    threshold: float
    onset: float
    hang_over: float
    silent_after: float


class Speaking:
    """Turns blocks into a state: quiet, speaking, clipping (speaking, and too loud for the
    converter) or silent.
    """

    def __init__(self, ear: Ear) -> None:
        self.threshold = ear.threshold
        self._onset = _blocks(ear.onset)
        self._hang_over = _blocks(ear.hang_over)
        self._silent_after = _blocks(ear.silent_after)
        self.forget()

    def forget(self) -> None:
        """Begin afresh, for a new stream; the threshold stays."""
        self._loud = 0
        self._quiet = 0
        self._zeros = 0
        self._since_clipping = _blocks(_SHOWN_S)
        self._speaks = False

    def take(self, samples: Samples) -> float:
        """Judge the next block; returns its RMS."""
        level = rms(samples)
        self._zeros = 0 if samples.any() else self._zeros + 1
        self._since_clipping = 0 if clipped(samples) >= _CLIPS else self._since_clipping + 1
        if level > self.threshold:
            self._loud += 1
            self._quiet = 0
            self._speaks = self._speaks or self._loud >= self._onset
        else:
            self._loud = 0
            self._quiet += 1
            self._speaks = self._speaks and self._quiet < self._hang_over
        return level

    @property
    def state(self) -> str:
        """The state after the last block."""
        if self._zeros >= self._silent_after:
            return "silent"
        if not self._speaks:
            return "quiet"
        return "clipping" if self._since_clipping < _blocks(_SHOWN_S) else "speaking"


@dataclass(frozen=True, slots=True)
class Room:
    """What a room sounds like while nobody speaks: levels are RMS, 0 to 1 of full scale."""

    mean: float
    sd: float
    loudest: float
    blocks: int

    def threshold(self, k: float) -> float:
        """Mean + k standard deviations, kept within what a microphone can tell apart."""
        return min(max(self.mean + k * self.sd, LEAST_THRESHOLD), _MOST_THRESHOLD)


def learn(levels: Sequence[float]) -> Room:
    """The room behind a series of block levels; at least one."""
    mean = math.fsum(levels) / len(levels)
    variance = math.fsum((level - mean) ** 2 for level in levels) / len(levels)
    return Room(mean, math.sqrt(variance), max(levels), len(levels))


def _blocks(seconds: float) -> int:
    """How many blocks make up `seconds`; at least one."""
    return max(1, round(seconds / BLOCK_S))
