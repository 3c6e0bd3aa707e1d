"""Emotions as places on Russell's circle: valence to the right, arousal upwards.

The direction says which emotion, the distance from the middle how strong it is. Every direction
belongs to one emotion, so no knob turned round the circle finds a gap. Why the borders
lie where they do: `docs/explanation/decisions/012-every-mood-has-one-emotion.md`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from woz_tui.drivers.contract import RejectedError

NEUTRAL = "neutral"

#: Where each emotion's sector begins, in degrees from "pleasant, neither calm nor excited"
#: against the clock; the border belongs to the sector that begins there.
SECTORS: tuple[tuple[float, str], ...] = (
    (-180.0, "sad"),
    (-120.0, "sleepy"),
    (-30.0, "happy"),
    (60.0, "amazed"),
    (120.0, "angry"),
)

#: The direction that stands for an emotion when knobs have to show it.
DIRECTIONS: Mapping[str, float] = {
    "happy": 30.0,
    "amazed": 90.0,
    "angry": 150.0,
    "sad": -150.0,
    "sleepy": -90.0,
    "friendly": 0.0,
}

#: Emotions that a sound or a face can be asked for by name, wherever they stand on the circle.
FEELINGS = (NEUTRAL, *DIRECTIONS)

#: Decimals of a degree that count; rounding of a scaled pair then never crosses a border.
_DECIMALS = 6


def affect_emotion(valence: float, arousal: float) -> tuple[str, float]:
    """The emotion (never friendly or crash) and its intensity, 0..1, of a mood.

    Both are clamped to -1..1; the corners of that square have intensity 1 as the circle has.
    Raises `RejectedError` for numbers that are not finite.
    """
    if not (math.isfinite(valence) and math.isfinite(arousal)):
        raise RejectedError(
            f"valence {valence} and arousal {arousal} are no place on the circle of moods",
            "give numbers from -1 to 1",
        )
    valence, arousal = _clamped(valence), _clamped(arousal)
    intensity = min(1.0, math.hypot(valence, arousal))
    if intensity == 0.0:
        return NEUTRAL, 0.0
    return emotion_at(math.degrees(math.atan2(arousal, valence))), intensity


def emotion_at(degrees: float) -> str:
    """The emotion in a direction of the circle; any finite angle."""
    angle = (round(degrees, _DECIMALS) + 180.0) % 360.0 - 180.0
    return next(emotion for start, emotion in reversed(SECTORS) if angle >= start)


def emotion_affect(emotion: str, intensity: float) -> tuple[float, float]:
    """Valence and arousal, -1..1, at which knobs stand for an emotion.

    `affect_emotion` leads back to the same emotion and intensity, but for those without a sector:
    friendly stands at "pleasant, neither calm nor excited", neutral and crash in the middle.
    """
    direction = DIRECTIONS.get(emotion)
    if direction is None or not math.isfinite(intensity):
        return 0.0, 0.0
    length = min(1.0, max(0.0, intensity))
    angle = math.radians(direction)
    return length * math.cos(angle), length * math.sin(angle)


def _clamped(value: float) -> float:
    return min(1.0, max(-1.0, value))
