"""Dictation on the wizard's screen: its key opens the field of `say`, which gets the texts."""

from __future__ import annotations

from woz_tui.config.screen_language import say
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.event_sentences import EventContext, EventLine
from woz_tui.console.widgets.feature_console import FeatureCommand, FeatureConsole, KeyHint
from woz_tui.features.dictation.kinds import Dictated, DictationSaid
from woz_tui.features.dictation.notes import KEY
from woz_tui.protocol.sentence import Sentence

#: What `woz dictate` calls itself.
PROGRAM = "dictate"


def _dictated(message: Dictated, shown: EventContext) -> EventLine:
    return EventLine("info", say("dictation.event", "Dictated"), message.text)


def _said(message: DictationSaid, shown: EventContext) -> EventLine | None:
    return None


def is_attached(state: ConsoleState) -> bool:
    """Whether `woz dictate` is connected."""
    there = state.session.consoles.values()
    return any(each.role == "program" and each.name == PROGRAM for each in there)


SENTENCES = {Dictated: _dictated, DictationSaid: _said}
CONSOLE = FeatureConsole(
    commands=(
        FeatureCommand(
            KEY,
            opens=f"{__package__}.dialog:DictationDialog",
            hint=KeyHint(3.1, Sentence("dictation.hint", "dictate"), is_attached),
            also=("voice", "microphone"),
        ),
    ),
)
