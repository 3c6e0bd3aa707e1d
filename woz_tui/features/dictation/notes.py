"""Dictated texts that have not been said yet."""

from __future__ import annotations

from woz_tui.config.screen_language import say
from woz_tui.console.state.feature_notes import FeatureNotes, StudyNews
from woz_tui.features.dictation.kinds import Dictated, DictationSaid
from woz_tui.timeline.session_state import SessionState


class DictatedTexts(FeatureNotes):
    """What the field of `say` gets; `begun`: whether anything was dictated."""

    hears = (Dictated, DictationSaid)

    def __init__(self, session: SessionState) -> None:
        super().__init__(session)
        self.begun = False
        self._unsaid: dict[int, str] = {}

    def apply(self, message: Dictated | DictationSaid) -> StudyNews | None:
        if isinstance(message, DictationSaid):
            for number in message.dictations:
                self._unsaid.pop(number, None)
            return None
        self.begun = True
        self._unsaid[message.dictation] = message.text
        dictated = say("dictation.dictated", "Dictated: {text}", text=message.text)
        look = say("dictation.look", "look at it")
        return StudyNews(dictated, "good", command=("say", look))

    def after(self, number: int) -> dict[int, str]:
        """Texts that came after the one of this number and have not been said."""
        return {each: text for each, text in self._unsaid.items() if each > number}
