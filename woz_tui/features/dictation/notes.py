"""Dictated texts that no field has got yet."""

from __future__ import annotations

from woz_tui.console.state.feature_notes import FeatureNotes, StudyNews
from woz_tui.features.dictation.kinds import Dictated
from woz_tui.timeline.session_state import SessionState


class DictatedTexts(FeatureNotes):
    """What waits for the field of `say`; `begun`: whether anything was dictated."""

    hears = (Dictated,)

    def __init__(self, session: SessionState) -> None:
        super().__init__(session)
        self.begun = False
        self.waiting: list[str] = []
        self._seen = 0

    def apply(self, message: Dictated) -> StudyNews | None:
        if message.dictation <= self._seen:
            return None
        self._seen, self.begun = message.dictation, True
        self.waiting.append(message.text)
        return StudyNews(f"Dictated: {message.text}", "good", command=("say", "look at it"))

    def take(self) -> str:
        """What waits, once."""
        text = " ".join(self.waiting)
        self.waiting.clear()
        return text
