"""A log in which every text of every kind of message is a secret of its own."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
from msgspec import inspect

from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.kinds import message_kinds

KINDS: list[type[m.Message]] = [
    kind
    for kind in message_kinds()
    if kind is not m.Segment  # belongs to a file, not to the session
]


class Secrets:
    """`told` has each secret and where it was told: the kind and the field, with what is inside."""

    def __init__(self) -> None:
        self.told: dict[str, tuple[str, str]] = {}

    def line(self, kind: type[m.Message], number: int) -> dict[str, Any]:
        """A line of this kind, full of secrets."""
        info = inspect.type_info(kind)
        assert isinstance(info, inspect.StructType)
        tag = str(info.tag)
        fields = {
            field.encode_name: self._value(field.type, tag, field.encode_name)
            for field in info.fields
        }
        fixed = {"kind": tag, "seq": number, "t": number * 1_000_000}
        if "schema" in fields:
            fixed |= {"format": m.FORMAT, "schema": m.SCHEMA}
        return fields | fixed

    def secret(self, kind: str, path: str) -> str:
        """A sentence that nobody must read, with everything in it that some format escapes."""
        token = f"Secret{len(self.told):04d}x"
        self.told[token] = (kind, path)
        return f"Ms {token} & <co>"

    def _value(self, of: inspect.Type, kind: str, path: str) -> Any:
        plain: dict[type[inspect.Type], Any] = {
            inspect.BoolType: True,
            inspect.IntType: 3,
            inspect.FloatType: 1.5,
        }
        if type(of) in plain:
            return plain[type(of)]
        return self._words(of, kind, path)

    def _words(self, of: inspect.Type, kind: str, path: str) -> Any:
        value: Any = None
        match of:
            case inspect.StrType():
                value = self.secret(kind, path)
            case inspect.ListType(item_type=item) | inspect.VarTupleType(item_type=item):
                value = [self._value(item, kind, path), self._value(item, kind, path)]
            case inspect.TupleType(item_types=items):
                value = [self._value(item, kind, path) for item in items]
            case inspect.DictType(value_type=inner):
                value = {
                    self.secret(kind, f"{path}{{}}"): self._value(inner, kind, path),
                    "plain": self._value(inner, kind, f"{path}.plain"),
                }
            case inspect.StructType(fields=fields):
                value = {
                    each.encode_name: self._value(each.type, kind, f"{path}.{each.encode_name}")
                    for each in fields
                }
            case inspect.UnionType(types=types):
                value = self._value(self._wordiest(types), kind, path)
            case inspect.AnyType():
                value = [self.secret(kind, path), {"plain": self.secret(kind, f"{path}.plain")}]
            case _:
                raise AssertionError(f"{kind}.{path}: what is {of}?")
        return value

    def _wordiest(self, types: tuple[inspect.Type, ...]) -> inspect.Type:
        """Of what a field may be, that which holds most words."""
        order = (inspect.DictType, inspect.ListType, inspect.StructType, inspect.StrType)
        for wanted in order:
            for each in types:
                if isinstance(each, wanted):
                    return each
        return next(each for each in types if not isinstance(each, inspect.NoneType))

    def leaked(self, content: str) -> set[tuple[str, str]]:
        """Where the secrets that stand in `content` were told."""
        return {where for token, where in self.told.items() if token in content}


def strange_lines(secrets: Secrets, number: int) -> Iterator[dict[str, Any]]:
    """What a later version, or an accident, could have written."""
    where = ("strange", "anything")
    yield {
        "kind": "robot.dreamt",
        "seq": number,
        "t": number * 1_000_000,
        "text": secrets.secret(*where),
        "deep": {secrets.secret(*where): [{"plain": secrets.secret(*where)}]},
        secrets.secret(*where): 1,
    }
    yield {
        "kind": "note",
        "seq": number + 1,
        "t": (number + 1) * 1_000_000,
        "text": {"not": secrets.secret(*where)},
        "action": {"an": [secrets.secret(*where)]},
        "future": secrets.secret(*where),
    }


def write(folder: Path, secrets: Secrets) -> Path:
    """The log; each line but the strange ones is one that this version understands."""
    lines = [secrets.line(kind, number) for number, kind in enumerate(KINDS)]
    for line in lines:
        codec.decode_message(json.dumps(line).encode())
    lines += strange_lines(secrets, len(lines))
    folder.mkdir()
    log = folder / "2026-03-01T10-00-00_P07_S01.jsonl"
    log.write_bytes(b"".join(msgspec.json.encode(line) + b"\n" for line in lines))
    return log
