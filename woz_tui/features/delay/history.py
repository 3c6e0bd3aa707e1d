"""How answers are delayed, and which actions wait for that."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from woz_tui.features.delay.kinds import ActionHeld, ShapingChanged
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import OUTCOMES, Episode, keep_latest
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState, moment


class DelayHistory(FeatureHistory):
    """How answers are delayed, and the actions under way that were held, by run."""

    def __init__(self) -> None:
        self.changed: ShapingChanged | None = None
        self.held: dict[str, ActionHeld] = {}

    def put_off(self, run: str) -> tuple[int, int] | None:
        held = self.held.get(run)
        return None if held is None else (held.t, held.until)

    def _change(self, message: ShapingChanged, state: SessionState) -> Iterable[Episode]:
        self.changed = message
        return moment(message, state.t)

    def _hold(self, message: ActionHeld, state: SessionState) -> Iterable[Episode]:
        if message.run in state.actions:
            keep_latest(self.held, message.run, message)
        return moment(message, state.t)

    def _end(self, message: m.ActionEnd, state: SessionState) -> None:
        self.held.pop(message.run, None)

    cases: ClassVar[Mapping[type[m.Message], HistoryCase]] = {
        ShapingChanged: _change,
        ActionHeld: _hold,
        **dict.fromkeys((kind for kind in OUTCOMES if issubclass(kind, m.ActionEnd)), _end),
    }
