"""Questionnaires on the time line of a replay."""

from __future__ import annotations

from woz_tui.features.questionnaires.kinds import QuestionnaireStarted
from woz_tui.replay.bookmarks import Bookmark, FeatureBookmarks


def _asked(message: QuestionnaireStarted, t: int) -> Bookmark:
    return Bookmark(t, "questionnaire", f"questionnaire {message.questionnaire}")


BOOKMARKS = FeatureBookmarks({QuestionnaireStarted: _asked})
