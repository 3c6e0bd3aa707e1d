"""What is said and asked of questionnaires in the log and on the socket."""

from __future__ import annotations

from typing import Any, Literal

import msgspec

from woz_tui.protocol.envelope import Message
from woz_tui.protocol.kinds import FeatureKinds
from woz_tui.protocol.requests import Request


class QuestionnaireStarted(Message, frozen=True, kw_only=True, tag="questionnaire.started"):
    """A questionnaire is put to the participant. `items` are as in the experiment file, in the
    order in which they are shown: `name`, `question`, and for a scale `low`, `high` and what its
    ends are called (`flipped`: the high one stood on the left). `language`: in which of several it
    is asked. `given`: by whom, if that is known (self, read_aloud).
    """

    questionnaire: str
    title: str
    items: list[dict[str, Any]]
    trial: int = -1
    source: str = msgspec.field(default_factory=lambda: "wizard")
    language: str = ""
    given: str = ""


class QuestionnaireAnswered(Message, frozen=True, kw_only=True, tag="questionnaire.answered"):
    """One answer: a number (of the item's scale, or a choice's), several of them (`ticked`) or a
    text. A later answer to the same item of the same round replaces it. `answered_us`: from the
    item's being shown. `skipped`: left out on purpose, because of the `reason` (does_not_apply,
    prefer_not; empty: none). `given`: by whom (self: at the wizard's screen, read_aloud,
    own_terminal, browser; empty: nobody knows). `private`: it is in no export unasked.
    """

    questionnaire: str
    item: str
    question: str
    value: float | None = None
    text: str = ""
    answered_us: int = -1
    skipped: bool = False
    ticked: list[int] = []
    reason: str = ""
    given: str = ""
    private: bool = False


class QuestionnaireEnded(Message, frozen=True, kw_only=True, tag="questionnaire.ended"):
    """It is over: `reason` is done, declined (the participant did not want to) or left."""

    questionnaire: str
    reason: str
    answered: int


class AskQuestionnaire(Request, frozen=True, kw_only=True, tag="questionnaire"):
    """Begin a questionnaire of the experiment file, or end the one that is under way. `language`:
    in one of several that it has; `given`: self (at the wizard's screen), read_aloud.
    """

    questionnaire: str
    what: Literal["begin", "done", "declined", "left"] = "begin"
    source: str = "wizard"
    language: str = ""
    given: str = ""


class AskAnswer(Request, frozen=True, kw_only=True, tag="answer"):
    """Answer one item of the questionnaire that is under way, or leave it out; as in
    `questionnaire.answered`.
    """

    questionnaire: str
    item: str
    value: float | None = None
    text: str = ""
    answered_us: int = -1
    skipped: bool = False
    ticked: list[int] = []
    reason: str = ""
    given: str = ""


_MESSAGES = (QuestionnaireStarted, QuestionnaireAnswered, QuestionnaireEnded)

KINDS = FeatureKinds(
    messages=_MESSAGES,
    requests=(AskQuestionnaire, AskAnswer),
    open=_MESSAGES,
    for_participants=_MESSAGES,
)
