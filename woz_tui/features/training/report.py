"""Trainings in reports and exports."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from woz_tui.analysis.feature_figures import ApartSession
from woz_tui.analysis.feature_report import FeatureReport, FigureTile
from woz_tui.analysis.measures import seconds
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.analysis.tables import SESSIONS, Column, TableDefinition, rounded
from woz_tui.analysis.text_format import NONE, duration, percent
from woz_tui.features.training.figures import TrainingFigures

#: What the table of sessions says of a session.
_OF_SESSION: dict[str, Column[Any]] = {column.name: column for column in SESSIONS.columns}


def _count(name: str, meaning: str) -> Column[TrainingFigures]:
    return Column(name, "integer", meaning, lambda _, training: getattr(training, name))


TRAININGS: TableDefinition[TrainingFigures] = TableDefinition(
    "trainings",
    "One row for each session in which a wizard was trained.",
    (
        *(_OF_SESSION[name] for name in ("log", "session", "wizard", "started")),
        _count("cues", "lines `cue.given`, without those that became void"),
        _count("right", "cues that were answered correctly"),
        _count("wrong", "cues that were answered by another action"),
        _count("missed", "cues that were not answered in time"),
        _count("uncalled", "actions without a cue"),
        Column("score", "number", "`right` / `cues`", lambda _, it: rounded(it.score), "share"),
        Column(
            *("reaction_median_s", "number", "median time to right and wrong answers"),
            *(lambda _, it: rounded(seconds(it.times.median)), "s"),
        ),
    ),
    lambda figures: [each for name, each in figures.features.items() if name == "training"],
)


class TrainingReport(FeatureReport):
    """How wizards did in their trainings."""

    tables = (TRAININGS,)
    about = ("`trainings.csv`: trainings of wizards",)

    def apart(self, sessions: Sequence[ApartSession]) -> ReportTable:
        """By wizard and time."""
        rows = [
            (
                *(LogText(each.wizard or NONE), LogText(each.session)),
                *map(str, (it.cues, it.right, it.wrong, it.missed, it.uncalled)),
                *(percent(it.score), duration(it.times.median)),
            )
            for each in sorted(sessions, key=lambda each: (each.wizard, each.started))
            for it in (each.figures,)
        ]
        heads = ("Wizard", "Session", "Cues", "Right", "Wrong", "Missed", "No cue", "Score")
        return ReportTable("Wizard training", [*heads, "Reaction"], rows, words=2)

    def tiles(self, figures: TrainingFigures) -> Iterator[FigureTile]:
        more = f"{figures.right} of {figures.cues} cues right, {figures.missed} missed, "
        more += f"{figures.wrong} wrong, {figures.uncalled} uncalled"
        yield FigureTile("Training", percent(figures.score), more)


REPORT = TrainingReport()
