"""What a wizard may say of a sign: the values of the verb `sense`, and what of `filter` fits."""

from __future__ import annotations

import math
from collections.abc import Mapping

from woz_tui.core.messages import Json
from woz_tui.experiment import template
from woz_tui.experiment.engagement import SIGNS, UNKNOWN

#: Gives a sign back to its sensor.
SENSOR = "sensor"
_VERDICTS = {"on": True, "off": False}


def sensed(sign: str, value: str) -> bool | float | str | None:
    """The verdict (True, False), metres, a name, or None for the sensor's own.

    Raises `ValueError` with a sentence for what makes no sense of this sign.
    """
    if value == SENSOR:
        return None
    if sign == "identity":
        if value.strip() and value not in _VERDICTS:
            return value
        raise ValueError(f"identity is a name, {UNKNOWN} or {SENSOR}, not {value!r}")
    if value in _VERDICTS:
        return _VERDICTS[value]
    if sign == "distance":
        return _metres(value)
    raise ValueError(f"{sign} is on, off or {SENSOR}, not {value!r}")


def _metres(value: str) -> float:
    try:
        metres = float(value)
    except ValueError:
        metres = math.nan
    if not (math.isfinite(metres) and metres >= 0):
        raise ValueError(f"distance is on, off, {SENSOR} or a number of metres, not {value!r}")
    return metres


def nonsense(verb: str, args: Mapping[str, Json]) -> str:
    """Why a call of the engagement model makes no sense, as far as its arguments tell; or empty.

    Values with a variable in them are known only when the call is made.
    """
    sign, value = args.get("sign"), args.get("value")
    if verb == "sense" and isinstance(sign, str) and isinstance(value, str):
        if template.names(value):
            return ""
        try:
            sensed(sign, value)
        except ValueError as error:
            return str(error)
    if verb == "filter" and sign in SIGNS:
        if args.get("kind") == "median" and sign != "distance":
            return "a median is for distance; take fifo or joint"
        if not {"kind", "samples", "threshold"} & args.keys():
            return "changes nothing; give it a kind, samples or a threshold"
    return ""
