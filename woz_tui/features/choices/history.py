"""Which choice is offered, and what was chosen."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from woz_tui.features.choices.kinds import ChoiceGone, ChoiceMade, ChoiceOffered
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import Episode
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState, moment


class ChoiceHistory(FeatureHistory):
    """What is offered now."""

    deeds = (ChoiceOffered, ChoiceMade)

    def __init__(self) -> None:
        self.offered: ChoiceOffered | None = None

    def _offer(self, message: ChoiceOffered, state: SessionState) -> Iterable[Episode]:
        self.offered = message
        return moment(message, state.t)

    def _end(self, message: ChoiceMade | ChoiceGone, state: SessionState) -> Iterable[Episode]:
        self.offered = None
        return moment(message, state.t)

    cases: ClassVar[Mapping[type[m.Message], HistoryCase]] = {
        ChoiceOffered: _offer,
        ChoiceMade: _end,
        ChoiceGone: _end,
    }
