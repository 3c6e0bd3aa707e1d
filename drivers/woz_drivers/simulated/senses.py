"""The simulated sensors: what they make of a person, with noise, lost echoes and mistakes.

Every tick takes the same number of draws whatever the person does, so that a tick's noise depends
on its number alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random

#: The model's own tick in seconds; distance and loudness are sampled at each.
TICK = 0.1

#: Presence, gaze, identity and direction come every so many ticks: 3.3 Hz.
SLOW_EVERY = 3

#: Metres from the robot at which the sensors lose a person, and what the range sensor then sees.
DOOR, WALL = 4.5, 4.9

#: The room's own noise: RMS of full scale, and its spread.
ROOM_NOISE, ROOM_SPREAD = 0.012, 0.003

#: RMS of speech one metre away; it falls with the distance.
VOICE = 0.16

#: RMS above which the simulated microphone takes sound for speech: so many spreads above the noise.
SENSITIVITY = 5.0
THRESHOLD = ROOM_NOISE + SENSITIVITY * ROOM_SPREAD

#: Syllables a second; a syllable of spontaneous speech lasts about 0.2 s (Greenberg et al.,
#: Journal of Phonetics 31, 2003).
SYLLABLES = 4.3

SENSORS = ("presence", "gaze", "identity", "distance", "loudness", "direction")
UNITS = {"distance": "m", "direction": "deg"}


@dataclass(frozen=True, slots=True)
class Sample:
    """One value at `t` seconds; `value` None where the sensor saw nothing, `text` an identity."""

    t: float
    sensor: str
    value: float | None
    text: str = ""


@dataclass(frozen=True, slots=True)
class VisitorView:
    """The person as they are: metres (None: nobody), degrees to the left, a name to recognise."""

    distance: float | None
    looking: bool
    talking: bool
    side: float
    face: str


class SimulatedSensors:
    """All sensors of the simulated robot that are about people."""

    def __init__(self, seed: int) -> None:
        self._chance = Random(f"{seed} noise")
        self._blind_until = 0.0

    def sensed(self, tick: int, view: VisitorView) -> list[Sample]:
        """The samples of one tick; each has to be asked for, in order."""
        now = tick * TICK
        samples = [
            Sample(now, "distance", self._range(now, view)),
            Sample(now, "loudness", self._loudness(now, view)),
        ]
        if tick % SLOW_EVERY == 0:
            samples += self._people_samples(now, view)
        return samples

    def _range(self, now: float, view: VisitorView) -> float | None:
        """Metres, to the centimetre; now and then the echo is lost for up to 0.7 s."""
        noise = self._chance.gauss(0.0, 0.015)
        lost = self._chance.random() < 0.004
        length = self._chance.uniform(0.2, 0.7)
        if lost and now >= self._blind_until:
            self._blind_until = now + length
        if now < self._blind_until:
            return None
        return round((WALL if view.distance is None else view.distance) + noise, 2)

    def _loudness(self, now: float, view: VisitorView) -> float:
        """RMS of the last tick: the room, and bursts of syllables while the person talks."""
        room = max(0.001, self._chance.gauss(ROOM_NOISE, ROOM_SPREAD))
        strength = self._chance.uniform(0.8, 1.2)
        if not view.talking or view.distance is None:
            return round(room, 4)
        syllable = 0.35 + 0.65 * abs(math.sin(math.pi * SYLLABLES * now))
        voice = VOICE * strength * syllable / max(view.distance, 0.5)
        return round(min(1.0, math.hypot(room, voice)), 4)

    def _people_samples(self, now: float, view: VisitorView) -> list[Sample]:
        missed, flicker, mistaken = (self._chance.random() for _ in range(3))
        turn = self._chance.gauss(0.0, 2.0)
        score = round(self._chance.uniform(0.6, 0.95), 2)
        somebody = view.distance is not None
        present = somebody and missed >= 0.01
        looking = present and (view.looking != (flicker < 0.03))
        name = view.face if present and mistaken >= 0.06 else ""
        return [
            Sample(now, "presence", float(present)),
            Sample(now, "gaze", float(looking)),
            Sample(now, "identity", score if name else 0.0, name),
            Sample(now, "direction", round(view.side + turn, 1) if somebody else None),
        ]
