"""Lines of text with a distance in them, as people print them from an Arduino."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from woz_drivers.lines.line_decoder import LineError

#: So many characters of a line are quoted.
_QUOTED = 40
_UNITS = {"mm": "mm", "cm": "cm", "m": "m", "in": "in", "inch": "in", "inches": "in", '"': "in"}
_SEVERAL = "say which is the distance with `column`, or print that one alone"

#: A number and what is written onto it; where a colon follows, it is one of a label: `sensor 1: 9`.
_NUMBER = re.compile(
    r"(?<![\w.])(?<!\w[+-])(?P<number>[+-]?\d{1,7}(?:\.\d{1,6})?)(?P<decimals>,\d{1,6})?"
    r"(?: *(?P<unit>\"|[^\W\d_]+))?(?P<rest>[^\s,;:=(){}\[\]\"']*)(?P<label> *[:=])?"
)
#: `Distance (cm):`, `dist_mm=`, `distance in cm`
_LABELLED = re.compile(r"(?:[(\[] *|_|\bin )(mm|cm|m|in|inch|inches)(?![^\W_])", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class WrittenNumber:
    """A number of a line, and the unit that it is written with, if any; `name`: of its field.

    `foreign`: how it is written, where it is no distance, such as `22 C`.
    """

    value: float
    unit: str = ""
    name: str = ""
    foreign: str = ""


def distance_in(line: bytes, column: int) -> WrittenNumber:
    """The distance of a line; `column`: which number it is, from 1, where there are several.

    Raises `LineError`.
    """
    text = _readable(line)
    numbers = _of_object(text) if text.startswith("{") else [*_of_text(text, bool(column))]
    if column:
        if len(numbers) < column:
            raise LineError(f"{_quoted(text)} has no number {column}", "correct `column`")
    elif not numbers:
        raise LineError(f"{_quoted(text)} has no distance in it", "have it print the number alone")
    elif len(numbers) > 1:
        raise LineError(f"{_quoted(text)} has several numbers", _SEVERAL)
    chosen = numbers[max(column, 1) - 1]
    if chosen.foreign:
        raise LineError(f"{_quoted(text)}: {chosen.foreign!r} is no distance", _SEVERAL)
    return chosen


def _readable(line: bytes) -> str:
    try:
        text = line.decode().replace("\t", " ").strip()
    except UnicodeDecodeError:
        text = line.decode("latin-1").replace("\t", " ").strip()
        text = text if all(sign.isascii() or sign.isalpha() for sign in text) else "\0"
    if not text.isprintable():
        raise LineError(f"what comes is no text: {line[:16]!r}", "check framing and baud")
    return text


def _of_text(text: str, in_columns: bool) -> Iterator[WrittenNumber]:
    labelled = [*_LABELLED.finditer(text)]
    for found in _NUMBER.finditer(text):
        if found["label"]:
            continue
        number, decimals, word = found["number"], found["decimals"] or "", found["unit"] or ""
        unit = _UNITS.get(word.lower(), "")
        if found["rest"] not in (("", ".") if unit else ("",)) or (word and not unit):
            yield WrittenNumber(float(number), foreign=found[0].strip())
            continue
        if decimals and in_columns and not unit:
            yield WrittenNumber(float(number))
            number = decimals[1:]
        elif decimals and not unit:
            what = f"{_quoted(text)} may be two numbers, or one with a decimal comma"
            raise LineError(what, f"{_SEVERAL}; or print a point, or its unit")
        elif decimals:
            number += decimals.replace(",", ".")
        before = [_UNITS[one[1].lower()] for one in labelled if one.end() <= found.start()]
        yield WrittenNumber(float(number), unit or (before[-1] if before else ""))


def _of_object(text: str) -> list[WrittenNumber]:
    """The numbers of a JSON object; the one that is called a distance alone, if there is one."""
    try:
        fields: dict[str, Any] = json.loads(text)
    except (ValueError, RecursionError):
        raise LineError(f"{_quoted(text)} is not the whole of an object", _SEVERAL) from None
    word = next((one for name, one in fields.items() if name.lower() in ("unit", "units")), "")
    found = []
    for name, value in fields.items():
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            continue
        with_unit = _LABELLED.search(name)
        unit = _UNITS.get(with_unit[1] if with_unit else str(word).lower(), "")
        if isinstance(value, str):
            found += [
                WrittenNumber(one.value, one.unit or unit, name) for one in _numbers_in(value)
            ]
        else:
            found.append(WrittenNumber(float(value), unit, name))
    called = [one for one in found if re.match("dist|range", one.name, re.IGNORECASE)]
    return called if len(called) == 1 else found


def _numbers_in(text: str) -> list[WrittenNumber]:
    try:
        found = [*_of_text(text, in_columns=False)]
    except LineError:  # a text of another field, such as a name
        return []
    return [] if any(one.foreign for one in found) else found


def _quoted(text: str) -> str:
    return repr(text if len(text) <= _QUOTED else f"{text[:_QUOTED]}...")
