"""Examples of what is said and asked of questionnaires, for the golden files of the protocol."""

from typing import Any

from woz_tui.console.state.console_state import ConsoleState
from woz_tui.features.questionnaires.console import questionnaires_of
from woz_tui.features.questionnaires.history import QuestionnaireHistory
from woz_tui.features.questionnaires.kinds import (
    AskAnswer,
    AskQuestionnaire,
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.protocol.envelope import Message
from woz_tui.protocol.messages import Json
from woz_tui.timeline.session_state import SessionState

MESSAGES = (
    QuestionnaireStarted(
        questionnaire="robot",
        title="How was the robot?",
        items=[
            {
                "name": "friendly",
                "question": "The robot was friendly.",
                "low": 1,
                "high": 7,
                "ends": ["not at all", "very much"],
            },
            {"name": "else", "question": "Anything else?", "text": True, "optional": True},
        ],
        trial=1,
        source="participant",
        language="en",
        given="self",
    ),
    QuestionnaireAnswered(
        questionnaire="robot",
        item="friendly",
        question="The robot was friendly.",
        value=6.0,
        answered_us=2_300_000,
    ),
    QuestionnaireAnswered(
        questionnaire="robot",
        item="else",
        question="Anything else?",
        text="it blinked",
        answered_us=8_100_000,
    ),
    QuestionnaireAnswered(
        questionnaire="robot",
        item="age",
        question="How old are you?",
        skipped=True,
        reason="prefer_not",
        given="own_terminal",
        private=True,
    ),
    QuestionnaireAnswered(
        questionnaire="robot",
        item="known",
        question="Which robots have you used?",
        ticked=[1, 6],
        text="a mower",
        answered_us=4_000_000,
        given="browser",
    ),
    QuestionnaireEnded(questionnaire="robot", reason="done", answered=2),
)
REQUESTS = (
    AskQuestionnaire(
        ref=25, questionnaire="robot", source="participant", language="en", given="self"
    ),
    AskQuestionnaire(ref=31, questionnaire="robot", what="declined"),
    AskAnswer(ref=26, questionnaire="robot", item="friendly", value=6.0, answered_us=2_300_000),
    AskAnswer(ref=27, questionnaire="robot", item="else", skipped=True, reason="prefer_not"),
    AskAnswer(ref=33, questionnaire="robot", item="known", ticked=[1, 6], given="browser"),
    AskAnswer(ref=32, questionnaire="robot", item="else", text="it blinked"),
)


def started(name: str) -> QuestionnaireStarted:
    """Two items, one of which is a scale."""
    items: list[dict[str, Json]] = [{"name": "a", "low": 1, "high": 7}, {"name": "b"}]
    return QuestionnaireStarted(questionnaire=name, title="?", items=items)


def answered(name: str, item: str) -> QuestionnaireAnswered:
    return QuestionnaireAnswered(questionnaire=name, item=item, question="?", value=3.0)


def ended(name: str, reason: str) -> QuestionnaireEnded:
    return QuestionnaireEnded(questionnaire=name, reason=reason, answered=1)


def known(state: SessionState) -> dict[str, object]:
    """What somebody must know who comes later."""
    asked = state.history(QuestionnaireHistory)
    answers = asked.questionnaire and asked.questionnaire.answers
    return {"answers": answers, "due": asked.due(state), "had": asked.had}


def shown(state: ConsoleState) -> tuple[object, ...]:
    """What a console knows."""
    asked = questionnaires_of(state)
    return asked.due, asked.open, {*asked.history.had}


def friendly(item: str, value: float | None = None, text: str = "") -> QuestionnaireAnswered:
    """An answer in the short visit."""
    return QuestionnaireAnswered(
        questionnaire="robot",
        item=item,
        question="It was friendly.",
        value=value,
        text=text,
        answered_us=500_000,
    )


def asked(
    name: str, title: str, item: dict[str, Json], trial: int = -1, **given: Any
) -> tuple[Message, ...]:
    """One item from its question to its answer."""
    own, question = str(item["name"]), str(item["question"])
    return (
        QuestionnaireStarted(questionnaire=name, title=title, items=[item], trial=trial),
        QuestionnaireAnswered(questionnaire=name, item=own, question=question, **given),
        QuestionnaireEnded(questionnaire=name, reason="done", answered=1),
    )


#: At the end of a short visit, by the second.
VISIT = (
    (
        9,
        QuestionnaireStarted(
            questionnaire="robot",
            title="?",
            items=[
                {"name": "friendly", "question": "It was friendly.", "low": 1, "high": 7},
                {"name": "else", "question": "Else?", "text": True},
            ],
        ),
    ),
    (9.5, friendly("friendly", value=5.0)),
    (9.6, friendly("friendly", value=6.0)),
    (9.7, friendly("else", text="-it blinked")),
    (10, QuestionnaireEnded(questionnaire="robot", reason="done", answered=2)),
)
ANSWERED = (QuestionnaireAnswered,)
ASKED = (asked,)
#: For sessions at random, and what holds of any log.
MAKERS = ({"started": started, "answered": answered, "ended": ended},)
KNOWN = (known,)
SHOWN = (shown,)
#: What no session that was recorded has without its beginning.
ENDS = (QuestionnaireEnded, QuestionnaireAnswered)
