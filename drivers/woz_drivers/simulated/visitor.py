"""A simulated person in front of the robot, and what the robot's sensors make of them.

A pure model, moved by asking for the time: `step(t)` returns every sample up to `t` seconds. It
has no clock and no task, and all chance comes from its seed, so that the same seed gives the same
samples whatever the steps.
"""

from __future__ import annotations

import enum
import math
import random
from dataclasses import dataclass

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

#: RMS above which the simulated microphone takes sound for speech: five spreads above the noise.
THRESHOLD = ROOM_NOISE + 5 * ROOM_SPREAD

#: Syllables a second; a syllable of spontaneous speech lasts about 0.2 s (Greenberg et al.,
#: Journal of Phonetics 31, 2003).
SYLLABLES = 4.3

SENSORS = ("presence", "gaze", "identity", "distance", "loudness", "direction")
UNITS = {"distance": "m", "direction": "deg"}
PEOPLE = ("V1", "V2")


class Phase(enum.Enum):
    """What the person is doing as a whole."""

    AWAY = "away"
    COMING = "coming"
    STAYING = "staying"
    DOUBTING = "stepped back"
    GOING = "going"


@dataclass(frozen=True, slots=True)
class Sample:
    """One value at `t` seconds; `value` None where the sensor saw nothing, `text` an identity."""

    t: float
    sensor: str
    value: float | None
    text: str = ""


class Visitor:
    """Comes, looks, talks, looks away, steps back, leaves, and comes again."""

    def __init__(self, seed: int) -> None:
        self._chance = random.Random(seed)
        self._tick = 0
        self.phase = Phase.AWAY
        self.person = self._chance.choice(PEOPLE)
        self.distance = DOOR
        self._goal = DOOR
        self._side = 0.0
        self._phase_ends = self._chance.uniform(2.0, 4.0)
        self.looking = False
        self._look_ends = 0.0
        self._talk_begins = math.inf
        self._talk_ends = 0.0
        self._near_since = math.inf
        self._blind_until = 0.0

    @property
    def present(self) -> bool:
        """Whether somebody is there."""
        return self.phase is not Phase.AWAY

    @property
    def talking(self) -> bool:
        """Whether the person is saying something now."""
        return self._talk_begins <= self._now < self._talk_ends

    @property
    def _now(self) -> float:
        return self._tick * TICK

    def step(self, t: float) -> list[Sample]:
        """All samples after the last step up to `t` seconds, oldest first."""
        samples: list[Sample] = []
        while (self._tick + 1) * TICK <= t + 1e-9:
            self._tick += 1
            self._live()
            samples += self._sensed()
        return samples

    def hear(self, ends: float) -> None:
        """The robot speaks until `ends`: a person who is near looks up and answers 1-2 s later."""
        if self.phase not in (Phase.STAYING, Phase.DOUBTING):
            return
        self.looking = True
        self._look_ends = ends + self._chance.uniform(3.0, 6.0)
        self._talk_begins = ends + self._chance.uniform(1.0, 2.0)
        self._talk_ends = self._talk_begins + self._chance.uniform(1.2, 3.5)
        self._phase_ends = max(self._phase_ends, self._talk_ends + 1.0)

    # -- the person ---------------------------------------------------------------------------

    def _live(self) -> None:
        if self._now >= self._phase_ends:
            self._next_phase()
        self._walk()
        if self.phase in (Phase.STAYING, Phase.DOUBTING):
            self._attend()
        recognisable = self.phase is not Phase.AWAY and self.looking and self.distance < 2.2
        if not recognisable:
            self._near_since = math.inf
        elif self._near_since == math.inf:
            self._near_since = self._now

    def _next_phase(self) -> None:
        chance = self._chance
        if self.phase is Phase.AWAY:
            self._enter(Phase.COMING, chance.uniform(0.85, 1.15), 12.0)
            self.distance = DOOR
            self._side = chance.uniform(-25.0, 25.0)
            self.person = chance.choice(PEOPLE)
            self.looking = False
            self._look_ends = self._now + chance.uniform(0.5, 2.5)
        elif self.phase is Phase.STAYING and chance.random() < 0.45:
            self._enter(Phase.DOUBTING, chance.uniform(1.6, 2.3), chance.uniform(4.0, 8.0))
        elif self.phase is Phase.DOUBTING and chance.random() < 0.5:
            self._enter(Phase.STAYING, chance.uniform(0.8, 1.2), chance.uniform(10.0, 25.0))
        elif self.phase is Phase.GOING:
            self._enter(Phase.AWAY, DOOR, chance.uniform(6.0, 15.0))
        elif self.phase is Phase.COMING:
            self._enter(Phase.STAYING, self._goal, chance.uniform(15.0, 35.0))
        else:
            self._enter(Phase.GOING, DOOR + 0.2, 10.0)
            self.looking = False
            self._talk_ends = self._now

    def _enter(self, phase: Phase, goal: float, seconds: float) -> None:
        self.phase = phase
        self._goal = goal
        self._phase_ends = self._now + seconds

    def _walk(self) -> None:
        if self.phase is Phase.AWAY:
            return
        pace = 0.65 if self.phase in (Phase.COMING, Phase.GOING) else 0.35
        self.distance += min(max(self._goal - self.distance, -pace * TICK), pace * TICK)
        arrived = abs(self._goal - self.distance) < 1e-6
        if arrived and self.phase in (Phase.COMING, Phase.GOING):
            self._phase_ends = min(self._phase_ends, self._now)
        if self.phase is Phase.COMING and self._now >= self._look_ends:
            self.looking = True

    def _attend(self) -> None:
        chance = self._chance
        if self._now >= self._look_ends and not self.talking:
            self.looking = not self.looking
            stay = chance.uniform(4.0, 9.0) if self.looking else chance.uniform(0.8, 2.5)
            self._look_ends = self._now + stay
        silent = self._now >= self._talk_ends
        if silent and self.looking and chance.random() < 0.012:
            self._talk_begins = self._now
            self._talk_ends = self._now + chance.uniform(1.0, 4.0)

    # -- the sensors --------------------------------------------------------------------------

    def _sensed(self) -> list[Sample]:
        samples = [
            Sample(self._now, "distance", self._range()),
            Sample(self._now, "loudness", self._loudness()),
        ]
        if self._tick % SLOW_EVERY == 0:
            samples += self._seen()
        return samples

    def _range(self) -> float | None:
        """Metres, to the centimetre; now and then the echo is lost for up to a second."""
        noise = self._chance.gauss(0.0, 0.015)
        lost = self._chance.random() < 0.004
        length = self._chance.uniform(0.2, 1.0)
        if lost and self._now >= self._blind_until:
            self._blind_until = self._now + length
        if self._now < self._blind_until:
            return None
        return round((self.distance if self.present else WALL) + noise, 2)

    def _loudness(self) -> float:
        """RMS of the last tick: the room, and bursts of syllables while the person talks."""
        room = max(0.001, self._chance.gauss(ROOM_NOISE, ROOM_SPREAD))
        strength = self._chance.uniform(0.8, 1.2)
        if not self.talking:
            return round(room, 4)
        syllable = 0.35 + 0.65 * abs(math.sin(math.pi * SYLLABLES * self._now))
        voice = VOICE * strength * syllable / max(self.distance, 0.5)
        return round(min(1.0, math.hypot(room, voice)), 4)

    def _seen(self) -> list[Sample]:
        missed, flicker, mistaken = (self._chance.random() for _ in range(3))
        turn = self._chance.gauss(0.0, 2.0)
        score = round(self._chance.uniform(0.6, 0.95), 2)
        present = self.present and missed >= 0.01
        looking = present and (self.looking != (flicker < 0.03))
        known = present and self._now - self._near_since > 1.5 and mistaken >= 0.06
        heard = self.talking or present
        return [
            Sample(self._now, "presence", float(present)),
            Sample(self._now, "gaze", float(looking)),
            Sample(self._now, "identity", score if known else 0.0, self.person if known else ""),
            Sample(self._now, "direction", round(self._side + turn, 1) if heard else None),
        ]
