"""Figures as objects that JSON can say."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.figures import PartFigures, SessionFigures
from woz_tui.analysis.measures import measured
from woz_tui.analysis.participant_groups import GroupedSessions


def plain(value: Any) -> Any:
    """Any figure: rows as objects, times of many as their spread (microseconds), the rest as is.

    Parts have the main figures of docs/reference/report.md besides, under `main`.
    """
    match value:
        case Durations():
            return _spread(value)
        case dict():
            return {str(name): plain(item) for name, item in value.items()}
        case list() | tuple():
            return [plain(item) for item in value]
    if is_dataclass(value):
        told = {field.name: plain(getattr(value, field.name)) for field in fields(value)}
        return {**told, "main": measured(value)} if isinstance(value, PartFigures) else told
    return value


def _spread(times: Durations) -> dict[str, float | None]:
    return {
        "n": times.n,
        "median": times.median,
        "p95": times.p95,
        "max": times.most,
        "mean": times.mean,
        "sd": times.sd,
    }


def session(figures: SessionFigures) -> dict[str, Any]:
    """One session."""
    found: dict[str, Any] = plain(figures)
    return found


def trainings(found: GroupedSessions) -> list[dict[str, Any]]:
    """Each training of a wizard."""
    told: list[dict[str, Any]] = plain(found.trainings)
    return told


def grouped(found: GroupedSessions) -> list[dict[str, Any]]:
    """Each experiment's conditions and scales."""
    return [
        {
            "experiment": experiment,
            "conditions": plain(found.totals(experiment)),
            "scales": plain(found.items(experiment)),
        }
        for experiment in found.experiments
    ]
