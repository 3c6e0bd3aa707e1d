"""The settings of a driver as rows: name, default, meaning with what is allowed."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Iterator, Mapping

from woz_tui.config.annotated_decoder import SettingField, fields_of, find_note, split_annotation
from woz_tui.drivers import fields


def settings_rows(shape: type) -> list[tuple[str, str, str]]:
    """Settings, and those within them: one level deep, each kind once."""
    return [*_rows(shape, set())]


def _rows(shape: type, shown: set[type], prefix: str = "") -> Iterator[tuple[str, str, str]]:
    for item in fields_of(shape):
        name = f"{prefix}{item.name}"
        bare = split_annotation(item.annotation)[0]
        kinds = [bare, *(split_annotation(each)[0] for each in typing.get_args(bare))]
        inner = next((kind for kind in kinds if dataclasses.is_dataclass(kind)), None)
        if inner is not bare:
            yield name, _default(item), _meaning(item)
        if isinstance(inner, type) and inner not in shown and not prefix:
            shown.add(inner)
            many = typing.get_origin(bare) in (dict, tuple, Mapping)
            yield from _rows(inner, shown, f"{name}.*." if many else f"{name}.")


def _default(item: SettingField) -> str:
    value = item.default
    if item.required:
        return "required"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping | tuple):
        return ", ".join(map(str, value))
    return f"{value:g}" if isinstance(value, float) else str("" if value is None else value)


def _meaning(item: SettingField) -> str:
    notes = split_annotation(item.annotation)[1]
    span, words = find_note(notes, fields.Range), find_note(notes, fields.OneOf)
    allowed = str(span) if span is not None else ""
    if words is not None:
        allowed = ", ".join(filter(None, words.choices))
    return " ".join(filter(None, (item.doc, f"({allowed})" if allowed else "")))
