"""Knobs: a place from 0 to 1, and the value that it stands for.

A joint's own control goes from its lowest to its highest angle and belongs to
`joint_control.DesiredPose`, as does the zoom. Values outside a knob's reach (a tempo written into a
file) stand at its end.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

#: A knob with a middle counts as in the middle when it is this near: 64 of 127 is half a step
#: beside it, and a mood or a gaze would drift.
MIDDLE = 0.51 / 127


class ControlScale(ABC):
    """A knob's way from end to end; both ends of a place are 0 and 1."""

    @abstractmethod
    def value(self, place: float) -> float:
        """What a place stands for."""

    @abstractmethod
    def place(self, value: float) -> float:
        """Where the knob stands for a value."""


@dataclass(frozen=True, slots=True)
class _Linear(ControlScale):
    low: float
    high: float

    def value(self, place: float) -> float:
        return self.low + place * (self.high - self.low)

    def place(self, value: float) -> float:
        return min(1.0, max(0.0, (value - self.low) / (self.high - self.low)))


class _Both(ControlScale):
    """From -1 over a middle that can be hit to 1."""

    def value(self, place: float) -> float:
        return 0.0 if abs(place - 0.5) <= MIDDLE else 2.0 * place - 1.0

    def place(self, value: float) -> float:
        return min(1.0, max(0.0, (value + 1.0) / 2.0))


@dataclass(frozen=True, slots=True)
class _Octaves(ControlScale):
    """Equal turns multiply by equal factors."""

    low: float
    high: float

    def value(self, place: float) -> float:
        return self.low * math.exp(place * math.log(self.high / self.low))

    def place(self, value: float) -> float:
        ratio = math.log(self.high / self.low)
        return min(1.0, max(0.0, math.log(max(value, 1e-9) / self.low) / ratio))


#: Traits of the personality that have a knob, and between what it turns them.
TRAITS: Mapping[str, ControlScale] = {
    "tempo": _Linear(64 / 60, 192 / 60),  # Hz: 64 to 192 beats a minute
    "breathing": _Linear(0.0, 10.0),  # deg, amplitude
    "smoothing": _Linear(0.0, 0.5),  # s, time constant
    "compression": _Linear(0.0, 1.0),
    "speed": _Octaves(0.25, 4.0),
    "amplitude": _Linear(0.0, 2.0),
}

#: Knobs of the face.
FACE: Mapping[str, ControlScale] = {
    "eye-x": _Both(),  # the robot's right to its left
    "eye-y": _Both(),  # down to up
    "valence": _Both(),
    "arousal": _Both(),
    "intensity": _Linear(0.0, 1.0),
    "brightness": _Linear(0.0, 1.0),
}
