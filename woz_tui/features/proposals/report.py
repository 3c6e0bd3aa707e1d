"""Proposals as a table of reports and exports."""

from __future__ import annotations

from typing import Any

from woz_tui.analysis.feature_report import FeatureReport
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.tables import SESSIONS, SETTINGS, Column, TableDefinition
from woz_tui.features.proposals.figures import ProposalFigures, SetRow
from woz_tui.system.text_cleaning import seconds as exact

_PLACES: dict[str, Column[Any]] = {column.name: column for column in SETTINGS.columns}
_WIZARD: Column[Any] = next(each for each in SESSIONS.columns if each.name == "wizard")
_NOTHING = ProposalFigures()


def _of(name: str, kind: str, meaning: str) -> Column[Any]:
    return Column(name, kind, meaning, lambda _, row: getattr(row, name))


def proposed_in(figures: SessionFigures) -> ProposalFigures:
    """What was proposed in a session."""
    found: ProposalFigures = figures.features.get("proposals", _NOTHING)
    return found


SUGGESTIONS: TableDefinition[SetRow] = TableDefinition(
    "suggestions",
    "Each set of proposals that the wizard was offered, and how it ended.",
    (
        *(
            _PLACES[each]
            for each in ("log", "session", "participant", "condition", "trial", "phase")
        ),
        _WIZARD,
        _of("set", "string", "id of the set"),
        _of("source", "string", "what proposed it: logs, model or program"),
        _of("who", "string", "name of the program"),
        _of("approval", "boolean", "the program did nothing that was not taken"),
        _of("cue", "string", "driver and segment of the visitor's words that it answers"),
        _of("items", "integer", "how many items it had"),
        _of("outcome", "string", "how it ended (`suggest.taken`, `suggest.gone`); empty: no end"),
        Column(
            *("onset", "number", "when it was offered, from the session's start"),
            lambda _, row: exact(row.t),
            "s",
        ),
        Column(
            *("after", "number", "from the offer to its end"),
            lambda _, row: None if row.after_us is None else exact(row.after_us),
            "s",
        ),
        Column(
            *("shown_after", "number", "from the offer until it stood on a screen; empty: never"),
            lambda _, row: None if row.shown_us is None else exact(row.shown_us),
            "s",
        ),
        Column(
            *(
                "ignored",
                "boolean",
                "it stood on a screen, and something else was done, or nothing",
            ),
            lambda _, row: row.is_ignored,
        ),
        _of("distance", "number", "how much of the sentence was changed, 0 to 1"),
        _of("marked", "boolean", "a sentence of it was marked: said just now, one more question"),
        _of("was_right", "boolean", "the wizard's next act was one of its actions"),
        _of("counted", "boolean", "it was not offered in a trial that does not count"),
    ),
    lambda figures: proposed_in(figures).sets,
    key=("log", "set"),
)


class ProposalReport(FeatureReport):
    """A row for each set."""

    tables = (SUGGESTIONS,)
    about = ("`suggestions.csv`: what was proposed to the wizard, and how it ended",)


REPORT = ProposalReport()
