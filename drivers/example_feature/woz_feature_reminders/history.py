"""Reminders among the events of a session."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from woz_feature_reminders.kinds import ReminderDue
from woz_tui.protocol.envelope import Message
from woz_tui.timeline.episodes import Episode
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState, moment


class ReminderHistory(FeatureHistory):
    """Each is a moment; nothing of it holds on."""

    def _due(self, message: ReminderDue, state: SessionState) -> Iterable[Episode]:
        return moment(message, state.t)

    cases: ClassVar[Mapping[type[Message], HistoryCase]] = {ReminderDue: _due}
