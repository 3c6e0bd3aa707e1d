"""Figures as objects that JSON can say."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.feature_figures import FeatureFigures
from woz_tui.analysis.figures import PartFigures, SessionFigures
from woz_tui.analysis.measures import TIMES_OF_FEATURES, measured
from woz_tui.analysis.outcomes import Outcome
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.feature import pieces


def plain(value: Any) -> Any:
    """Figures as values for JSON: rows as objects, durations as their spread (microseconds).

    Parts have the main figures of docs/reference/report.md besides, under `main`. What features
    count stands beside all else, by their keys.
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
        if isinstance(value, PartFigures):
            times = {name: value.times.get(name, Durations()) for name in TIMES_OF_FEATURES}
            found |= plain(times) | {"main": measured(value)}
            del found["times"]
        elif isinstance(value, SessionFigures):
            for name, each in pieces("figures", FeatureFigures).items():
                found |= plain(dict(each.values(name, value.features.get(name))))
            del found["features"]
        return found
    return value


def grouped(found: GroupedSessions) -> list[dict[str, Any]]:
    """The conditions and scales of each experiment."""
    return [
        {
            "experiment": experiment,
            "files": found.files(experiment),
            "conditions": plain(found.totals(experiment)),
            **{
                name: plain(value)
                for each in found.gathered.values()
                for name, value in each.values(experiment).items()
            },
            "outcomes": [_outcome(each) for each in found.outcomes(experiment).outcomes],
            "reactions": {
                condition: plain(each) | {"median_us": each.median_us}
                for condition, each in found.outcomes(experiment).reactions.items()
            },
        }
        for experiment in found.experiments
    ]


def _outcome(outcome: Outcome) -> dict[str, Any]:
    """An outcome, what may be said of each condition, and what conditions differ by."""
    return {
        **plain(outcome.name),
        "within": outcome.within,
        "summaries": plain(outcome.summaries()),
        "differences": plain(outcome.differences()),
    }


def apart(found: GroupedSessions) -> dict[str, list[dict[str, Any]]]:
    """The sessions in which nobody took part, by kind."""
    return {
        each.apart.key: [
            {
                "wizard": session.wizard,
                "session": session.session,
                "started": session.started,
                name: plain(session.figures),
            }
            for session in found.apart.get(name, ())
        ]
        for name, each in pieces("figures", FeatureFigures).items()
        if each.apart is not None
    }
