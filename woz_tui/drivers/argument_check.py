"""Checks the arguments of every command against what its verb declares.

Experiment files are checked when they are read, but a program on the socket may send anything,
and a variable's value is known only when the action is played.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from woz_tui.drivers.contract import Argument, Verb
from woz_tui.protocol.messages import Json

#: Longest text that may be said or shown; a runaway program must not fill the log.
MAX_TEXT = 20_000


class ArgumentError(ValueError):
    """An argument is missing, unknown or wrong; the text says which and what is allowed."""


def checked(verb: Verb, args: Mapping[str, Json]) -> dict[str, Json]:
    """`args` with defaults filled in, in the verb's order. Raises `ArgumentError`."""
    known = {argument.name for argument in verb.arguments}
    for name in args:
        if name not in known:
            takes = ", ".join(argument.name for argument in verb.arguments) or "no arguments"
            raise ArgumentError(f"{verb.name} has no argument {name!r}; it takes {takes}")
    result: dict[str, Json] = {}
    for argument in verb.arguments:
        value = args.get(argument.name)
        if value is None:
            if argument.required:
                raise ArgumentError(f"{verb.name} needs {argument.name!r}")
            value = argument.default
        else:
            value = _value(f"{verb.name}.{argument.name}", argument, value)
        if value is not None:
            result[argument.name] = value
    return result


def _value(path: str, argument: Argument, value: Json) -> Json:
    match argument.kind:
        case "text" | "file" | "choice":
            return _text(path, argument, value)
        case "number" | "seconds":
            return _number(path, argument, value)
        case "whole":
            number = _number(path, argument, value)
            if not number.is_integer():
                raise ArgumentError(f"{path} must be a whole number, not {value}")
            return int(number)
        case "flag":
            if not isinstance(value, bool):
                raise ArgumentError(f"{path} must be true or false, not {value!r}")
            return value
        case "joints":
            return _joints(path, argument, value)
        case "poses":
            if not isinstance(value, list) or not value:
                raise ArgumentError(f"{path} must be a list of poses")
            return [_pose(f"{path}[{i}]", argument, pose) for i, pose in enumerate(value)]
        case kind:
            raise ArgumentError(f"{path}: the driver names an unknown kind {kind!r}")


def _text(path: str, argument: Argument, value: Json) -> str:
    if not isinstance(value, str):
        raise ArgumentError(f"{path} must be text, not {type(value).__name__}")
    longest = MAX_TEXT if argument.range is None else argument.range.high or MAX_TEXT
    if len(value) > longest:
        raise ArgumentError(f"{path} is {len(value)} characters long; at most {longest:.0f}")
    if "\0" in value:
        raise ArgumentError(f"{path} contains a NUL character")
    if argument.choices and value not in argument.choices:
        raise ArgumentError(f"{path} must be one of {', '.join(argument.choices)}, not {value!r}")
    return value


def _number(path: str, argument: Argument, value: Json) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ArgumentError(f"{path} must be a number, not {type(value).__name__}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ArgumentError(f"{path} must be a finite number")
    if argument.range is not None and not argument.range.contains(number):
        raise ArgumentError(f"{path} must be {argument.range}, not {number:g}")
    if argument.kind == "seconds" and number < 0:
        raise ArgumentError(f"{path} cannot be negative")
    return number


def _joints(path: str, argument: Argument, value: Json) -> dict[str, Json]:
    if not isinstance(value, dict) or not value:
        raise ArgumentError(f"{path} must map joint names to degrees")
    return {name: _number(f"{path}.{name}", argument, angle) for name, angle in value.items()}


def _pose(path: str, argument: Argument, value: Json) -> dict[str, Json]:
    if not isinstance(value, dict):
        raise ArgumentError(f"{path} must be a pose: joints and seconds")
    unknown = set(value) - {"joints", "seconds"}
    if unknown:
        raise ArgumentError(
            f"{path} has no {sorted(unknown)[0]!r}; a pose has the keys joints and seconds"
        )
    seconds = Argument("seconds", "seconds")
    pose: dict[str, Json] = {"joints": _joints(f"{path}.joints", argument, value.get("joints"))}
    if value.get("seconds") is not None:
        pose["seconds"] = _number(f"{path}.seconds", seconds, value["seconds"])
    return pose
