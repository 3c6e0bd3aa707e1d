"""Reads single values of ALMemory: numbers, the sonar, the battery, a sound's direction.

Whatever a robot puts there, nothing in here raises: None is "that makes no sense". Shapes are those
of NAOqi 2.4 to 2.9 (doc.aldebaran.com, "naoqi/audio/alsoundlocalization", "naoqi/core/almemory").
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

BATTERY = "Device/SubDeviceList/Battery/Charge/Sensor/Value"
SOUND = "ALSoundLocalization/SoundLocated"

#: Of what a robot calls its states and postures, in characters.
_LONGEST_WORD = 100
#: How much of an answer that makes no sense is shown, in characters.
_SHOWN = 60
#: Metres beyond which no sonar measures: the reach of a Pepper's is 0.3 to 5 m, of a NAO's less.
SONAR_REACH_M = 10.0
#: Largest microphone energy: the root of the mean square of 16-bit samples, averaged over the last
#: buffers. doc.aldebaran.com gives no unit; who wrote ALAudioDevice's clients gives this formula
#: (stackoverflow.com/questions/42224692).
FULL_SCALE = 32768.0


def brief(value: Any) -> str:
    """A value that makes no sense, as far as somebody wants to read it."""
    text = repr(value)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}…"


def items(value: Any) -> Sequence[Any]:
    """A list or tuple as it is; nothing for everything else, also for text."""
    return value if isinstance(value, (list, tuple)) else ()


def item(value: Any, *places: int) -> Any:
    """`value[places[0]][places[1]]...`, or None where there is no such place."""
    for place in places:
        inside = items(value)
        if not 0 <= place < len(inside):
            return None
        value = inside[place]
    return value


def number(value: Any) -> float | None:
    """A finite number; None for a flag, text, NaN, infinity and whatever else."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        found = float(value)
    except OverflowError:
        return None
    return found if math.isfinite(found) else None


def within(value: Any, low: float, high: float) -> float | None:
    """A number from `low` to `high`."""
    found = number(value)
    return found if found is not None and low <= found <= high else None


def flag(value: Any) -> bool | None:
    """True or false, also as 1 or 0."""
    if isinstance(value, bool):
        return value
    found = number(value)
    return bool(found) if found in (0.0, 1.0) else None


def word(value: Any) -> str | None:
    """A name or a state: a short text that can be shown."""
    readable = isinstance(value, str) and len(value) <= _LONGEST_WORD and value.isprintable()
    return value if readable else None


def sonar(value: Any) -> float | None:
    """Metres to what stands in front, above 0."""
    found = within(value, 0.0, SONAR_REACH_M)
    return found or None


def battery(value: Any) -> float | None:
    """Charge from 0 to 1."""
    return within(value, 0.0, 1.0)


def loudness(value: Any) -> float | None:
    """A microphone's energy as RMS from 0 to 1 of full scale; what is louder is 1."""
    found = number(value)
    return None if found is None or found < 0 else min(1.0, found / FULL_SCALE)


@dataclass(frozen=True, slots=True)
class SoundSource:
    """A sound that was located: `stamp` of the robot's clock tells one from the next; `degrees` to
    the left of the robot's front, -180 to 180.
    """

    stamp: tuple[float, float]
    degrees: float


def sound(value: Any) -> SoundSource | None:
    """`[[s, us], [azimuth, elevation, confidence, energy], head in torso, head in robot]`.

    The azimuth (radians, left is positive) counts from where the head looks, so the head's turn
    (the last of its six coordinates; a Pepper's torso turns with its base) is added.
    """
    stamp = stamped(item(value, 0))
    azimuth = within(item(value, 1, 0), -4 * math.pi, 4 * math.pi)
    if stamp is None or azimuth is None:
        return None
    turn = within(item(value, 2, 5), -math.pi, math.pi)
    around = math.degrees(azimuth + (turn or 0.0))
    return SoundSource(stamp, (around + 180.0) % 360.0 - 180.0)


def stamped(value: Any) -> tuple[float, float] | None:
    """`[seconds, microseconds]`."""
    seconds, micros = number(item(value, 0)), number(item(value, 1))
    return None if seconds is None or micros is None else (seconds, micros)
