"""JSON Schema of settings, from the same annotations by which `settings` decodes them."""

from __future__ import annotations

import dataclasses
import enum
import pathlib
import types
import typing
from collections.abc import Mapping, Sequence
from typing import Any, Literal

from woz_tui.core import fields
from woz_tui.experiment.schema_parts import FLAG, SECONDS, TEXT, Schema, bounds, either, mapping
from woz_tui.experiment.settings import fields_of, note, split


def settings_schema(shape: type) -> Schema:
    """The schema of a dataclass of settings, as files give them."""
    properties = {}
    for item in fields_of(shape):
        schema = _type(item.annotation)
        if item.doc:
            schema = {**schema, "description": item.doc}
        default = item.default
        if isinstance(default, str | int | float | bool) and default != "":
            schema = {**schema, "default": default}
        properties[item.name] = schema
    return mapping(properties, required=required(shape))


def required(shape: type) -> tuple[str, ...]:
    """The names of settings that may not be left out."""
    return tuple(item.name for item in fields_of(shape) if item.required)


def _type(annotation: Any, notes: tuple[Any, ...] = ()) -> Schema:
    bare, own = split(annotation)
    notes = (*own, *notes)
    origin = typing.get_origin(bare) or bare
    if origin in (typing.Union, types.UnionType):
        return either([_type(kind, notes) for kind in typing.get_args(bare)])
    if origin is Literal:
        return {"enum": [str(word) for word in typing.get_args(bare)]}
    if origin in (tuple, list, Sequence):
        inner = typing.get_args(bare) or (Any,)
        return {"type": "array", "items": either([_type(k, notes) for k in inner if k is not ...])}
    if origin in (dict, Mapping):
        inner = typing.get_args(bare) or (str, Any)
        return {"type": "object", "additionalProperties": _type(inner[1], notes)}
    if dataclasses.is_dataclass(origin) and isinstance(origin, type):
        return settings_schema(origin)
    return _simple(bare, notes)


def _simple(bare: Any, notes: tuple[Any, ...]) -> Schema:
    if isinstance(bare, type) and issubclass(bare, enum.Enum):
        return {"enum": [str(member.value) for member in bare]}
    if (one_of := note(notes, fields.OneOf)) is not None and bare is str:
        return {"enum": list(one_of.choices)}
    if note(notes, fields.Seconds) is not None and bare is float:
        return SECONDS
    if bare in (int, float) and bare is not bool:
        kind = "integer" if bare is int else "number"
        return {"type": kind, **bounds(note(notes, fields.Range))}
    if isinstance(bare, type) and issubclass(bare, pathlib.Path):
        return {"type": "string"}
    return {bool: FLAG, str: TEXT, type(None): {"type": "null"}}.get(bare, {})
