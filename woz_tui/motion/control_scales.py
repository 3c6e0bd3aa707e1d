"""Knobs: a place from 0 to 1, and the value that it stands for.

A joint's own control goes from its lowest to its highest angle and belongs to
`joint_control.DesiredPose`, as does the zoom. Values outside a knob's reach (a tempo written into a
file) stand at its end.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

#: A knob with a middle counts as in the middle when it is this near: 64 of 127 is half a step
#: beside it, and a mood or a gaze would drift.
MIDDLE = 0.51 / 127


@dataclass(frozen=True, slots=True)
class ControlScale:
    """`value(place)` and back; both ends of a place are 0 and 1."""

    value: Callable[[float], float]
    place: Callable[[float], float]


def _linear(low: float, high: float) -> ControlScale:
    return ControlScale(
        lambda place: low + place * (high - low),
        lambda value: min(1.0, max(0.0, (value - low) / (high - low))),
    )


def _both() -> ControlScale:
    """From -1 over a middle that can be hit to 1."""
    return ControlScale(
        lambda place: 0.0 if abs(place - 0.5) <= MIDDLE else 2.0 * place - 1.0,
        lambda value: min(1.0, max(0.0, (value + 1.0) / 2.0)),
    )


def _octaves(low: float, high: float) -> ControlScale:
    """Equal turns multiply by equal factors."""
    ratio = math.log(high / low)
    return ControlScale(
        lambda place: low * math.exp(place * ratio),
        lambda value: min(1.0, max(0.0, math.log(max(value, 1e-9) / low) / ratio)),
    )


#: Traits of the personality that have a knob, and between what it turns them.
TRAITS: Mapping[str, ControlScale] = {
    "tempo": _linear(64 / 60, 192 / 60),  # Hz: 64 to 192 beats a minute
    "breathing": _linear(0.0, 10.0),  # deg, amplitude
    "smoothing": _linear(0.0, 0.5),  # s, time constant
    "compression": _linear(0.0, 1.0),
    "speed": _octaves(0.25, 4.0),
    "amplitude": _linear(0.0, 2.0),
}

#: Knobs of the face.
FACE: Mapping[str, ControlScale] = {
    "eye-x": _both(),  # the robot's right to its left
    "eye-y": _both(),  # down to up
    "valence": _both(),
    "arousal": _both(),
    "intensity": _linear(0.0, 1.0),
    "brightness": _linear(0.0, 1.0),
}
