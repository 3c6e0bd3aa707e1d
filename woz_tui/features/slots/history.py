"""Which values of slots are kept."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from woz_tui.features.slots.kinds import KEPT, SlotFilled
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import Episode, keep_latest
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState, moment


class SlotHistory(FeatureHistory):
    """What each slot was filled with last, of those whose values are kept."""

    deeds = (SlotFilled,)

    def __init__(self) -> None:
        self.filled: dict[str, SlotFilled] = {}

    def _fill(self, message: SlotFilled, state: SessionState) -> Iterable[Episode]:
        if message.keep and message.source != KEPT:
            keep_latest(self.filled, message.slot, message)
        return moment(message, state.t)

    cases: ClassVar[Mapping[type[m.Message], HistoryCase]] = {SlotFilled: _fill}


def kept_values(state: SessionState) -> dict[str, SlotFilled]:
    """Values that hold for the present participant, or in the present trial, by slot."""
    study = state.study
    return {
        name: line
        for name, line in state.history(SlotHistory).filled.items()
        if line.participant == study.participant
        and (line.keep != "trial" or line.trial == (study.number or 0))
    }
