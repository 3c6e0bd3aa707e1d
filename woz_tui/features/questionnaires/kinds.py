"""What is said and asked of questionnaires in the log and on the socket."""

from __future__ import annotations

from typing import Any, Literal

import msgspec

from woz_tui.protocol.envelope import Message
from woz_tui.protocol.kinds import FeatureKinds
from woz_tui.protocol.requests import Request


class QuestionnaireStarted(Message, frozen=True, kw_only=True, tag="questionnaire.started"):
    """A questionnaire is put to the participant. `items` are as in the experiment file: `name`,
    `question`, and for a scale `low`, `high` and what its ends are called.
    """

    questionnaire: str
    title: str
    items: list[dict[str, Any]]
    trial: int = -1
    source: str = msgspec.field(default_factory=lambda: "wizard")


class QuestionnaireAnswered(Message, frozen=True, kw_only=True, tag="questionnaire.answered"):
    """One answer: a number on the item's scale, or a text. A later answer to the same item of the
    same round replaces it. `answered_us`: from the item's being shown. `skipped`: left out on
    purpose.
    """

    questionnaire: str
    item: str
    question: str
    value: float | None = None
    text: str = ""
    answered_us: int = -1
    skipped: bool = False


class QuestionnaireEnded(Message, frozen=True, kw_only=True, tag="questionnaire.ended"):
    """It is over: `reason` is done, declined (the participant did not want to) or left."""

    questionnaire: str
    reason: str
    answered: int


class AskQuestionnaire(Request, frozen=True, kw_only=True, tag="questionnaire"):
    """Begin a questionnaire of the experiment file, or end the one that is under way."""

    questionnaire: str
    what: Literal["begin", "done", "declined", "left"] = "begin"
    source: str = "wizard"


class AskAnswer(Request, frozen=True, kw_only=True, tag="answer"):
    """Answer one item of the questionnaire that is under way, or leave it out."""

    questionnaire: str
    item: str
    value: float | None = None
    text: str = ""
    answered_us: int = -1
    skipped: bool = False


_MESSAGES = (QuestionnaireStarted, QuestionnaireAnswered, QuestionnaireEnded)

KINDS = FeatureKinds(
    messages=_MESSAGES,
    requests=(AskQuestionnaire, AskAnswer),
    open=_MESSAGES,
    for_participants=_MESSAGES,
)
