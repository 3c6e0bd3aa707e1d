"""What slots were filled with, and how long that took."""

from __future__ import annotations

from dataclasses import dataclass

from woz_tui.analysis.event_rows import ContextRow, context_fields, moments
from woz_tui.analysis.feature_figures import FeatureFigures
from woz_tui.features.slots.kinds import SlotFilled
from woz_tui.timeline.timeline import Timeline


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


FIGURES = SlotFigures()
