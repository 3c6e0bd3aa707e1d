"""Begins and ends questionnaires, and checks and publishes their answers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec

from woz_tui.features.questionnaires.answers import answer_told, items_of
from woz_tui.features.questionnaires.history import QuestionnaireHistory
from woz_tui.features.questionnaires.items import (
    GIVEN,
    LONGEST,
    NUMBERS,
    POINTS,
    SKIPPED,
    ItemAnswer,
    arranged,
    asked_items,
    in_language,
    problem_of,
    ways_out,
    wording,
)
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
from woz_tui.protocol.sentence import Sentence
from woz_tui.protocol.welcome import Questionnaire, QuestionnaireItem
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
            self.answer(request, "own_terminal" if client.role == PARTICIPANT else "")
        else:
            source = _source(request, client)
            given = "" if source == PARTICIPANT else request.given
            self.begin_or_end(request.questionnaire, request.what, source, request.language, given)
        return ""

    def allow_next(self) -> None:
        """One that is open belongs to the trial and the participant of its beginning."""
        if (current := self._history.questionnaire) is not None:
            raise RequestError(
                Sentence(
                    "questionnaires.open",
                    "the questionnaire {name!r} is open",
                    name=current.name,
                ),
                Sentence("study.end_trial", "end it first"),
                command="trial",
            )

    def begin_or_end(
        self, name: str, what: str, source: str, language: str = "", given: str = ""
    ) -> None:
        """Begin a questionnaire, or end the one under way; `what` as in `AskQuestionnaire`."""
        if what == "begin":
            self._begin(name, source, language, given)
            return
        self._under_way(name)
        if what == "done":
            self._all_answered()
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
                text=Sentence(
                    "questionnaires.unanswered",
                    "{participant} has not answered: {named}",
                    participant=participant,
                    named=named,
                ),
                remedy=Sentence(
                    "questionnaires.on_paper",
                    "ask it on paper: the log would have the answers in the condition of the next"
                    " trial",
                ),
            )
        )

    def close(self) -> None:
        if (current := self._history.questionnaire) is not None:
            self._end(current.name, "left")

    def _begin(self, name: str, source: str, language: str, given: str) -> None:
        current = self._history.questionnaire
        if current is not None:
            raise RequestError(
                Sentence(
                    "questionnaires.open",
                    "the questionnaire {name!r} is open",
                    name=current.name,
                ),
                Sentence("study.end_trial", "end it first"),
            )
        known = {each.name: each for each in self.session.state.study.settings.questionnaires}
        if name not in known:
            raise RequestError(
                Sentence(
                    "questionnaires.unknown",
                    "there is no questionnaire {name!r}",
                    name=name,
                ),
                Sentence("gate.there_are", "there are {names}", names=", ".join(known))
                if known
                else Sentence("questionnaires.none_in_file", "the file has no questionnaires"),
            )
        due = {each.questionnaire: each.trial for each in self._history.due(self.session.state)}
        if source == PARTICIPANT and name not in due:
            raise RequestError(
                Sentence(
                    "questionnaires.not_due",
                    "the questionnaire {name!r} is not due yet",
                    name=name,
                ),
                Sentence("questionnaires.wizard_starts", "the wizard can start it"),
            )
        asked = self._in_language(known[name], language)
        if given and given not in GIVEN:
            raise RequestError(
                Sentence(
                    "questionnaires.given_by_nobody", "nobody answers by {given!r}", given=given
                ),
                Sentence("gate.there_are", "there are {names}", names=", ".join(GIVEN)),
            )
        running = self.session.state.study.trial
        trial = running.started.trial if running is not None else -1
        self._publish(
            QuestionnaireStarted(
                questionnaire=name,
                title=asked.title,
                items=[*map(_item_view, arranged(asked, self._seed(name)))],
                trial=due.get(name, trial),
                source=source,
                language=asked.language,
                given=given,
            )
        )

    def _in_language(self, asked: Questionnaire, language: str) -> Questionnaire:
        found = in_language(asked, language)
        if language and language != found.language:
            codes = filter(None, [asked.language, *(each.language for each in asked.versions)])
            there = (
                Sentence("gate.there_are", "there are {names}", names=", ".join(codes))
                if asked.versions
                else Sentence("questionnaires.one_language", "it has one only")
            )
            raise RequestError(
                Sentence(
                    "questionnaires.no_language",
                    "{name!r} is not in the language {language!r}",
                    name=asked.name,
                    language=language,
                ),
                there,
            )
        return found

    def _seed(self, name: str) -> str:
        """Of the order of items: another one for each participant and each round."""
        participant = self.session.state.study.participant or ""
        number = self._history.rounds_begun[name] + 1
        return f"{self.session.identity.seed}/{participant}/{name}/{number}"

    def _under_way(self, name: str) -> QuestionnaireStarted:
        current = self._history.questionnaire
        if current is None or current.started is None or current.name != name:
            other = (
                Sentence("questionnaires.is_open", "{name!r} is", name=current.name)
                if current is not None
                else Sentence("questionnaires.none_open", "none is")
            )
            raise RequestError(
                Sentence(
                    "questionnaires.not_open",
                    "the questionnaire {name!r} is not open",
                    name=name,
                ),
                other,
            )
        return current.started

    @property
    def _answers(self) -> Mapping[str, QuestionnaireAnswered]:
        current = self._history.questionnaire
        return current.answers if current is not None else {}

    def _all_answered(self) -> None:
        asked = asked_items(self._items, self._given_answers)
        absent = [
            item.name
            for item in asked
            if not (item.optional or item.soft or item.asks == "page")
            and item.name not in self._answers
        ]
        if absent:
            raise RequestError(
                Sentence(
                    "questionnaires.no_answer_yet",
                    "{count} items have no answer yet: {names}",
                    one="1 item has no answer yet: {names}",
                    count=len(absent),
                    names=", ".join(absent[:5] + ["..."] * (len(absent) > 5)),
                )
            )

    @property
    def _items(self) -> tuple[QuestionnaireItem, ...]:
        """Of the questionnaire under way."""
        current = self._history.questionnaire
        started = current.started if current is not None else None
        return items_of(started.items) if started is not None else ()

    @property
    def _given_answers(self) -> Mapping[str, ItemAnswer]:
        return {name: answer_told(told) for name, told in self._answers.items()}

    def _end(self, name: str, reason: str) -> None:
        answered = sum(not answer.skipped for answer in self._answers.values())
        self._publish(QuestionnaireEnded(questionnaire=name, reason=reason, answered=answered))

    # -- answers -----------------------------------------------------------------------------------

    def answer(self, request: AskAnswer, given: str = "") -> None:
        """One answer; a later one to the same item takes its place. `given`: by whom, where the
        request does not say it.
        """
        started = self._under_way(request.questionnaire)
        items = {item.name: item for item in self._items}
        if request.item not in items:
            raise RequestError(
                Sentence(
                    "questionnaires.no_item",
                    "there is no item {item!r}",
                    item=request.item,
                ),
                Sentence("gate.there_are", "there are {names}", names=", ".join(items)),
            )
        item = items[request.item]
        if item not in asked_items(items.values(), self._given_answers):
            raise RequestError(
                Sentence("questionnaires.not_asked", "{item!r} is not asked", item=request.item),
                Sentence("questionnaires.ruled_out", "an earlier answer has ruled it out"),
            )
        if request.skipped:
            _check_skipped(request, item)
        else:
            _check_answer(request, item)
        self._publish(
            QuestionnaireAnswered(
                questionnaire=request.questionnaire,
                item=request.item,
                question=wording(item),
                value=request.value,
                text=request.text,
                answered_us=max(request.answered_us, -1),
                skipped=request.skipped,
                ticked=request.ticked,
                reason=request.reason,
                given=(request.given if request.given in GIVEN else given) or started.given,
                private=item.private,
            )
        )


def _source(request: AskQuestionnaire, client: Client) -> str:
    """Who puts or ends it: a wizard's console says itself what a person used of it."""
    if client.role == PARTICIPANT:
        return PARTICIPANT
    if client.role == "program" and request.source == "wizard":
        return "program"
    return request.source


#: What an item has only in some kinds.
_OF_KINDS = {"low": NUMBERS, "high": NUMBERS, "ends": POINTS, "text": ("text",)}


def _item_view(item: QuestionnaireItem) -> dict[str, Any]:
    """An item as in `questionnaire.started`: a scale's points and ends, or `text`."""
    seen: dict[str, Any] = msgspec.json.decode(msgspec.json.encode(item))
    for name, kinds in _OF_KINDS.items():
        if item.asks not in kinds:
            del seen[name]
    if not item.optional:
        del seen["optional"]
    return seen


def _check_skipped(request: AskAnswer, item: QuestionnaireItem) -> None:
    reason = request.reason or SKIPPED
    if reason not in ways_out(item):
        text = (
            Sentence(
                "questionnaires.no_such_way", "{item!r} does not offer that", item=request.item
            )
            if request.reason
            else Sentence(
                "questionnaires.needs_answer", "{item!r} needs an answer", item=request.item
            )
        )
        raise RequestError(
            text,
            Sentence("questionnaires.or_decline", "or end it as declined"),
        )
    if request.value is not None or request.ticked or request.text:
        raise RequestError(
            Sentence("questionnaires.skipped_with_answer", "a skipped item cannot have an answer")
        )


def _check_answer(request: AskAnswer, item: QuestionnaireItem) -> None:
    value = request.value
    if request.reason:
        raise RequestError(
            Sentence(
                "questionnaires.answer_with_reason",
                "an answer cannot have a reason why there is none",
            )
        )
    if len(request.text) > LONGEST:
        raise RequestError(
            Sentence(
                "questionnaires.too_long",
                "an answer can have at most {longest} characters",
                longest=LONGEST,
            )
        )
    if item.asks in ("text", "month"):
        if value is not None or request.ticked:
            raise RequestError(
                Sentence(
                    "questionnaires.needs_text",
                    "{item!r} needs a text as its answer",
                    item=request.item,
                )
            )
        if not request.text.strip():
            raise RequestError(Sentence("questionnaires.empty", "the answer is empty"))
    elif item.asks in NUMBERS and (request.text or request.ticked):
        raise RequestError(
            Sentence(
                "questionnaires.needs_number",
                "{item!r} needs a number as its answer",
                item=request.item,
            )
        )
    elif value is not None and value != round(value):
        raise RequestError(
            Sentence(
                "questionnaires.out_of_range",
                "expected a whole number from {low} to {high}, not {value}",
                low=item.low,
                high=item.high,
                value=value,
            )
        )
    if wrong := problem_of(item, answer_told(request)):
        raise RequestError(wrong)
