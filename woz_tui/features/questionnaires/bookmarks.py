"""Questionnaires on the time line of a replay."""

from __future__ import annotations

from woz_tui.features.questionnaires.kinds import QuestionnaireStarted
from woz_tui.protocol.sentence import Sentence
from woz_tui.replay.bookmarks import Bookmark, FeatureBookmarks


def _asked(message: QuestionnaireStarted, t: int) -> Bookmark:
    text = Sentence("replay.asked", "questionnaire {name}", name=message.questionnaire)
    return Bookmark(t, "questionnaire", text)


BOOKMARKS = FeatureBookmarks({QuestionnaireStarted: _asked})
