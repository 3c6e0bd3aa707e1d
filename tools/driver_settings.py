"""The tables of settings in the drivers' pages, out of the settings' annotations."""

from __future__ import annotations

import dataclasses
import re
import tomllib
import typing
from collections.abc import Iterator, Mapping
from pathlib import Path

from tools import ROOT
from woz_tui.config.annotated_decoder import SettingField, fields_of, find_note, split_annotation
from woz_tui.drivers import fields
from woz_tui.drivers.contract import Driver
from woz_tui.drivers.plugins import installed

DRIVERS = ROOT / "drivers" / "woz_drivers"
_TABLE = re.compile(r"^\| setting \|.*?\n(?!\|)", re.M | re.S)
_HEAD = "| setting | default | |\n|---|---|---|\n"


def bundled() -> dict[str, type[Driver]]:
    """Our own drivers, whatever else is installed on this machine."""
    catalogue = installed()
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return {name: catalogue[name] for name in project["entry-points"]["woz_tui.drivers"]}


def pages() -> dict[str, Path]:
    """The page of each driver, by type."""
    return {name: DRIVERS / name.replace("-", "_") / "README.md" for name in bundled()}


def refreshed(name: str, text: str) -> str:
    """The page of a driver with the table of today."""
    rows = "".join(f"| {' | '.join(row)} |\n" for row in _rows(installed()[name].Settings, set()))
    return _TABLE.sub(lambda _: _HEAD + rows, text, count=1)


def _rows(shape: type, shown: set[type], prefix: str = "") -> Iterator[tuple[str, str, str]]:
    """Settings, and those within them: one level deep, each kind once."""
    for item in fields_of(shape):
        name = f"{prefix}{item.name}"
        bare = split_annotation(item.annotation)[0]
        kinds = [bare, *(split_annotation(each)[0] for each in typing.get_args(bare))]
        inner = next((kind for kind in kinds if dataclasses.is_dataclass(kind)), None)
        if inner is not bare:
            yield f"`{name}`", _default(item), _meaning(item)
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
