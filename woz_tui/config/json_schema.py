"""JSON Schema (draft 2020-12) of experiment and robot files, so that editors complete and warn.

Made from the same shapes and driver classes by which files are decoded. It is a little more
generous than `woz check`: verbs and choices that depend on a driver's settings are open, text may
be anything that YAML would take for a number or a boolean, since here it stays text.
"""

from __future__ import annotations

import contextlib
import dataclasses
import enum
import pathlib
import types
import typing
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal

from woz_tui.config.annotated_decoder import fields_of, find_note, split_annotation
from woz_tui.config.condition_texts import ANY
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_section import ENTERED, ON_ENTER
from woz_tui.config.experiment import OWN_PROCESS, SHARED_PROCESS, DriverPlace
from woz_tui.config.experiment_file import TOP_LEVEL, ActionEntry, ExperimentFile
from woz_tui.config.feature_section import FeatureSection
from woz_tui.config.robots import AT, NAMED, PROCESS
from woz_tui.config.session_verbs import WAIT, engagement_verbs, session_verbs
from woz_tui.config.study_words import CUES
from woz_tui.drivers import fields
from woz_tui.drivers.contract import Argument, Driver, Verb
from woz_tui.feature import pieces
from woz_tui.protocol.messages import Json

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
    schema = mapping(properties, required=required(shape))
    either = shape.either if issubclass(shape, fields.Entry) else ()
    return {**schema, "anyOf": [{"required": [name]} for name in either]} if either else schema


def required(shape: type) -> tuple[str, ...]:
    """The names of settings that may not be left out."""
    return tuple(item.name for item in fields_of(shape) if item.required)


def _type(annotation: Any, notes: tuple[Any, ...] = ()) -> Schema:
    bare, own = split_annotation(annotation)
    apart = find_note(own, fields.ReadApart)
    if apart is not None and isinstance(apart.written, str):
        return {"$ref": f"#/$defs/{apart.written}"}
    if apart is not None and apart.written is not None:
        bare, own = apart.written, tuple(note for note in own if note is not apart)
    origin = typing.get_origin(bare) or bare
    notes = (*own, *notes)
    if origin in (typing.Union, types.UnionType):
        return either([_type(kind, notes) for kind in typing.get_args(bare)])
    if origin in (tuple, list, frozenset, Sequence):
        return _list(bare, own, notes)
    if origin in (dict, Mapping):
        inner = typing.get_args(bare) or (str, Any)
        schema: Schema = {"type": "object", "additionalProperties": _type(inner[1], notes)}
        return schema | ({"minProperties": 1} if find_note(own, fields.NotEmpty) else {})
    if dataclasses.is_dataclass(origin) and isinstance(origin, type):
        return settings_schema(origin)
    return _simple(bare, notes)


def _list(bare: Any, own: tuple[Any, ...], notes: tuple[Any, ...]) -> Schema:
    inner = typing.get_args(bare) or (Any,)
    items = either([_type(kind, notes) for kind in inner if kind is not ...])
    schema: Schema = {"type": "array", "items": items}
    if typing.get_origin(bare) is tuple and inner[-1] is not ...:
        schema |= {"minItems": len(inner), "maxItems": len(inner)}
    if find_note(own, fields.Unique) is not None:
        schema["uniqueItems"] = True
    several = find_note(own, fields.OneOrMore) is not None
    if several or find_note(own, fields.NotEmpty) is not None:
        schema["minItems"] = 1
    return {"oneOf": [TEXT, schema]} if several else schema


def _simple(bare: Any, notes: tuple[Any, ...]) -> Schema:
    if isinstance(bare, type) and issubclass(bare, enum.Enum):
        return {"enum": [str(member.value) for member in bare]}
    if typing.get_origin(bare) is Literal:
        return {"enum": list(typing.get_args(bare))}
    if (one_of := find_note(notes, fields.OneOf)) is not None and bare is str:
        return {"enum": list(one_of.choices)}
    if find_note(notes, fields.Seconds) is not None and bare is float:
        return SECONDS
    if bare in (int, float) and bare is not bool:
        kind = "integer" if bare is int else "number"
        return {"type": kind, **bounds(find_note(notes, fields.Range))}
    if isinstance(bare, type) and issubclass(bare, pathlib.Path):
        return {"type": "string"}
    return {bool: FLAG, str: TEXT, type(None): {"type": "null"}}.get(bare, {})


#: What answers a cue.
_ONE_OR_MORE: Schema = {"oneOf": [TEXT, {"type": "array", "items": TEXT, "minItems": 1}]}
_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_JOINTS: Schema = {"type": "object", "additionalProperties": NUMBER, "minProperties": 1}
_POSES: Schema = {"type": "array", "items": {"type": "object", "minProperties": 1}, "minItems": 1}
_KINDS: Mapping[str, Schema] = {
    "flag": FLAG,
    "seconds": SECONDS,
    "joints": _JOINTS,
    "poses": _POSES,
}
_ANY = mapping({ANY: {"type": "array", "items": TEXT, "minItems": 1}}, required=(ANY,))
#: What may stand in the place of a text.
_CHOSEN: Schema = {
    "description": "a text for each condition, or {any: [...]}: variants in shuffled order",
    "anyOf": [
        _ANY,
        {"type": "object", "additionalProperties": {"anyOf": [TEXT, _ANY]}, "minProperties": 2},
    ],
}
_AT: Schema = {
    "description": "another computer of the robot that has its hardware",
    "oneOf": [TEXT, settings_schema(DriverPlace)],
}
_PROCESS: Schema = {
    "description": "a process of its own, as drivers that did not come with woz-tui have by"
    " themselves, or that of the session",
    "enum": [OWN_PROCESS, SHARED_PROCESS],
}
_ROBOT_OR_FILE: Schema = {"oneOf": [{"type": "string"}, {"$ref": "#/$defs/robot"}]}
_KEY: Schema = {
    "oneOf": [
        {"type": ["string", "integer", "boolean"]},
        {"type": "array", "items": {"type": ["string", "integer"]}, "minItems": 1},
    ],
}
_ON: Schema = {
    "description": "driver or robot; a list for several at once",
    "oneOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}],
}


def experiment_schema(
    catalogue: Mapping[str, type[Driver]], tell: Callable[[str], None] = lambda text: None
) -> Schema:
    """The schema of experiment files for these drivers.

    `tell` hears of drivers whose verbs are left out because nobody knows them.
    """
    verbs = _verbs_of_all(catalogue, tell)
    spoken = _verb_properties(verbs)
    action = settings_schema(ActionEntry)
    until = action["properties"]["until"]
    action["properties"] = {**spoken, **action["properties"]}
    wait = {**SECONDS, "description": WAIT.summary}
    step = mapping({**spoken, "on": _ON, "until": until, "wait": wait})
    step["minProperties"] = 1
    cues = {cue: {**_ONE_OR_MORE, "description": f"what answers the cue {cue}"} for cue in CUES}
    experiment = settings_schema(ExperimentFile)
    properties = experiment["properties"]
    experiment["properties"] = {name: properties[name] for name in TOP_LEVEL}
    return {
        "$schema": _DIALECT,
        "title": "woz-tui experiment",
        **experiment,
        "oneOf": [{"required": ["robot"]}, {"required": ["robots"]}],
        "$defs": {
            "robot": _robot(catalogue),
            "robot_or_file": _ROBOT_OR_FILE,
            "engagement": _engagement(),
            "answers": {"oneOf": [mapping(cues), _ONE_OR_MORE]},
            **{
                name: schema
                for section in pieces("section", FeatureSection).values()
                for name, schema in section.schemas().items()
            },
            "key": _KEY,
            "on": _ON,
            "actions": {"type": "array", "items": {"$ref": "#/$defs/action"}},
            "action": action,
            "steps": {"type": "array", "items": {"$ref": "#/$defs/step"}, "minItems": 1},
            "step": step,
            "chosen": _CHOSEN,
        },
    }


def robot_schema(catalogue: Mapping[str, type[Driver]]) -> Schema:
    """The schema of robot files for these drivers."""
    return {"$schema": _DIALECT, "title": "woz-tui robot", **_robot(catalogue)}


def included_schema(driver: type[Driver], setting: str) -> Schema:
    """The schema of files in which a setting of this driver may stand (`fields.Included`)."""
    annotation = next(
        item for item in fields_of(driver.Settings) if item.name == setting
    ).annotation
    shape = next(
        kind
        for kind in typing.get_args(split_annotation(annotation)[0])
        if dataclasses.is_dataclass(kind)
    )
    assert isinstance(shape, type)
    return {"$schema": _DIALECT, "title": f"woz-tui {setting}", **settings_schema(shape)}


def _robot(catalogue: Mapping[str, type[Driver]]) -> Schema:
    kinds = [
        mapping(
            {
                "type": {"const": name, "description": driver.summary},
                AT: _AT,
                PROCESS: _PROCESS,
                **settings_schema(driver.Settings)["properties"],
            },
            required=("type", *required(driver.Settings)),
        )
        for name, driver in sorted(catalogue.items())
    ]
    drivers = {
        "type": "object",
        "description": "drivers by name",
        "minProperties": 1,
        "propertyNames": {"pattern": "^[A-Za-z][A-Za-z0-9_-]*$"},
        "additionalProperties": {
            "type": "object",
            "required": ["type"],
            "properties": {"type": {"enum": sorted(catalogue)}},
            "oneOf": kinds,
        },
    }
    names = {
        field: {
            "type": "object",
            "description": f"{field}: the name in experiments, and the driver's own",
            "additionalProperties": TEXT,
        }
        for field in NAMED
    }
    of_features = {
        key: schema
        for each in pieces("section", FeatureSection).values()
        for key, schema in each.robot_schema().items()
    }
    keys = {"name": TEXT, **names, **of_features, "drivers": drivers}
    return mapping(keys, required=("drivers",))


def _engagement() -> Schema:
    """Settings of the model, and steps or names of actions by state."""
    step: Schema = {"$ref": "#/$defs/step"}
    entered: Schema = {"oneOf": [TEXT, step]}
    on_enter = mapping(
        {
            state: {"oneOf": [TEXT, step, {"type": "array", "items": entered, "minItems": 1}]}
            for state in ENTERED
        }
    )
    schema = settings_schema(EngagementSettings)
    schema["properties"][ON_ENTER] = {
        **on_enter,
        "description": "on entering a state: steps, or names of actions",
    }
    return schema


def _verb_properties(verbs: Sequence[Verb]) -> Schema:
    """Every verb, and every argument that may stand beside one."""
    arguments: dict[str, list[tuple[str, Argument]]] = {}
    for verb in verbs:
        for argument in verb.arguments:
            arguments.setdefault(argument.name, []).append((verb.name, argument))
    properties: Schema = {}
    for name, found in arguments.items():
        owners = ", ".join(dict.fromkeys(verb for verb, _ in found))
        summary = next((argument.summary for _, argument in found if argument.summary), "")
        properties[name] = {
            **either([_argument(argument) for _, argument in found]),
            "description": f"{summary} (of {owners})".strip(),
        }
    for verb in verbs:
        properties[verb.name] = _verb(verb, properties.get(verb.name))
    return properties


def _verb(verb: Verb, as_argument: Schema | None) -> Schema:
    """The main argument, or a mapping of arguments, or nothing if none is needed."""
    under = mapping(
        {
            **{
                argument.name: {**_argument(argument), "description": argument.summary}
                for argument in verb.arguments
            },
            "on": _ON,
        }
    )
    if verb.arguments and verb.arguments[0].kind == "joints":
        under["additionalProperties"] = NUMBER
    forms: list[Schema] = [under]
    if verb.arguments:
        forms.append(_argument(verb.arguments[0]))
    if not verb.arguments or not verb.arguments[0].required:
        forms.append({"type": "null"})
    if not verb.arguments:
        forms.append({"const": True})
    if as_argument is not None:
        forms.append({name: value for name, value in as_argument.items() if name != "description"})
    return {**either(forms), "description": verb.summary}


def _argument(argument: Argument) -> Schema:
    if argument.kind in ("number", "whole"):
        kind = "number" if argument.kind == "number" else "integer"
        return {"type": kind, **bounds(argument.range)}
    if argument.kind in _KINDS:
        return _KINDS[argument.kind]
    text = {"type": "string"} if argument.kind == "file" else TEXT
    text = {"enum": list(argument.choices)} if argument.choices else text
    return {"anyOf": [text, {"$ref": "#/$defs/chosen"}]}


def _verbs_of_all(catalogue: Mapping[str, type[Driver]], tell: Callable[[str], None]) -> list[Verb]:
    """All verbs of all drivers, one of each name; choices stay open where settings make them."""
    merged: dict[str, Verb] = {}
    for name in sorted(catalogue):
        try:
            offered = _sample_verbs(catalogue[name])
        except Exception as error:  # noqa: BLE001 - a plug-in's code
            tell(
                f"the verbs of the driver {name!r} are left out:"
                f" with sample settings it fails: {type(error).__name__}: {error}"
            )
            continue
        for verb in offered:
            known = merged.get(verb.name)
            merged[verb.name] = verb if known is None else _merged_verb(known, verb)
    sections = pieces("section", FeatureSection).values()
    of_features = [verb for each in sections for verb in each.verbs]
    return [
        *merged.values(),
        *map(_with_open_choices, session_verbs()),
        *of_features,
        *engagement_verbs(),
    ]


def _sample_verbs(driver: type[Driver]) -> Iterable[Verb]:
    """The verbs with settings as a file would give them at least, and those that a switch brings
    along; may raise anything.
    """
    sample = sample_settings(driver.Settings)
    offered = [*driver.offer(sample).verbs]
    for item in fields_of(driver.Settings):
        if split_annotation(item.annotation)[0] is bool and item.default is False:
            # Not every switch goes with this sample; then it has nothing to say here.
            with contextlib.suppress(Exception):
                offered += driver.offer(dataclasses.replace(sample, **{item.attribute: True})).verbs
    return [_with_open_choices(verb) for verb in offered]


def _with_open_choices(verb: Verb) -> Verb:
    arguments = tuple(dataclasses.replace(argument, choices=()) for argument in verb.arguments)
    return dataclasses.replace(verb, arguments=arguments)


def _merged_verb(one: Verb, other: Verb) -> Verb:
    """A verb that takes what either takes, ranges left open where they differ."""
    known = {argument.name: argument for argument in one.arguments}
    for argument in other.arguments:
        first = known.setdefault(argument.name, argument)
        if first.range != argument.range:
            known[argument.name] = dataclasses.replace(first, range=None)
    return dataclasses.replace(one, arguments=tuple(known.values()))


def sample_settings(shape: type) -> Any:
    """An instance with what is required, and with all parts that can be skipped: a robot may
    have a face, and its editor shall know what faces can do.
    """
    given = (item for item in fields_of(shape) if item.required or _part(item.annotation))
    return shape(**{item.attribute: _sample_value(item.annotation) for item in given})


def _part(annotation: Any) -> type | None:
    """The dataclass of an annotation such as `FaceShape | None`."""
    bare, _ = split_annotation(annotation)
    if typing.get_origin(bare) not in (typing.Union, types.UnionType):
        return None
    kinds = (kind for kind in typing.get_args(bare) if isinstance(kind, type))
    return next((kind for kind in kinds if dataclasses.is_dataclass(kind)), None)


def _sample_value(annotation: Any) -> Any:
    bare, notes = split_annotation(annotation)
    if (one_of := find_note(notes, fields.OneOf)) is not None:
        return one_of.choices[0]
    if (allowed := find_note(notes, fields.Range)) is not None and bare in (int, float):
        return bare(allowed.low if allowed.low is not None else allowed.high or 0)
    if (part := _part(annotation)) is not None:
        return sample_settings(part)
    origin = typing.get_origin(bare) or bare
    if origin in (dict, Mapping):
        return {"sample": _sample_value(typing.get_args(bare)[1])}
    if dataclasses.is_dataclass(origin) and isinstance(origin, type):
        return sample_settings(origin)
    return {str: "sample", int: 1, float: 1.0, bool: False, tuple: (), list: []}.get(origin)
