"""Values of the verbs `sense` and `filter`: what a wizard can set a sign to."""

from __future__ import annotations

import math
from collections.abc import Mapping

from woz_tui.config import utterance_template
from woz_tui.config.engagement_words import FILTERS, SIGNS, UNKNOWN
from woz_tui.config.visitor_names import name_of, word_of
from woz_tui.protocol.messages import Json
from woz_tui.protocol.sentence import Sentence, said_by

#: Gives a sign back to its sensor.
SENSOR = "sensor"
_VERDICTS = {"on": True, "off": False}


def sign_value(sign: str, value: str) -> bool | float | str | None:
    """The verdict (True, False), metres, a name, or None for the sensor's own.

    Raises `ValueError` with a sentence for what makes no sense of this sign.
    """
    if value == SENSOR:
        return None
    if sign == "identity":
        if value.strip() and value not in _VERDICTS:
            return value
        raise ValueError(
            Sentence(
                "check.identity_value",
                "identity is a name, {unknown} or {sensor}, not {value!r}",
                unknown=UNKNOWN,
                sensor=SENSOR,
                value=value,
            )
        )
    if value in _VERDICTS:
        return _VERDICTS[value]
    if sign != "distance":
        raise ValueError(
            Sentence(
                "check.sign_value",
                "{sign} is on, off or {sensor}, not {value!r}",
                sign=sign,
                sensor=SENSOR,
                value=value,
            )
        )
    try:
        metres = float(value)
    except ValueError:
        metres = math.nan
    if not (math.isfinite(metres) and metres >= 0):
        raise ValueError(
            Sentence(
                "check.distance_value",
                "distance is on, off, {sensor} or a number of metres, not {value!r}",
                sensor=SENSOR,
                value=value,
            )
        )
    return metres


def identity_of(value: str) -> str:
    """The name that the wizard gives, or "Unknown". Raises `VisitorNameError`."""
    return UNKNOWN if value.strip().casefold() == UNKNOWN.casefold() else name_of(value)


def argument_problem(verb: str, args: Mapping[str, Json]) -> str:
    """Why a call of the engagement model makes no sense, as far as its arguments tell; or empty.

    Values with a variable in them are known only when the call is made.
    """
    if verb == "filter":
        return _filter_problem(args)
    try:
        if verb == "sense":
            sign, value = args.get("sign"), _fixed(args, "value")
            meant = sign_value(sign, value) if isinstance(sign, str) and value is not None else None
            if sign == "identity" and isinstance(meant, str):
                identity_of(meant)
        elif verb in ("handshake", "visitor"):
            code = _fixed(args, "code")
            if code is not None and (code or verb == "visitor"):
                name_of(code)
            for name, what in (
                ("age_group", Sentence("check.age_group", "an age group")),
                ("address", Sentence("check.form_of_address", "a form of address")),
            ):
                word_of(_fixed(args, name) or "", what)
    except ValueError as error:
        return said_by(error)
    return ""


def _fixed(args: Mapping[str, Json], name: str) -> str | None:
    """An argument that is known before the call is made."""
    value = args.get(name)
    return value if isinstance(value, str) and not utterance_template.names(value) else None


def _filter_problem(args: Mapping[str, Json]) -> str:
    sign, kind = args.get("sign"), args.get("kind")
    if sign not in (*SIGNS, "all"):
        return ""
    if kind == "median" and sign == "all":
        return Sentence(
            "check.median_of_all",
            "a median is for distance only: filter: {{sign: distance, kind:"
            " median}}, or take fifo or joint for all",
        )
    if kind == "median" and sign != "distance":
        return Sentence("check.median_of_sign", "a median is for distance; take fifo or joint")
    if not {"kind", "samples", "threshold"} & args.keys():
        return Sentence(
            "check.filter_nothing", "changes nothing; add a kind, samples or a threshold"
        )
    return ""


def without_a_sign(verb: str, text: str) -> str:
    """How to say it where a filter's kind stands in the place of the sign; empty: it does not."""
    if verb != "filter" or text not in FILTERS:
        return ""
    sign = "distance" if text == "median" else "all"
    return Sentence(
        "check.filter_kind",
        "{text!r} is a kind of filter; name the sign: filter: {{sign: {sign}, kind: {text}}}",
        text=text,
        sign=sign,
    )
