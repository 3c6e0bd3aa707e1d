"""Choices on the wizard's screen: what is offered, and at once what was chosen."""

from __future__ import annotations

from woz_tui.console.drawing.cells import clean
from woz_tui.console.state.event_sentences import EventContext, EventLine
from woz_tui.console.state.feature_notes import FeatureNotes, StudyNews
from woz_tui.features.choices.kinds import ChoiceGone, ChoiceMade, ChoiceOffered

_GONE = {
    "taken_back": "taken back",
    "replaced": "replaced",
    "moved_on": "not made before it went on",
    "reloaded": "taken back, as the file has changed",
    "end": "not made",
}


def _offered(message: ChoiceOffered, shown: EventContext) -> EventLine:
    asked = message.question or message.choice
    return EventLine("info", f"Offered: {asked}", ", ".join(message.options))


def _made(message: ChoiceMade, shown: EventContext) -> EventLine:
    return EventLine("heard", f"Chosen: {message.option}" if message.option else "Chosen")


def _gone(message: ChoiceGone, shown: EventContext) -> EventLine:
    return EventLine("info", f"Choice {_GONE.get(message.how, message.how)}", message.choice)


SENTENCES = {ChoiceOffered: _offered, ChoiceMade: _made, ChoiceGone: _gone}


class ChoiceNotes(FeatureNotes):
    """Says at once what was chosen: a wizard may be waiting for it."""

    hears = (ChoiceMade,)

    def apply(self, message: ChoiceMade) -> StudyNews | None:
        chosen = f" {clean(message.option)}" if message.option else ""
        return StudyNews(f"The participant chose{chosen}", "good")
