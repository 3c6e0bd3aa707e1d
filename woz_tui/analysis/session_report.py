"""What is found out about one session: its figures, and its timeline if somebody wants to draw."""

from __future__ import annotations

from dataclasses import dataclass

from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.timeline_lanes import TimelineDrawing


@dataclass(frozen=True, slots=True)
class SessionReport:
    """`timeline` is None unless it was asked for."""

    figures: SessionFigures
    timeline: TimelineDrawing | None = None
