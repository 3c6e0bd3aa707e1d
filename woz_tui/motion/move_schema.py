"""JSON Schema (draft 2020-12) of move files, so that editors complete and warn.

It takes more than the reader does: which joints there are only a robot file says.
"""

from __future__ import annotations

from woz_tui.config.json_schema import NUMBER, Schema, bounds, mapping, settings_schema
from woz_tui.motion.body_shape import ROLES
from woz_tui.motion.move_files import (
    ANGLES,
    FEATURE_RANGES,
    LENGTHS,
    NAME,
    FrameEntry,
    LayerEntry,
    MoveEntry,
)

_ANGLE: Schema = {**NUMBER, **bounds(ANGLES)}
_LENGTH: Schema = {**NUMBER, **bounds(LENGTHS)}
_TIME: Schema = {"oneOf": [_LENGTH, {"type": "string", "pattern": r"^\s*[0-9.]+\s*(ms|s)?$"}]}


def move_schema() -> Schema:
    """The schema of move files."""
    frames: Schema = {"$ref": "#/$defs/frames"}
    name = {
        "type": "string",
        "pattern": f"^{NAME.pattern}$",
        "description": "what play calls it by (default: the file's name)",
    }
    layers = {
        "type": "array",
        "items": _layer(),
        "description": "parts that play in sync, each laid on those before",
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "woz-tui move",
        **_extended(MoveEntry, {"name": name, "frames": frames, "layers": layers}),
        "anyOf": [{"required": ["frames"]}, {"required": ["layers"]}],
        "$defs": {
            "frames": {
                "type": "array",
                "items": _frame(),
                "minItems": 1,
                "description": "moments at which something is reached",
            },
            "samples": {
                "description": "numbers with blanks between them, or a list of numbers",
                "oneOf": [
                    {"type": ["string", "number"]},
                    {"type": "array", "items": NUMBER, "minItems": 1},
                ],
            },
        },
    }


def _frame() -> Schema:
    """Whatever else a frame names is a joint."""
    joints = {
        "type": "object",
        "additionalProperties": _ANGLE,
        "description": "joints by name, where a role has the name of a joint",
    }
    times = {
        "seconds": {**_TIME, "description": "from the frame before"},
        "beats": {**_LENGTH, "description": "from the frame before, with beats: true"},
        "at": {**_TIME, "description": "from the beginning of the move"},
    }
    return {
        **_extended(FrameEntry, {**times, "joints": joints}),
        "additionalProperties": _ANGLE,
        "oneOf": [{"required": [name]} for name in times],
    }


def _layer() -> Schema:
    samples: Schema = {"$ref": "#/$defs/samples"}
    groups = {
        "joints": {
            "type": "object",
            "additionalProperties": samples,
            "description": "samples in degrees by joint",
        },
        "roles": mapping(dict.fromkeys(ROLES, samples)),
        "face": mapping(dict.fromkeys(FEATURE_RANGES, samples)),
    }
    return {
        **_extended(LayerEntry, {"frames": {"$ref": "#/$defs/frames"}, **groups}),
        "anyOf": [{"required": [name]} for name in ("frames", *groups)],
        "dependentRequired": {name: ["rate"] for name in groups},
    }


def _extended(shape: type, properties: Schema) -> Schema:
    schema = settings_schema(shape)
    return {**schema, "properties": {**schema["properties"], **properties}}
