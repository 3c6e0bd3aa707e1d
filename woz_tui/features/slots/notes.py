"""Words that can be put into a slot: those of what the visitor said or chose last."""

from __future__ import annotations

from woz_tui.console.state.feature_notes import FeatureNotes, StudyNews
from woz_tui.features.choices.kinds import ChoiceMade
from woz_tui.features.slots.slot_value import tidied
from woz_tui.protocol import messages as m
from woz_tui.timeline.session_state import SessionState


class HeardWords(FeatureNotes):
    """The last text that is not the robot's own, or what was chosen on a page since."""

    hears = (m.SpeechText, ChoiceMade)

    def __init__(self, session: SessionState) -> None:
        super().__init__(session)
        self.words: tuple[str, ...] = ()

    def apply(self, message: m.SpeechText | ChoiceMade) -> StudyNews | None:
        """What is kept from the wizard comes without letters. What was chosen is one word."""
        if isinstance(message, ChoiceMade):
            self.words = (tidied(message.option),) if message.option else self.words
        elif message.text and not message.own:
            self.words = words_of(message.text)
        return None

    def keep(self, before: HeardWords) -> None:
        self.words = self.words or before.words


def words_of(text: str) -> tuple[str, ...]:
    """Words without what stands around them, the longest first: it is seldom the article."""
    words = (tidied(word).strip(".,;:!?\"'()[]{}…¿¡„“”«»") for word in text.split())
    told = dict.fromkeys(word for word in words if any(map(str.isalnum, word)))
    return tuple(sorted(told, key=len, reverse=True))
