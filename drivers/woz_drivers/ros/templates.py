"""Messages with places for a verb's arguments, and paths to a value in a message that came.

A template is what a robot file writes as `message`: a mapping with texts such as `{text}`. A text
that is one placeholder becomes the argument's value itself, within other text it is written out.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from woz_drivers.ros.laser_scans import DISTANCES, directions, is_echo, lies_within, toward
from woz_tui.protocol.messages import Json

_PLACEHOLDER = re.compile(
    r"\{(?P<minus>-)?(?P<name>[a-z][a-z0-9_]*)(?:\*(?P<factor>\d+(?:\.\d+)?))?(?::(?P<how>\w+))?\}"
)
#: Stands for a field that is left out because its argument was not given.
_ABSENT = object()


class TemplateError(Exception):
    """A placeholder or a path that is not understood, or a value that does not fit it."""


def _duration(seconds: Any) -> dict[str, int]:
    whole = math.floor(_number(seconds))
    # Both servers take these names of ROS 1; that of ROS 1 takes no others.
    return {"secs": whole, "nsecs": round((_number(seconds) - whole) * 1e9)}


def _channel(at: int, full: int) -> Callable[[Any], float]:
    def part(color: Any) -> float:
        if not isinstance(color, str) or not re.fullmatch("#[0-9a-fA-F]{6}", color):
            raise TemplateError(f"{color!r} is no colour")
        value = int(color[at : at + 2], 16)
        return value if full == 255 else round(value / 255, 3)

    return part


def _joints(value: Any) -> dict[str, float]:
    if not isinstance(value, dict):
        raise TemplateError(f"{value!r} is no pose")
    return value


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TemplateError(f"{value!r} is no number")
    return float(value)


def _radians(value: Any) -> float | list[float]:
    if isinstance(value, dict):
        return [round(math.radians(angle), 6) for angle in value.values()]
    return round(math.radians(_number(value)), 6)


#: What may stand behind the colon, and what it makes of the value.
FORMATS: Mapping[str, Callable[[Any], Any]] = {
    "rad": _radians,  # degrees to radians; of a pose: the list of its angles
    "deg": lambda value: [*_joints(value).values()] if isinstance(value, dict) else _number(value),
    "names": lambda value: [*_joints(value)],  # of a pose: its joints, in the same order
    "whole": lambda value: round(_number(value)),
    "duration": _duration,  # seconds as a duration of ROS
    # Of a colour: 0 to 1, and 0 to 255.
    **{name: _channel(at, 1) for name, at in (("red", 1), ("green", 3), ("blue", 5))},
    **{name: _channel(at, 255) for name, at in (("red255", 1), ("green255", 3), ("blue255", 5))},
}


def placeholders(template: Any, path: str = "") -> Iterator[tuple[str, str, str]]:
    """Where each placeholder stands, the argument that it names, and its format."""
    if isinstance(template, dict):
        for name, inner in template.items():
            yield from placeholders(inner, f"{path}.{name}" if path else name)
    elif isinstance(template, list):
        for at, inner in enumerate(template):
            yield from placeholders(inner, f"{path}[{at}]")
    elif isinstance(template, str):
        rest = _PLACEHOLDER.sub("", template)
        if "{" in rest or "}" in rest:
            raise TemplateError(f"{template!r} is no placeholder: write {{name}} or {{name:rad}}")
        for found in _PLACEHOLDER.finditer(template):
            yield path, found["name"], found["how"] or ""


def fill(template: Any, values: Mapping[str, Any]) -> Json:
    """The message with the values in their places. A field whose argument is None is left out.

    Raises `TemplateError`.
    """
    filled: Json = _filled(template, values)
    return {} if filled is _ABSENT else filled


def _filled(template: Any, values: Mapping[str, Any]) -> Any:
    if isinstance(template, dict):
        inner = {name: _filled(part, values) for name, part in template.items()}
        return {name: value for name, value in inner.items() if value is not _ABSENT}
    if isinstance(template, list):
        items = [_filled(part, values) for part in template]
        return [item for item in items if item is not _ABSENT]
    if not isinstance(template, str):
        return template
    alone = _PLACEHOLDER.fullmatch(template)
    if alone is not None:
        value = _value(alone, values)
        return _ABSENT if value is None else value
    return _PLACEHOLDER.sub(lambda found: _written(_value(found, values)), template)


def _written(value: Any) -> str:
    return "" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def _value(found: re.Match[str], values: Mapping[str, Any]) -> Any:
    if found["name"] not in values:
        raise TemplateError(f"there is no argument {found['name']!r}")
    value = values[found["name"]]
    if value is None:
        return None
    if found["minus"] or found["factor"]:
        value = _number(value) * float(found["factor"] or 1) * (-1 if found["minus"] else 1)
    how = found["how"]
    if not how:
        return value
    if how not in FORMATS:
        raise TemplateError(f"there is no format {how!r}: there are {', '.join(FORMATS)}")
    return FORMATS[how](value)


# -- values of messages that came ------------------------------------------------------------------

_DEGREES = r"[+-]?\d+(?:\.\d+)?(?= *(?:deg|°))"
_STEP = re.compile(
    r"(?P<name>[A-Za-z_]\w*)"
    r"(?:\[(?:(?P<first>-?\d+)?(?P<colon>:)(?P<last>-?\d+)?|(?P<at>-?\d+)|(?P<key>\w+)=(?P<is>[^\]]+)"
    rf"|(?P<from>{_DEGREES}) *(?:deg|°):(?P<to>{_DEGREES}) *(?:deg|°)"
    rf"|(?P<toward>{_DEGREES}) *(?:deg|°))\])?"
)
_OF_LIST: Mapping[str, Callable[[Sequence[float]], float | None]] = {
    "min": lambda numbers: min(numbers, default=None),
    "max": lambda numbers: max(numbers, default=None),
    "mean": lambda numbers: sum(numbers) / len(numbers) if numbers else None,
}
FUNCTIONS = (*_OF_LIST, "count")


@dataclass(frozen=True, slots=True)
class ValuePath:
    """`twist.twist.linear.x`, `points[0]`, `min(ranges[-15deg:15deg])`, `position[name=head_pan]`.

    With degrees a slice is what a scan sees from the first direction to the left as far as the
    last; 0 is the robot's front. By index a slice whose first is negative and whose last is not
    goes round the end of the list. `position[name=head_pan]` is the entry of `position` at the
    place at which `name` beside it has head_pan. `function`: one of `FUNCTIONS`, or empty.
    `mounted`: see `laser_scans.directions`.
    """

    steps: tuple[re.Match[str], ...]
    function: str = ""
    mounted: float = 0.0

    @classmethod
    def parse(cls, text: str, mounted: float = 0.0) -> ValuePath:
        """Read a path. Raises `TemplateError`."""
        called = re.fullmatch(rf"({'|'.join(FUNCTIONS)})\((.+)\)", text)
        function, inner = called.groups() if called else ("", text)
        steps = [_STEP.fullmatch(part) for part in re.split(r"\.(?![^\[]*\])", inner)]
        if not all(steps):
            raise TemplateError(
                f"{text!r} is no path: write field.field, min(field[0:10]),"
                " or of a scan min(ranges[-15deg:15deg])"
            )
        return cls(tuple(step for step in steps if step is not None), function, mounted)

    def of(self, message: Any) -> Any:
        """The value: a number, a text, true or false; None where the message has none."""
        found, holder = message, message
        for step in self.steps:
            holder = found
            if not isinstance(holder, dict):
                return None
            found = self._indexed(step, holder, holder.get(step["name"]))
        if not self.function:
            if self.steps[-1]["name"] in DISTANCES and not is_echo(found, holder):
                return None
            return found if isinstance(found, int | float | str) else None
        if not isinstance(found, list):
            return None
        if self.function == "count":
            return len(found)
        return _OF_LIST[self.function]([item for item in found if is_echo(item, holder)])

    def directions_of(self, scan: Mapping[str, Any]) -> list[float]:
        """Where it looks in this scan, in degrees; nothing if that cannot be said."""
        ranges = scan.get("ranges")
        there = directions(scan, len(ranges), self.mounted) if isinstance(ranges, list) else None
        if there is None or [step["name"] for step in self.steps] != ["ranges"]:
            return []
        looked = self._indexed(self.steps[0], scan, there)
        return looked if isinstance(looked, list) else [looked] if looked is not None else []

    def _indexed(self, step: re.Match[str], holder: Mapping[str, Any], found: Any) -> Any:
        if not isinstance(found, list):
            return found if step[0] == step["name"] else None
        if step["from"] or step["toward"]:
            return self._seen(step, holder, found)
        if step["colon"]:
            first = None if step["first"] is None else int(step["first"])
            last = None if step["last"] is None else int(step["last"])
            round_the_end = first is not None and first < 0 and last is not None and last >= 0
            return found[first:] + found[:last] if round_the_end else found[first:last]
        if step["key"]:
            keys = holder.get(step["key"])
            if not isinstance(keys, list) or step["is"] not in keys:
                return None
            at = keys.index(step["is"])
        elif step["at"]:
            at = int(step["at"])
        else:
            return found
        return found[at] if -len(found) <= at < len(found) else None

    def _seen(self, step: re.Match[str], scan: Mapping[str, Any], found: list[Any]) -> Any:
        """What a scan has in one direction, or between two."""
        there = directions(scan, len(found), self.mounted)
        if there is None:
            return None
        if step["from"]:
            contains = lies_within(float(step["from"]), float(step["to"]))
            return [item for item, way in zip(found, there, strict=True) if contains(way)]
        at = toward(float(step["toward"]), there, math.degrees(scan["angle_increment"]))
        return None if at is None else found[at]
