"""Reminders in the wizard's list of events."""

from __future__ import annotations

from woz_feature_reminders.kinds import ReminderDue
from woz_tui.console.state.event_sentences import EventContext, EventLine


def _due(message: ReminderDue, shown: EventContext) -> EventLine:
    return EventLine("note", message.text, "reminder")


SENTENCES = {ReminderDue: _due}
