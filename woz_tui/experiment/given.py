"""A driver's settings from a command line instead of a robot file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from woz_tui.experiment.nodes import Scalar, Table
from woz_tui.experiment.report import Report
from woz_tui.experiment.settings import read_settings
from woz_tui.experiment.shape import Place
from woz_tui.experiment.spot import Spot


def settings_of(shape: type, values: Mapping[str, str], base: Path) -> Any:
    """An instance of `shape` with the settings `values` as text; relative paths start at `base`.

    Raises `ExperimentError` with every problem, also with those of files that are named.
    """
    report = Report()
    place = Place(str(base / "command line"), 1, 1)
    report.file(place.file)
    keys = {name: Scalar(place, name, plain=True) for name in values}
    entries = {name: Scalar(place, text, plain=True) for name, text in values.items()}
    made = read_settings(Spot(Table(place, dict(entries), keys), "", place, report), shape)
    report.fail()
    return made
