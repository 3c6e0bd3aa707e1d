"""The commonest pieces of a JSON Schema."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from woz_tui.core import fields
from woz_tui.core.messages import Json

Schema = dict[str, Any]

TEXT: Schema = {"type": ["string", "number", "boolean"]}
FLAG: Schema = {"enum": [True, False, "yes", "no", "on", "off"]}
NUMBER: Schema = {"type": "number"}
SECONDS: Schema = {
    "oneOf": [
        {"type": "number", "minimum": 0},
        {"type": "string", "pattern": r"^\s*[0-9.]+([eE][-+]?[0-9]+)?\s*(ms|s|sec|min|h)?\s*$"},
    ]
}


def bounds(allowed: fields.Range | None) -> Schema:
    """`minimum` and `maximum`, as far as there are any."""
    if allowed is None:
        return {}
    bounds = {"minimum": allowed.low, "maximum": allowed.high}
    return {name: value for name, value in bounds.items() if value is not None}


def mapping(properties: Schema, required: Iterable[str] = ()) -> Schema:
    """An object with these properties and no others."""
    schema: Schema = {
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
    }
    names = list(required)
    return {**schema, "required": names} if names else schema


def either(schemas: Sequence[Schema]) -> Schema:
    """Any of these; descriptions are left out."""
    different: list[Schema] = []
    for schema in schemas:
        plain: Json = {name: value for name, value in schema.items() if name != "description"}
        if plain not in different and isinstance(plain, dict):
            different.append(plain)
    return different[0] if len(different) == 1 else {"anyOf": different}
