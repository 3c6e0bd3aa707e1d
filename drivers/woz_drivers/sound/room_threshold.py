"""The verb `listen_room`: the threshold of speech, learnt from a room in which nobody speaks."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from woz_tui.drivers.contract import DriverContext, DriverError
from woz_tui.protocol.messages import Json

NAME = "listen_room"
#: The reading that tells it: RMS above which sound counts as speech.
THRESHOLD = "loudness.threshold"
#: A threshold is never learned lower than this: dither of a 16-bit converter is 1e-5.
LEAST_THRESHOLD = 0.001
_MOST_THRESHOLD = 0.9
#: Noise of a room is never so many times as loud as its median for 20 ms.
_STANDS_OUT = 4.0


@dataclass(frozen=True, slots=True)
class RoomNoise:
    """What a room sounds like while nobody speaks: levels are RMS, 0 to 1 of full scale."""

    mean: float
    sd: float
    loudest: float
    blocks: int
    median: float

    @property
    def restless(self) -> bool:
        """Whether something stood out: a voice, a door. Steady noise keeps near its median."""
        return self.loudest > max(_STANDS_OUT * self.median, LEAST_THRESHOLD)

    def threshold(self, k: float) -> float:
        """Mean + k standard deviations, kept within what a microphone can tell apart."""
        return min(max(self.mean + k * self.sd, LEAST_THRESHOLD), _MOST_THRESHOLD)


def room_noise(levels: Sequence[float]) -> RoomNoise:
    """The room behind a series of block levels; at least one."""
    mean = math.fsum(levels) / len(levels)
    variance = math.fsum((level - mean) ** 2 for level in levels) / len(levels)
    return RoomNoise(mean, math.sqrt(variance), max(levels), len(levels), statistics.median(levels))


@dataclass(frozen=True, slots=True)
class LearntThreshold:
    """What was learnt by whom: `k` standard deviations above the mean, in blocks of `block_s`
    seconds. `keeping`: what to do so that the next session knows it too.
    """

    driver: str
    room: RoomNoise
    k: float
    block_s: float
    keeping: str

    @property
    def threshold(self) -> float:
        """Louder than that is speech."""
        return self.room.threshold(self.k)

    def publish(self, context: DriverContext, was: float) -> dict[str, Json]:
        """Publish the threshold and say what to think of it; returns the same for the log.

        Raises `DriverError`, and publishes nothing, if there was no sound at all.
        """
        room, threshold = self.room, self.threshold
        if room.loudest == 0:
            raise DriverError(
                f"{self.driver} hears only zeros: the threshold is unchanged",
                "switch the microphone on, or choose another device",
            )
        context.reading(THRESHOLD, threshold)
        context.notice(
            "info",
            f"speech is now louder than {threshold:.4f}"
            f" (room {room.mean:.4f} + {self.k:g} x {room.sd:.4f})",
            self.keeping.format(threshold=f"{threshold:.4f}"),
            tells=("loudness",),
        )
        if room.restless:
            context.notice(
                "warning",
                f"it was not quiet while it listened: {room.loudest:.4f} at the loudest",
                f"play {NAME} once more while nobody speaks",
                tells=("loudness",),
            )
        return {
            "threshold": threshold,
            "was": was,
            "mean": room.mean,
            "sd": room.sd,
            "k": self.k,
            "loudest": room.loudest,
            "seconds": room.blocks * self.block_s,
        }
