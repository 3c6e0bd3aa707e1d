"""Slots on the wizard's screen."""

from __future__ import annotations

from woz_tui.console.state.event_sentences import EventContext, EventLine
from woz_tui.console.widgets.feature_console import FeatureConsole
from woz_tui.features.slots.kinds import SlotFilled


def _filled(message: SlotFilled, shown: EventContext) -> EventLine:
    return EventLine("info", f"{message.slot}: {message.value}", message.source)


SENTENCES = {SlotFilled: _filled}
CONSOLE = FeatureConsole()
