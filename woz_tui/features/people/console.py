"""What is known of participants, on the wizard's screen."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from woz_tui.config.screen_language import say
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.event_sentences import EventContext, EventLine
from woz_tui.console.widgets.feature_console import (
    FeatureConsole,
    ParticipantField,
    ParticipantForm,
)
from woz_tui.features.people.history import PeopleHistory
from woz_tui.features.people.kinds import AskDescribe, ParticipantDescribed


def _fields(state: ConsoleState, code: str) -> Iterable[ParticipantField]:
    """With what is known already, which stays unless something else is typed."""
    told = state.session.history(PeopleHistory).described.get(code)
    known = told.fields if told is not None else {}
    for name, words in state.settings.participant_fields.items():
        now = say("people.now", "now {value}", value=known[name]) if name in known else ""
        may_be = ", ".join(words) or say("people.text", "text")
        hint = "; ".join(filter(None, (may_be, now)))
        yield ParticipantField(name, hint)


def _describe(code: str, typed: Mapping[str, str]) -> AskDescribe:
    return AskDescribe(participant=code, fields=dict(typed))


def _described(message: ParticipantDescribed, shown: EventContext) -> EventLine:
    told = ", ".join(f"{name} {value}" for name, value in message.fields.items())
    return EventLine("info", f"{message.participant}: {told}", message.source)


SENTENCES = {ParticipantDescribed: _described}
CONSOLE = FeatureConsole(describes=ParticipantForm(fields=_fields, request=_describe))
