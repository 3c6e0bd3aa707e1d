"""Messages of ROS as the bridge of the University of Twente writes them: XML with types.

    <data><id type="str">nod1</id><request type="float">0.5</request></data>

Source: HmiRoboUtils of the repository ArticulatedSocialAgentsPlatform/UTRobotics (`xmlutils`,
`docs/protocol.rst`). Its readers take any name for an entry of a tuple; its writer says `e`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final
from xml.etree import ElementTree as Xml

from woz_tui.bridge.xml_elements import parse_xml

#: Deeper nesting is refused.
DEEPEST: Final = 16
#: Beyond this no whole number of ROS goes, to both sides.
_WHOLE: Final = 1 << 63


class RosDataError(ValueError):
    """The message cannot be read, or is not of its topic's type; the text says why."""


@dataclass(frozen=True, slots=True)
class RosTime:
    """A moment or a length of time."""

    seconds: int = 0
    nanoseconds: int = 0


RosValue = (
    float | int | bool | str | RosTime | None | tuple["RosValue", ...] | dict[str, "RosValue"]
)
#: What a field is: float, int, bool, str or time; a list of one of them; fields of its own.
RosType = str | list["RosType"] | dict[str, "RosType"]
#: Type in a table -> the value of a field that a message leaves out.
EMPTY: Final[Mapping[str, RosValue]] = {
    **{"float": 0.0, "int": 0, "bool": False, "str": "", "time": RosTime()},
}


def parse_element(text: str) -> Xml.Element:
    """The root of an XML text of a stranger. Raises `RosDataError`."""
    try:
        return parse_xml(text, "a message")
    except ValueError as error:
        raise RosDataError(str(error)) from error


def read_data(text: str) -> dict[str, RosValue]:
    """The fields of a message. Raises `RosDataError`."""
    return read_fields(parse_element(text))


def read_fields(root: Xml.Element) -> dict[str, RosValue]:
    """The fields in an element. Raises `RosDataError`."""
    return {_name(child): _value(child, _name(child), 1) for child in root}


def _name(element: Xml.Element) -> str:
    """Without a namespace: inside a block of BML there may be one around."""
    return str(element.tag).rpartition("}")[2]


def _value(element: Xml.Element, path: str, depth: int) -> RosValue:
    if depth > DEEPEST:
        raise RosDataError(f"{path[:60]} is nested too deeply")
    kind, text = element.get("type", "str").strip().lower(), element.text or ""
    try:
        match kind:
            case "float":
                return float(text)
            case "int":
                return _whole(text)
            case "bool":
                return text.strip() == "True"
            case "str":
                return text
            case "null":
                return None
            case "time":
                seconds, nanoseconds = map(_whole, text.split())
                return RosTime(seconds, nanoseconds)
            case "tuple":
                return tuple(
                    _value(child, f"{path}.{at}", depth + 1) for at, child in enumerate(element)
                )
            case "dict" | "struct":  # the protocol's page says struct, the program dict
                return {
                    _name(child): _value(child, f"{path}.{_name(child)}", depth + 1)
                    for child in element
                }
    except RosDataError:
        raise
    except ValueError:
        raise RosDataError(f"{path} is no {kind}: {text.strip()[:40]!r}") from None
    raise RosDataError(f"{path} has the unknown type {kind[:40]!r}")


def _whole(text: str) -> int:
    number = int(text)
    if abs(number) >= _WHOLE:
        raise ValueError(text)
    return number


def write_data(fields: Mapping[str, RosValue]) -> str:
    """A message with these fields, as the bridge's own program writes it."""
    root = Xml.Element("data")
    add_fields(root, fields)
    return Xml.tostring(root, "unicode")


def add_fields(parent: Xml.Element, fields: Mapping[str, RosValue]) -> None:
    """The fields as elements in `parent`."""
    for name, value in fields.items():
        _add(parent, name, value)


def _add(parent: Xml.Element, name: str, value: RosValue) -> None:
    element = Xml.SubElement(parent, name)
    match value:
        case bool() | int() | float() | str():
            element.set("type", type(value).__name__)
            element.text = str(value)
        case None:
            element.set("type", "null")
        case RosTime():
            element.set("type", "time")
            element.text = f"{value.seconds} {value.nanoseconds}"
        case tuple():
            element.set("type", "tuple")
            for entry in value:
                _add(element, "e", entry)
        case _:
            element.set("type", "dict")
            add_fields(element, value)


def typed(fields: Mapping[str, RosValue], types: Mapping[str, RosType]) -> dict[str, RosValue]:
    """A message as its topic has it: what it leaves out is empty. Raises `RosDataError` where a
    field is unknown or of another type.
    """
    for name in fields:
        if name not in types:
            raise RosDataError(f"{name[:40]} is no field; they are {', '.join(types)}")
    return {
        name: _typed(fields[name], kind, name) if name in fields else empty(kind)
        for name, kind in types.items()
    }


def empty(kind: RosType) -> RosValue:
    """The value of a field that is left out."""
    if isinstance(kind, str):
        return EMPTY[kind]
    return () if isinstance(kind, list) else {name: empty(inner) for name, inner in kind.items()}


def _typed(value: RosValue, kind: RosType, path: str) -> RosValue:
    match kind, value:
        case _, None:
            return empty(kind)
        case [inner], tuple():
            return tuple(_typed(each, inner, f"{path}.{at}") for at, each in enumerate(value))
        case dict(), dict():
            return typed(value, kind)
        case ("float", int() | float()) if math.isfinite(value):
            return float(value)
        case ("int", int() | float()) if not value % 1:
            return int(value)
        case ("bool", bool()) | ("str", str()) | ("time", RosTime()):
            return value
        case ("bool", 0 | 1):
            return bool(value)
    wanted = kind if isinstance(kind, str) else "list" if isinstance(kind, list) else "dict"
    raise RosDataError(f"{path} is no {wanted}: {str(value)[:40]!r}")
