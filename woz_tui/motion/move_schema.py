"""JSON Schema (draft 2020-12) of move files, so that editors complete and warn.

A little more generous than the reader: which joints there are only a robot file says.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from woz_tui.drivers.fields import Range
from woz_tui.motion.body_shape import ROLES
from woz_tui.motion.body_verbs import EMOTIONS
from woz_tui.motion.easing import EASINGS
from woz_tui.motion.keyframes import MIXES
from woz_tui.motion.move_files import ANGLES, FEATURE_RANGES, LENGTHS, RATES, UNIT

Schema = dict[str, Any]

_TEXT: Schema = {"type": ["string", "number", "boolean"]}
_WHAT_ROLES_DO: Mapping[str, str] = {
    "pan": "degrees to its left",
    "nod": "degrees down",
    "lean": "degrees up and back; negative: forward",
    "roll": "degrees cocked to its right",
}


def move_schema() -> Schema:
    """The schema of move files."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "woz-tui move",
        **_object(
            {
                "name": {
                    "type": "string",
                    "pattern": "^[A-Za-z][A-Za-z0-9_-]{0,31}$",
                    "description": "what play calls it by (default: the file's name)",
                },
                "about": {**_TEXT, "description": "what it looks like, in a few words"},
                "relative": _flag("joints are added to the pose held before (default)"),
                "beats": _flag("count beats of the tempo instead of seconds"),
                "stays": _flag("hold the last pose instead of the one before"),
                "frames": {"$ref": "#/$defs/frames"},
                "layers": {
                    "type": "array",
                    "items": {"$ref": "#/$defs/layer"},
                    "description": "parts that play in sync, each laid on those before",
                },
            }
        ),
        "anyOf": [{"required": ["frames"]}, {"required": ["layers"]}],
        "$defs": {
            "frames": {
                "type": "array",
                "items": {"$ref": "#/$defs/frame"},
                "minItems": 1,
                "description": "moments at which something is reached",
            },
            "frame": _frame(),
            "layer": _layer(),
            "samples": {
                "description": "numbers with blanks between them, or a list of numbers",
                "oneOf": [
                    {"type": ["string", "number"]},
                    {"type": "array", "items": {"type": "number"}, "minItems": 1},
                ],
            },
        },
    }


def _frame() -> Schema:
    """Whatever else a frame names is a joint."""
    time = {"oneOf": [_number(LENGTHS), {"type": "string", "pattern": r"^\s*[0-9.]+\s*(ms|s)?$"}]}
    return {
        "type": "object",
        "properties": {
            "seconds": {**time, "description": "from the frame before"},
            "beats": _number(LENGTHS, "from the frame before, with beats: true"),
            "at": {**time, "description": "from the beginning of the move"},
            "easing": {"enum": list(EASINGS), "description": "how it gets there (default: smooth)"},
            "emotion": {"enum": list(EMOTIONS), "description": "face that comes on till then"},
            "intensity": _number(UNIT, "of the emotion"),
            "eyes": {
                **_object({"x": _number(FEATURE_RANGES["x"]), "y": _number(FEATURE_RANGES["y"])}),
                "description": "where they look: x to its left, y up, -1 to 1",
            },
            "lid": _number(UNIT, "how far the eyes are open"),
            "sound": {"type": "string", "description": "file, relative to this one"},
            "volume": _number(UNIT, "of the sound"),
            "roles": {
                **_object({role: _role(role) for role in ROLES}),
                "description": "roles by name, where a joint has the name of a role",
            },
            "joints": {
                "type": "object",
                "additionalProperties": _number(ANGLES),
                "description": "joints by name, where a role has the name of a joint",
            },
            **{role: _role(role) for role in ROLES},
        },
        "additionalProperties": _number(ANGLES),
        "oneOf": [{"required": [name]} for name in ("seconds", "beats", "at")],
    }


def _layer() -> Schema:
    samples = {"$ref": "#/$defs/samples"}
    schema = _object(
        {
            "name": {**_TEXT, "description": "unique in the file"},
            "muted": _flag("leave it out; it still counts for the length"),
            "share": _number(UNIT, "how much of it counts (default: 1)"),
            "mix": {"enum": list(MIXES), "description": "added to the layers below (default)"},
            "relative": _flag("as the move's, for this layer"),
            "frames": {"$ref": "#/$defs/frames"},
            "rate": _number(RATES, "samples each second, or beat"),
            "joints": {
                "type": "object",
                "additionalProperties": samples,
                "description": "samples in degrees by joint",
            },
            "roles": _object(dict.fromkeys(ROLES, samples)),
            "face": _object(dict.fromkeys(FEATURE_RANGES, samples)),
        },
    )
    groups = ("frames", "joints", "roles", "face")
    return {
        **schema,
        "required": ["name"],
        "anyOf": [{"required": [name]} for name in groups],
        "dependentRequired": {name: ["rate"] for name in groups[1:]},
    }


def _role(role: str) -> Schema:
    return _number(ANGLES, _WHAT_ROLES_DO[role])


def _flag(description: str) -> Schema:
    return {"enum": [True, False, "yes", "no", "on", "off"], "description": description}


def _number(allowed: Range, description: str = "") -> Schema:
    schema: Schema = {"type": "number", "minimum": allowed.low, "maximum": allowed.high}
    return {**schema, "description": description} if description else schema


def _object(properties: Schema) -> Schema:
    return {"type": "object", "properties": properties, "additionalProperties": False}
