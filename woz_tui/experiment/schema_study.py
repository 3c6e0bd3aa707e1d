"""JSON Schema of the sections about the study."""

from __future__ import annotations

from woz_tui.experiment.questionnaires import CODE, WHENS
from woz_tui.experiment.schema_parts import FLAG, SECONDS, TEXT, Schema, mapping
from woz_tui.experiment.schema_settings import settings_schema
from woz_tui.experiment.study import SORTS, Design, Perception, Shaping, Training

_ONE_OR_MORE: Schema = {"oneOf": [TEXT, {"type": "array", "items": TEXT, "minItems": 1}]}
_NAME: Schema = {
    "type": "string",
    "pattern": f"^{CODE.pattern}$",
    "description": "name in logs and tables (default: made from the words)",
}
#: A text for each condition, by its name.
BY_CONDITION: Schema = {"type": "object", "additionalProperties": TEXT, "minProperties": 1}


def study_properties() -> Schema:
    """The sections by name."""
    return {
        "design": _design(),
        "questionnaires": {
            "type": "array",
            "items": _questionnaire(),
            "description": "what the participant is asked",
        },
        "preflight": {
            "type": "array",
            "items": TEXT,
            "uniqueItems": True,
            "description": "what a human sees to before the first participant",
        },
        "shaping": {
            **settings_schema(Shaping),
            "description": "how soon the robot may answer a cue",
        },
        "perception": {
            **settings_schema(Perception),
            "description": "what the wizard does not get to see",
        },
        "training": _training(),
    }


def _design() -> Schema:
    schema = settings_schema(Design)
    schema["description"] = "who gets which condition, in which order"
    # Who gets one condition gets it from a shuffled block, unless the file says otherwise.
    schema["properties"]["order"].pop("default")
    schema["properties"]["blind"] = {
        "anyOf": [FLAG, BY_CONDITION],
        "description": "what the wizard is told instead of each condition; true: letters",
    }
    return schema


def _scale() -> Schema:
    ends = {"type": "array", "items": TEXT, "minItems": 2, "maxItems": 2}
    return {
        **mapping({"low": {"type": "integer"}, "high": {"type": "integer"}, "ends": ends}),
        "description": "whole numbers from low to high, and what the ends are called",
    }


def _questionnaire() -> Schema:
    item = mapping(
        {
            "name": _NAME,
            "question": TEXT,
            "scale": _scale(),
            "text": {**FLAG, "description": "a free text instead of a scale"},
            "optional": {**FLAG, "description": "may be left out"},
        },
        required=("question",),
    )
    schema = mapping(
        {
            "name": _NAME,
            "title": {**TEXT, "description": "what stands above it"},
            "when": {
                "enum": list(WHENS),
                "description": "at the end, after each trial or condition, or by hand alone",
            },
            "introduction": TEXT,
            "scale": _scale(),
            "items": {"type": "array", "items": {"oneOf": [TEXT, item]}, "minItems": 1},
        },
        required=("items",),
    )
    return {**schema, "anyOf": [{"required": ["title"]}, {"required": ["name"]}]}


def _training() -> Schema:
    cue = mapping(
        {
            "cue": {"enum": list(SORTS), "description": "what the visitor does"},
            "says": {**_ONE_OR_MORE, "description": "what the visitor says; one of several"},
            "answers": {**_ONE_OR_MORE, "description": "names of the actions that are right"},
            "window": {**SECONDS, "description": "seconds in which the answer must come"},
        },
        required=("cue", "answers"),
    )
    schema = settings_schema(Training)
    schema["description"] = "what `woz train` does"
    schema["properties"]["cues"] = {"type": "array", "items": cue, "minItems": 1}
    return schema
