"""What is asked of the participant around the scene of a study."""

from __future__ import annotations

from typing import Any

from tests.console.study_scene import NOW, ROBOT
from woz_tui.features.questionnaires.kinds import (
    AskQuestionnaire,
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r


def asks(questionnaire: dict[str, m.Json] = ROBOT, source: str = "wizard") -> r.Request:
    """The request that begins a questionnaire."""
    return AskQuestionnaire(questionnaire=str(questionnaire["name"]), source=source)


def questionnaire_started(
    questionnaire: dict[str, m.Json] = ROBOT, t: int = NOW
) -> QuestionnaireStarted:
    """A questionnaire begins."""
    items: Any = questionnaire["items"]
    return QuestionnaireStarted(
        questionnaire=str(questionnaire["name"]),
        title=str(questionnaire["title"]),
        items=items,
        t=t,
    )


def questionnaire_ended(
    name: str = "robot", reason: str = "done", count: int = 4
) -> QuestionnaireEnded:
    """It is over."""
    return QuestionnaireEnded(questionnaire=name, reason=reason, answered=count, t=NOW)


def questionnaire_answered(
    item: str, value: float | None = None, **more: Any
) -> QuestionnaireAnswered:
    """Somebody answers."""
    return QuestionnaireAnswered(
        questionnaire="robot", item=item, question=item, value=value, t=NOW, **more
    )
