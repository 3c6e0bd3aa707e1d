"""What the microphones hear: noise, and the visitor's voice when they talk."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from naoqi_simulator.visitor import Person

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Samples = NDArray[np.int16]

#: getFrontMicEnergy counts like this in a quiet room, and with somebody talking a metre away.
QUIET, LOUD = 250.0, 4000.0
HIGHEST = 10_000.0
#: Hz of the simulated voice, and how often a second it gets louder and softer: syllables.
PITCH_HZ, SYLLABLES_HZ = 160.0, 4.0


def energy(person: Person | None, now: float) -> float:
    """Of the front microphone, 0 to about 10000."""
    # A room is never quite the same from one moment to the next.
    noise = QUIET * (1.0 + 0.3 * math.sin(now * 7.3) * math.sin(now * 1.1))
    if person is None or not person.talking:
        return noise
    syllable = 0.4 + 0.6 * abs(math.sin(math.pi * SYLLABLES_HZ * now))
    return min(HIGHEST, noise + LOUD * syllable / max(0.4, person.distance))


def block(person: Person | None, begin: float, samples: int, rate: int, channels: int) -> Samples:
    """Sound of `samples` a channel from a time on, interleaved; the same for the same time."""
    import numpy as np  # noqa: PLC0415 - most robots are not listened to, and start sooner

    times = begin + np.arange(samples) / rate
    noise = np.random.default_rng(round(begin * 1000)).normal(0.0, 60.0, samples)
    sound = noise
    if person is not None and person.talking:
        loud = 6000.0 / max(0.4, person.distance)
        voice = sum(np.sin(2 * np.pi * PITCH_HZ * n * times) / n for n in range(1, 6))
        sound = noise + loud * voice * np.abs(np.sin(np.pi * SYLLABLES_HZ * times)) / 2
    mono = np.clip(sound, -32768, 32767).astype("<i2")
    return np.repeat(mono, channels)
