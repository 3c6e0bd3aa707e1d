"""Begins and ends questionnaires, and checks and publishes their answers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from woz_tui.features.questionnaires.history import QuestionnaireHistory
from woz_tui.features.questionnaires.kinds import (
    AskAnswer,
    AskQuestionnaire,
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.requesters import PARTICIPANT
from woz_tui.protocol.welcome import LONGEST, QuestionnaireItem
from woz_tui.session.session_features import Client, FeatureSession, SessionFeature
from woz_tui.timeline.feature_history import Owed


class QuestionnaireController(SessionFeature):
    """Runs one questionnaire at a time."""

    requests = (AskQuestionnaire, AskAnswer)

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        self._publish = session.hub.publish

    @property
    def _history(self) -> QuestionnaireHistory:
        return self.session.state.history(QuestionnaireHistory)

    def carry_out(self, request: AskQuestionnaire | AskAnswer, client: Client) -> str:
        if isinstance(request, AskAnswer):
            self.answer(request)
        else:
            self.begin_or_end(request.questionnaire, request.what, _source(request, client))
        return ""

    def allow_next(self) -> None:
        """One that is open belongs to the trial and the participant of its beginning."""
        if (current := self._history.questionnaire) is not None:
            raise RequestError(
                f"the questionnaire {current.name!r} is open", "end it first", command="trial"
            )

    def begin_or_end(self, name: str, what: str, source: str) -> None:
        """Begin a questionnaire, or end the one under way; `what` as in `AskQuestionnaire`."""
        if what == "begin":
            self._begin(name, source)
            return
        started = self._under_way(name)
        if what == "done":
            self._all_answered(started)
        self._end(name, what)

    def tell_owed(self, participant: str, owed: Owed) -> None:
        """Nothing is due in a session that begins."""
        due = owed.get(QuestionnaireHistory, ())
        if not due or self._history.due(self.session.state):
            return
        asked = self.session.state.study.settings.questionnaires
        titles = {each.name: each.heading for each in asked}
        named = ", ".join(titles.get(name, name) for name in due)
        self._publish(
            m.Notice(
                level="warning",
                text=f"{participant} has not answered: {named}",
                remedy="ask it on paper: the log would have the answers in the condition of the"
                " next trial",
            )
        )

    def close(self) -> None:
        if (current := self._history.questionnaire) is not None:
            self._end(current.name, "left")

    def _begin(self, name: str, source: str) -> None:
        current = self._history.questionnaire
        if current is not None:
            raise RequestError(f"the questionnaire {current.name!r} is open", "end it first")
        known = {each.name: each for each in self.session.state.study.settings.questionnaires}
        if name not in known:
            raise RequestError(
                f"there is no questionnaire {name!r}",
                f"there are {', '.join(known)}" if known else "the file has no questionnaires",
            )
        due = {each.questionnaire: each.trial for each in self._history.due(self.session.state)}
        if source == PARTICIPANT and name not in due:
            raise RequestError(
                f"the questionnaire {name!r} is not due yet", "the wizard can start it"
            )
        running = self.session.state.study.trial
        trial = running.started.trial if running is not None else -1
        self._publish(
            QuestionnaireStarted(
                questionnaire=name,
                title=known[name].title,
                items=[*map(_item_view, known[name].items)],
                trial=due.get(name, trial),
                source=source,
            )
        )

    def _under_way(self, name: str) -> QuestionnaireStarted:
        current = self._history.questionnaire
        if current is None or current.started is None or current.name != name:
            other = f"{current.name!r} is" if current is not None else "none is"
            raise RequestError(f"the questionnaire {name!r} is not open", other)
        return current.started

    @property
    def _answers(self) -> Mapping[str, QuestionnaireAnswered]:
        current = self._history.questionnaire
        return current.answers if current is not None else {}

    def _all_answered(self, started: QuestionnaireStarted) -> None:
        answers = self._answers
        absent = [
            item
            for item in started.items
            if not item.get("optional") and item["name"] not in answers
        ]
        if absent:
            count = f"{len(absent)} item{'s have' if len(absent) > 1 else ' has'} no answer yet"
            names = ", ".join(str(item["name"]) for item in absent[:5])
            raise RequestError(f"{count}: {names}{', ...' if len(absent) > 5 else ''}")

    def _end(self, name: str, reason: str) -> None:
        answered = sum(not answer.skipped for answer in self._answers.values())
        self._publish(QuestionnaireEnded(questionnaire=name, reason=reason, answered=answered))

    # -- answers -----------------------------------------------------------------------------------

    def answer(self, request: AskAnswer) -> None:
        """One answer; a later one to the same item takes its place."""
        started = self._under_way(request.questionnaire)
        items = {str(item["name"]): item for item in started.items}
        if request.item not in items:
            raise RequestError(
                f"there is no item {request.item!r}", f"there are {', '.join(items)}"
            )
        item = items[request.item]
        if request.skipped:
            _check_skipped(request, item)
        elif item.get("text"):
            _check_text(request)
        else:
            _check_value(request, item)
        self._publish(
            QuestionnaireAnswered(
                questionnaire=request.questionnaire,
                item=request.item,
                question=str(item["question"]),
                value=request.value,
                text=request.text,
                answered_us=max(request.answered_us, -1),
                skipped=request.skipped,
            )
        )


def _source(request: AskQuestionnaire, client: Client) -> str:
    """Who puts or ends it: a wizard's console says itself what a person used of it."""
    if client.role == PARTICIPANT:
        return PARTICIPANT
    if client.role == "program" and request.source == "wizard":
        return "program"
    return request.source


def _item_view(item: QuestionnaireItem) -> dict[str, Any]:
    """An item as in `questionnaire.started`: a scale's points and ends, or `text`."""
    seen: dict[str, Any] = {"name": item.name, "question": item.question}
    if item.text:
        seen["text"] = True
    else:
        seen |= {"low": item.low, "high": item.high, "ends": [*item.ends]}
    return {**seen, "optional": True} if item.optional else seen


def _check_skipped(request: AskAnswer, item: Mapping[str, Any]) -> None:
    if not item.get("optional"):
        raise RequestError(f"{request.item!r} needs an answer", "or end it as declined")
    if request.value is not None or request.text:
        raise RequestError("a skipped item cannot have an answer")


def _check_text(request: AskAnswer) -> None:
    if request.value is not None:
        raise RequestError(f"{request.item!r} needs a text as its answer")
    if not request.text.strip():
        raise RequestError("the answer is empty")
    if len(request.text) > LONGEST:
        raise RequestError(f"an answer can have at most {LONGEST} characters")


def _check_value(request: AskAnswer, item: Mapping[str, Any]) -> None:
    low, high = int(item["low"]), int(item["high"])
    if request.text:
        raise RequestError(f"{request.item!r} needs a number as its answer")
    value = request.value
    if value is None or value != round(value) or not low <= value <= high:
        raise RequestError(f"expected a whole number from {low} to {high}, not {value}")
