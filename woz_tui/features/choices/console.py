"""Choices on the wizard's screen: what is offered, and at once what was chosen."""

from __future__ import annotations

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import clean
from woz_tui.console.state.event_sentences import EventContext, EventLine
from woz_tui.console.state.feature_notes import FeatureNotes, StudyNews
from woz_tui.features.choices.kinds import ChoiceGone, ChoiceMade, ChoiceOffered
from woz_tui.protocol.sentence import Sentence

_GONE = {
    "taken_back": Sentence("choices.taken_back", "Choice taken back"),
    "replaced": Sentence("choices.replaced", "Choice replaced"),
    "moved_on": Sentence("choices.moved_on", "Choice not made before it went on"),
    "reloaded": Sentence("choices.reloaded", "Choice taken back, as the file has changed"),
    "end": Sentence("choices.not_made", "Choice not made"),
}


def _offered(message: ChoiceOffered, shown: EventContext) -> EventLine:
    asked = message.question or message.choice
    offered = say("choices.offered", "Offered: {question}", question=asked)
    return EventLine("info", offered, ", ".join(message.options))


def _made(message: ChoiceMade, shown: EventContext) -> EventLine:
    chosen = (
        say("choices.chosen", "Chosen: {option}", option=message.option)
        if message.option
        else say("choices.made", "Chosen")
    )
    return EventLine("heard", chosen)


def _gone(message: ChoiceGone, shown: EventContext) -> EventLine:
    known = _GONE.get(message.how)
    gone = (
        word(known) if known is not None else say("choices.gone", "Choice {how}", how=message.how)
    )
    return EventLine("info", gone, message.choice)


SENTENCES = {ChoiceOffered: _offered, ChoiceMade: _made, ChoiceGone: _gone}


class ChoiceNotes(FeatureNotes):
    """Says at once what was chosen: a wizard may be waiting for it."""

    hears = (ChoiceMade,)

    def apply(self, message: ChoiceMade) -> StudyNews | None:
        option = clean(message.option)
        chose = (
            say("choices.participant_chose", "The participant chose {option}", option=option)
            if message.option
            else say("choices.participant_has_chosen", "The participant chose")
        )
        return StudyNews(chose, "good")
