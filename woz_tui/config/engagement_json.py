"""The settings of the engagement model as plain JSON, the form in which a log has them."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Iterator
from typing import Any

import msgspec

from woz_tui.config.annotated_decoder import fields_of, find_note, split_annotation
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_words import PAPER
from woz_tui.drivers.fields import OneOf
from woz_tui.protocol.envelope import Json

#: A path of the machine on which the session ran; the model does not look at it.
_LEFT_OUT = "visitors"


def settings_to_json(settings: EngagementSettings) -> dict[str, Json]:
    """Every setting, also where it has its default: what a log says holds whatever the defaults of
    later versions are. Only `visitors` is left out, a path that belongs to the machine.
    """
    values: dict[str, Json] = msgspec.json.decode(msgspec.json.encode(settings))
    del values[_LEFT_OUT]
    return values


def settings_from_json(values: dict[str, Json]) -> EngagementSettings:
    """The settings again; what a later version has added is passed over, what is missing has its
    default. Only `turns` is missing where a version wrote them that had the paper's alone. Raises
    `ValueError` with a sentence if they are no settings.
    """
    try:
        settings = msgspec.convert({"turns": PAPER, **values}, EngagementSettings)
        problems = settings.problems()
    except msgspec.ValidationError as error:
        raise ValueError(str(error)) from error
    except ArithmeticError as error:
        raise ValueError("rate must be a number of samples per second") from error
    problems += _strange(settings, EngagementSettings, "")
    if problems:
        raise ValueError("; ".join(f"{name}: {why}" for name, why in problems))
    return settings


def _strange(value: object, annotation: Any, path: str) -> Iterator[tuple[str, str]]:
    """Words that are not in their list of choices: only the decoder of files looks at those."""
    bare, notes = split_annotation(annotation)
    one_of = find_note(notes, OneOf)
    if one_of is not None and value is not None and value not in one_of.choices:
        yield path, f"{value!r} is none of {', '.join(one_of.choices)}"
    elif isinstance(value, tuple):
        for each in value:
            yield from _strange(each, typing.get_args(bare)[0], path)
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        for item in fields_of(type(value)):
            inner = f"{path}.{item.name}" if path else item.name
            yield from _strange(getattr(value, item.attribute), item.annotation, inner)
