"""Dictated texts that have not been said yet."""

from __future__ import annotations

from woz_tui.config.screen_language import say
from woz_tui.console.state.feature_notes import FeatureNotes, StudyNews
from woz_tui.features.dictation.history import DictationHistory
from woz_tui.features.dictation.kinds import Dictated, DictationListens, DictationSaid
from woz_tui.timeline.session_state import SessionState

#: The id of the key that opens the field.
KEY = "dictate"


class DictatedTexts(FeatureNotes):
    """What the field gets: what was dictated while it is open, and of what came before the newest
    text at most.
    """

    hears = (Dictated, DictationSaid, DictationListens)

    def __init__(self, session: SessionState) -> None:
        super().__init__(session)
        self._unsaid: dict[int, str] = {}

    @property
    def listens(self) -> str:
        """The console on which the field is open; empty: on none."""
        listens = self.session.history(DictationHistory).listens
        return listens.console if listens is not None else ""

    def apply(self, message: Dictated | DictationSaid | DictationListens) -> StudyNews | None:
        match message:
            case DictationSaid(dictations=dictations):
                for number in dictations:
                    self._unsaid.pop(number, None)
            case DictationListens():
                self._unsaid = dict([*self._unsaid.items()][-1:])
            case Dictated(dictation=dictation, text=text):
                if self.listens:
                    self._unsaid[dictation] = text
                    return None  # it comes into the field that is open
                self._unsaid = {dictation: text}
                dictated = say("dictation.dictated", "Dictated: {text}", text=text)
                look = say("dictation.look", "look at it")
                return StudyNews(dictated, "good", command=(KEY, look))
        return None

    def after(self, number: int) -> dict[int, str]:
        """Texts that came after the one of this number and have not been said."""
        return {each: text for each, text in self._unsaid.items() if each > number}
