"""Types of ROS messages as a robot has them: empty messages, what fits, definitions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Message = dict[str, Any]


def plain(name: str) -> str:
    """A type's name without `msg`, `srv` or `action` in its middle."""
    parts = name.split("/")
    return "/".join((parts[0], parts[-1]))


class MisfitError(Exception):
    """A message does not fit its type."""


class SimulatedTypes:
    """Fields by type, and how the messages of ROS 1 or 2 are written."""

    def __init__(self, types: Mapping[str, Mapping[str, str]], ros: int) -> None:
        self._types = types
        self._ros = ros

    def fields(self, kind: str) -> Mapping[str, str]:
        """Of a type; none of one that is not known."""
        return self._types.get(plain(kind), {})

    def empty(self, kind: str) -> Message:
        """A message of this type with nothing in it."""
        return {name: self.default(type_) for name, type_ in self.fields(kind).items()}

    def default(self, kind: str) -> Any:
        """The value of a field in an empty message."""
        base, listed, length = kind.partition("[")
        if listed:
            count = int(length[:-1] or 0)
            return [self.default(base) for _ in range(count)]
        if base in ("time", "duration"):
            return {"secs": 0, "nsecs": 0} if self._ros == 1 else {"sec": 0, "nanosec": 0}
        if "/" in base:
            return self.empty(base)
        return "" if base == "string" else False if base in ("bool", "boolean") else 0

    def fit(self, message: Any, kind: str, path: str = "") -> None:
        """Raise MisfitError if a message does not fit its type."""
        base, listed, _ = kind.partition("[")
        if listed:
            if not isinstance(message, list):
                raise MisfitError(f"requires a {kind} for field {path}")
            for item in message:
                self.fit(item, base, path)
        elif base in ("time", "duration"):
            return
        elif "/" in base:
            fields = self._types.get(plain(base))
            if fields is None:
                raise MisfitError(f"Unable to import {base}")
            if not isinstance(message, dict):
                raise MisfitError(f"Expected a JSON object for type {base}")
            for name, value in message.items():
                if name not in fields:
                    raise MisfitError(f"Message type {base} does not have a field {path}{name}")
                self.fit(value, fields[name], f"{path}{name}.")
        elif not _is(message, base):
            raise MisfitError(f"requires a {base} for field {path}, but got a {type(message)}")

    def definition(self, kind: str) -> str:
        """The text of a type and of all within it."""
        text, seen, left = "", set[str](), [plain(kind)]
        while left:
            name = left.pop(0)
            fields = self._types.get(name)
            if fields is None or name in seen:
                continue
            text += f"\n{'=' * 80}\nMSG: {name}\n" if seen else ""
            seen.add(name)
            text += "".join(f"{type_} {field_}  # a field\n" for field_, type_ in fields.items())
            left += [type_.partition("[")[0] for type_ in fields.values() if "/" in type_]
        return text

    def typedefs(self, kind: str) -> list[Message]:
        """A type and all within it, as rosapi tells them."""
        found: list[Message] = []
        left = [plain(kind)]
        while left:
            name = left.pop(0)
            fields = self._types.get(name)
            if fields is None or any(each["type"] == name for each in found):
                continue
            types = [type_.partition("[")[0] for type_ in fields.values()]
            lengths = [
                -1 if "[" not in type_ else int(type_.partition("[")[2][:-1] or 0)
                for type_ in fields.values()
            ]
            found.append(
                {
                    "type": name,
                    "fieldnames": [*fields],
                    "fieldtypes": types,
                    "fieldarraylen": lengths,
                }
            )
            left += [type_ for type_ in types if "/" in type_]
        return found


def _is(value: Any, kind: str) -> bool:
    if kind in ("bool", "boolean"):
        return isinstance(value, bool)
    if kind in ("string", "wstring"):
        return isinstance(value, str)
    if isinstance(value, bool):
        return False
    return (
        isinstance(value, int | float)
        if kind.startswith(("float", "double"))
        else isinstance(value, int)
    )
