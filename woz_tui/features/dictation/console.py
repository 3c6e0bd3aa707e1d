"""Dictation on the wizard's screen: the field of `say` gets the texts."""

from __future__ import annotations

from woz_tui.config.screen_language import say
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.event_sentences import EventContext, EventLine
from woz_tui.console.widgets.feature_console import FeatureConsole
from woz_tui.features.dictation.kinds import Dictated, DictationSaid
from woz_tui.features.dictation.notes import DictatedTexts


def _dictated(message: Dictated, shown: EventContext) -> EventLine:
    return EventLine("info", say("dictation.event", "Dictated"), message.text)


def _said(message: DictationSaid, shown: EventContext) -> EventLine | None:
    return None


def _field(state: ConsoleState) -> str | None:
    """Once something was dictated: the same field, into which the texts come."""
    notes = state.study.notes.of(DictatedTexts)
    return f"{__package__}.dialog:DictatedSayDialog" if notes is not None and notes.begun else None


SENTENCES = {Dictated: _dictated, DictationSaid: _said}
CONSOLE = FeatureConsole(instead={"say": _field})
