"""What a proposed sentence would be after the last ones: a repetition, one more question.

Models repeat themselves the more the longer a dialogue is, and push. Nothing is left out for it:
the wizard reads the mark, and decides.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from difflib import SequenceMatcher

from woz_tui.features.proposals.clean_text import is_question

#: Sentences that are looked at, from which likeness on one is a repetition, and from which share
#: of questions (the proposed one among them) one more is a mark.
LAST, LIKE, ASKING = 3, 0.75, 0.75
#: The marks.
REPEATS, ASKS_AGAIN = "repeats", "asks again"


class LastSentences:
    """The last sentences of the robot that everybody may read: marks tell nothing of others."""

    def __init__(self) -> None:
        self._said: deque[str] = deque(maxlen=LAST)

    def say(self, text: str) -> None:
        """The robot says this."""
        self._said.append(text)

    def likeness(self, text: str) -> float:
        """How like the likest of them it is, 0 to 1, by its words."""
        proposed = words(text)
        likest = (
            SequenceMatcher(None, words(said), proposed, autojunk=False).ratio()
            for said in self._said
        )
        return round(max(likest, default=0.0), 2)

    def asking(self, text: str) -> float:
        """The share of questions among them and this one."""
        texts = [*self._said, text]
        return round(sum(map(is_question, texts)) / len(texts), 2)

    def marks(self, text: str) -> list[str]:
        """What of it the wizard is to know."""
        found = [REPEATS] if self.likeness(text) >= LIKE else []
        if is_question(text) and len(self._said) == LAST and self.asking(text) >= ASKING:
            found.append(ASKS_AGAIN)
        return found


def words(text: str) -> Sequence[str]:
    """Without what stands between them."""
    plain = "".join(sign if sign.isalnum() else " " for sign in text.casefold())
    return plain.split()
