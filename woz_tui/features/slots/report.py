"""Slots as a table of reports and exports."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.feature_report import FeatureReport
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.analysis.tables import SETTINGS, Column, TableDefinition
from woz_tui.analysis.text_format import duration
from woz_tui.features.slots.figures import SlotRow
from woz_tui.features.slots.kinds import KEPT
from woz_tui.system.text_cleaning import seconds as exact

#: What a report counts, in this order.
SOURCES = ("typed", "offered", "heard", "program", KEPT)
#: What the table of settings says of where and when something was.
_PLACES: dict[str, Column[Any]] = {column.name: column for column in SETTINGS.columns}
_WHERE = ("log", "session", "participant", "condition", "trial", "phase")


def _of(name: str, meaning: str, field: str = "") -> Column[SlotRow]:
    return Column(name, "string", meaning, lambda _, row: getattr(row, field or name) or None)


SLOTS: TableDefinition[SlotRow] = TableDefinition(
    "slots",
    "What slots of sentences were filled with: one row for each in each sentence that was played.",
    (
        *(_PLACES[name] for name in _WHERE),
        Column("onset", "number", "when, from the session's start", lambda _, it: exact(it.t), "s"),
        _of("run", "id of the action's run", "played"),
        _of("action", "name of the action"),
        _of("slot", "name of the slot"),
        _of("value", "what stood in it"),
        _of("source", "typed, offered, heard, program, or kept: it had been filled before"),
        Column(
            *("took", "number", "from the question to the wizard's answer"),
            lambda _, it: exact(it.took_us) if it.took_us else None,
            "s",
        ),
    ),
    lambda figures: [*figures.features.get("slots", ())],
)


class SlotReport(FeatureReport):
    """Each value with its sentence."""

    tables = (SLOTS,)
    about = ("`slots.csv`: what slots of sentences were filled with",)

    def session_tables(self, figures: tuple[SlotRow, ...]) -> Iterator[ReportTable]:
        rows = []
        for slot in dict.fromkeys(row.slot for row in figures):
            of_it = [row for row in figures if row.slot == slot]
            sources = Counter(row.source for row in of_it)
            took = Durations(row.took_us for row in of_it if row.took_us)
            counts = (str(sources[source]) for source in SOURCES)
            rows.append((LogText(slot), *counts, duration(took.median)))
        heads = ("Slot", *(source.capitalize() for source in SOURCES), "Took")
        yield ReportTable("Slots", heads, rows)


REPORT = SlotReport()
