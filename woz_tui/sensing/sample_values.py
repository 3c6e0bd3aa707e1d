"""Reads raw values of sensors, whatever they are; None stands for "says nothing".

The paper does not say what becomes of a missing or an impossible value. Here it is no evidence,
neither for nor against: it takes no place in a queue. Nothing in here ever raises.
"""

from __future__ import annotations

import math
from functools import lru_cache

from woz_tui.config.visitor_names import VisitorNameError, label_of

#: The identity of a face that the recogniser does not know.
UNKNOWN = "Unknown"
#: Numbers that JSON has no notation for, as lines of samples spell them.
SPELT = {"NaN": math.nan, "Infinity": math.inf, "-Infinity": -math.inf}
#: Whole numbers are no larger than this, so that each fits into a float.
_LARGEST = 10**300
#: A label is looked at up to here at all, in characters.
_READABLE = 1000


def number(value: object) -> float | None:
    """A number, also infinite, NaN or spelt in words; None for everything else, also for a bool."""
    if isinstance(value, float):
        return value
    if isinstance(value, bool):
        return None
    if isinstance(value, int):
        return float(max(-_LARGEST, min(value, _LARGEST)))
    return SPELT.get(value) if isinstance(value, str) else None


def presence(value: object) -> bool | None:
    """Whether somebody is there: a truth value, or a number such as a count of faces; any above
    zero is somebody.
    """
    amount = _amount(value)
    return None if amount is None else amount > 0.0


def gaze(value: object) -> bool | None:
    """Whether somebody looks: a truth value, a share from 0 to 1 of which one half is yes, or a
    count of those who look.
    """
    amount = _amount(value)
    return None if amount is None else amount >= 0.5


#: How the signs that are yes or no are read.
FLAGS = {"presence": presence, "gaze": gaze}


def percent(share: float) -> str:
    """A share of 0 to 1 as it stands everywhere on the screen: `87 %`."""
    return f"{100 * share:.0f} %"


def is_share(name: str, value: float, unit: str) -> bool:
    """Whether a figure is a battery's charge as drivers give it, 0 to 1 without a unit: people know
    it in percent. The battery of one robot of several has its name in front: `left.battery`.
    """
    return name.rpartition(".")[2] == "battery" and not unit and 0.0 <= value <= 1.0


#: What a sensor of two states says, at 0 and at 1, by a word of its name.
_STATES = {
    "touch": ("free", "touched"),
    "bumper": ("free", "pressed"),
    "button": ("free", "pressed"),
    "fallen": ("no", "yes"),
}


def state_word(name: str, value: float) -> str:
    """What a robot feels, in a word: `pressed` for a bumper's 1; empty: it is no such sensor."""
    parts = name.split(".")
    found = (_STATES[part] for part in parts if part in _STATES and parts[-1] not in ("x", "y"))
    states = next(found, None) if value in (0.0, 1.0) else None
    return states[int(value)] if states is not None else ""


def _amount(value: object) -> float | None:
    found = float(value) if isinstance(value, bool) else number(value)
    return found if found is not None and 0.0 <= found < math.inf else None


def metres(value: object, farthest: float) -> float | None:
    """A distance; beyond the sensor's reach, or infinite, is far: infinite metres.

    Nothing and less is no measurement. The least that a sonar can say (0.30 m on Pepper) is near
    like any other small distance.
    """
    distance = number(value)
    if distance is None or math.isnan(distance) or distance <= 0.0:
        return None
    return distance if distance <= farthest else math.inf


def name(value: object, text: str = "") -> str | None:
    """An identity: the recogniser's label in `text` or `value`, or "Unknown".

    A number beside an empty text is a score for nobody: "Unknown". The spelt numbers are no names,
    and neither is what nobody could read.
    """
    if not text:
        if not isinstance(value, str):
            score = number(value)
            return None if score is None or math.isnan(score) else UNKNOWN
        text = value
    if text in SPELT or len(text) > _READABLE:
        return None
    return _label(text)


def level(value: object, threshold: float) -> float | None:
    """A chunk's loudness (RMS). NaN is a chunk, and a quiet one.

    Above 1, full scale, only where the threshold is on another scale too; never negative.
    """
    rms = number(value)
    if rms is None:
        return None
    if math.isnan(rms):
        return 0.0
    return rms if 0.0 <= rms <= 1.0 or (threshold > 1.0 and 0.0 <= rms < math.inf) else None


def absent(value: object) -> bool:
    """Whether a value that says nothing is an honest "nothing": null or NaN."""
    found = number(value)
    return value is None or (found is not None and math.isnan(found))


@lru_cache(maxsize=256)
def _label(text: str) -> str | None:
    if not text.strip():
        return UNKNOWN
    try:
        label = label_of(text)
    except VisitorNameError:
        return None
    return UNKNOWN if label.casefold() == UNKNOWN.casefold() else label


# -- texts so far ----------------------------------------------------------------------------------


def agreed(before: str, now: str) -> str:
    """The beginning of a text so far on which it agrees with the one before, in whole words: what
    is not likely to be taken back (LocalAgreement-2). The last word of either may be half a word.
    """
    same = 0
    words = now.split()
    for one, other in zip(before.split(), words, strict=False):
        if _letters(one) != _letters(other):
            break
        same += 1
    return " ".join(words[:same])


def _letters(word: str) -> str:
    return "".join(letter for letter in word.casefold() if letter.isalnum())


# -- distance: Hall's spaces around a person -------------------------------------------------------
# E. T. Hall, The Hidden Dimension (1966), chapter X; his inches and feet in metres, rounded as
# usual. On a border a distance belongs to the space beyond.

#: Where intimate, personal and social space end, in metres (18 inches, 4 and 12 feet); beyond is
#: public.
ZONES = ((0.45, "intimate"), (1.2, "personal"), (3.6, "social"))
PUBLIC = "public"


def zone(metres: float) -> str:
    """The space at a distance; infinitely far is public too. Nothing (empty) for NaN."""
    if math.isnan(metres):
        return ""
    return next((name for limit, name in ZONES if metres < limit), PUBLIC)
