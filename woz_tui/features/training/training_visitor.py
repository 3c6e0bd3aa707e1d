"""Simulates the visitor of a training: comes, looks, speaks, turns away, leaves.

Pure: told what to do and what time it is, it says what the sensors would say.
"""

from __future__ import annotations

import random
from dataclasses import dataclass

from woz_tui.config.experiment import Experiment
from woz_tui.config.sensor_names import published_names
from woz_tui.protocol import messages as m

#: Where the visitor stands when near, and when away (metres), and how fast they walk (m/s).
NEAR_M, AWAY_M, WALK_M_PER_S = 0.9, 3.6, 1.2
#: Within this distance of where they are going they have arrived (metres).
_ARRIVED_M = 0.02
#: RMS of full scale while somebody speaks, and while nobody does.
SPEAKS, QUIET = 0.25, 0.01
#: What a visitor says takes about 150 words a minute.
WORDS_PER_S = 2.5
#: Seconds between two samples.
PERIOD_S = 0.1
DRIVER = "visitor"
_UNITS = {"distance": "m"}


@dataclass
class TrainingVisitor:
    """Where the visitor is and what they do; `step` moves it on."""

    #: What each quantity is called in this experiment.
    names: dict[str, str]
    chance: random.Random
    distance: float = AWAY_M
    target: float = AWAY_M
    looks: bool = False
    speaks: bool = False

    @classmethod
    def of(cls, experiment: Experiment, seed: int) -> TrainingVisitor:
        """For an experiment, with its names of the sensors."""
        return cls(_names(experiment), random.Random(f"{seed} visitor"))

    @property
    def near(self) -> bool:
        """Whether they stand before the robot, or are on their way there."""
        return self.target < AWAY_M

    @property
    def arrived(self) -> bool:
        """Whether they are where they were going."""
        return abs(self.distance - self.target) <= _ARRIVED_M

    def approach(self) -> None:
        """Walk up to the robot and look at it."""
        self.target, self.looks = NEAR_M, True

    def leave(self) -> None:
        """Walk away."""
        self.target, self.looks, self.speaks = AWAY_M, False, False

    def turn(self, away: bool) -> None:
        """Look away from the robot, or at it again."""
        self.looks = not away

    def step(self) -> list[m.Reading]:
        """`PERIOD_S` later: where they are, and what the sensors say of it."""
        reach = WALK_M_PER_S * PERIOD_S
        gap = self.target - self.distance
        self.distance += max(-reach, min(reach, gap))
        present = self.near or not self.arrived
        loudness = (SPEAKS if self.speaks else QUIET) * self.chance.uniform(0.7, 1.3)
        values = {
            "presence": float(present),
            "gaze": float(present and self.looks),
            "distance": self.distance + self.chance.gauss(0.0, 0.01) if present else None,
            "loudness": loudness,
        }
        return [
            m.reading(self.names[each], value, driver=DRIVER, unit=_UNITS.get(each, ""))
            for each, value in values.items()
        ]


def seconds_to_say(text: str) -> float:
    """How long the visitor speaks."""
    return 0.4 + len(text.split()) / WORDS_PER_S


def _names(experiment: Experiment) -> dict[str, str]:
    """What the readings are called: as the engagement model expects them, else as a driver of this
    robot publishes them, else by themselves.
    """
    quantities = ("presence", "gaze", "distance", "loudness")
    names = {each: each for each in quantities}
    for published in published_names(experiment.drivers).values():
        names |= {each: published[each] for each in quantities if each in published}
    if experiment.engagement is not None:
        settings = experiment.engagement.settings
        for each in ("presence", "gaze", "distance"):
            sensor = getattr(settings, each).sensor
            names[each] = sensor or names[each]
        names["loudness"] = settings.sound.sensor or names["loudness"]
    return names
