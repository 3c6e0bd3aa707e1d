"""Figures as objects that JSON can say."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.figures import PartFigures
from woz_tui.analysis.measures import measured
from woz_tui.analysis.participant_groups import GroupedSessions


def plain(value: Any) -> Any:
    """Figures as values for JSON: rows as objects, durations as their spread (microseconds).

    Parts have the main figures of docs/reference/report.md besides, under `main`.
    """
    match value:
        case Durations():
            names = ("n", "median", "p95", "most", "mean", "sd")
            return {name.replace("most", "max"): getattr(value, name) for name in names}
        case dict():
            return {str(name): plain(item) for name, item in value.items()}
        case list() | tuple():
            return [plain(item) for item in value]
    if is_dataclass(value):
        found = {field.name: plain(getattr(value, field.name)) for field in fields(value)}
        return found | {"main": measured(value)} if isinstance(value, PartFigures) else found
    return value


def grouped(found: GroupedSessions) -> list[dict[str, Any]]:
    """The conditions and scales of each experiment."""
    return [
        {
            "experiment": experiment,
            "files": found.files(experiment),
            "conditions": plain(found.totals(experiment)),
            "scales": plain(found.items(experiment)),
        }
        for experiment in found.experiments
    ]
