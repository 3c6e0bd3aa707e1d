"""What slots were filled with, and how long that took."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.event_rows import ContextRow, context_fields, moments
from woz_tui.analysis.feature_figures import FeatureFigures
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.analysis.text_format import duration
from woz_tui.features.slots.kinds import KEPT, SlotFilled
from woz_tui.timeline.timeline import Timeline

#: What a report counts, in this order.
SOURCES = ("typed", "offered", "heard", "program", KEPT)


@dataclass(frozen=True, slots=True, kw_only=True)
class SlotRow(ContextRow):
    """A slot had a value in a sentence. `took_us`: how long a wizard took; 0: none did."""

    t: int
    played: str
    action: str
    slot: str
    value: str
    source: str
    took_us: int


class SlotFigures(FeatureFigures):
    """Each value of a session."""

    def count(self, timeline: Timeline) -> tuple[SlotRow, ...] | None:
        rows = (
            SlotRow(
                **context_fields(context),
                t=line.t,
                played=line.run,
                action=line.action,
                slot=line.slot,
                value=line.text,
                source=line.source,
                took_us=line.took_us,
            )
            for context, line in moments(timeline, SlotFilled)
        )
        return tuple(rows) or None

    def tables(self, figures: tuple[SlotRow, ...]) -> Iterator[ReportTable]:
        rows = []
        for slot in dict.fromkeys(row.slot for row in figures):
            of_it = [row for row in figures if row.slot == slot]
            sources = Counter(row.source for row in of_it)
            took = Durations(row.took_us for row in of_it if row.took_us)
            counts = (str(sources[source]) for source in SOURCES)
            rows.append((LogText(slot), *counts, duration(took.median)))
        heads = ("Slot", *(source.capitalize() for source in SOURCES), "Took")
        yield ReportTable("Slots", heads, rows)


FIGURES = SlotFigures()
