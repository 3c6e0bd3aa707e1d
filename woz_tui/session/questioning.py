"""Questionnaires in the robot process: what is an answer, and when a questionnaire may begin."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from woz_tui.core import messages as m
from woz_tui.core.requests import AskAnswer
from woz_tui.session.identity import AskError
from woz_tui.session.progress import Progress

#: Characters of the longest answer in words.
LONGEST = 10_000
#: Who may put a questionnaire only when it is due.
PARTICIPANT = "participant"


class Questioning:
    """One questionnaire at a time, from its beginning to its end: a round.

    Args:
        progress: Knows what is due, under way and answered.
        publish: Publishes a message of the session.
    """

    def __init__(self, progress: Progress, publish: Callable[[m.AnyMessage], object]) -> None:
        self._progress = progress
        self._publish = publish

    def ask(self, name: str, what: str, source: str) -> None:
        """Begin a questionnaire, or end the one under way; `what` as in `AskQuestionnaire`."""
        if what == "begin":
            self._begin(name, source)
            return
        asking = self._asking(name)
        if what == "done":
            self._all_answered(asking)
        self._end(asking, what)

    def leave(self) -> None:
        """End what is under way, because the session ends."""
        if self._progress.asking is not None:
            self._end(self._progress.asking, "left")

    def _begin(self, name: str, source: str) -> None:
        asking = self._progress.asking
        if asking is not None:
            raise AskError(
                f"the questionnaire {asking.questionnaire!r} is under way", "end it first"
            )
        known = {str(each["name"]): each for each in self._progress.questionnaires()}
        if name not in known:
            raise AskError(
                f"there is no questionnaire {name!r}",
                f"there are {', '.join(known)}" if known else "the file has none",
            )
        if source == PARTICIPANT and name not in [due.questionnaire for due in self._progress.due]:
            raise AskError(f"the questionnaire {name!r} is not due yet", "the wizard can begin it")
        self._publish(
            m.QuestionnaireStarted(
                questionnaire=name,
                title=str(known[name]["title"]),
                items=[dict(item) for item in known[name]["items"]],
                trial=self._progress.trial_of(name),
                source=source,
            )
        )

    def _asking(self, name: str) -> m.QuestionnaireStarted:
        asking = self._progress.asking
        if asking is None or asking.questionnaire != name:
            other = f"{asking.questionnaire!r} is" if asking is not None else "none is"
            raise AskError(f"the questionnaire {name!r} is not under way", other)
        return asking

    def _all_answered(self, asking: m.QuestionnaireStarted) -> None:
        answers = self._progress.answers
        absent = [
            item
            for item in asking.items
            if not item.get("optional") and item["name"] not in answers
        ]
        if absent:
            count = f"{len(absent)} item{'s have' if len(absent) > 1 else ' has'} no answer yet"
            names = ", ".join(str(item["name"]) for item in absent[:5])
            raise AskError(f"{count}: {names}{', ...' if len(absent) > 5 else ''}")

    def _end(self, asking: m.QuestionnaireStarted, reason: str) -> None:
        answered = sum(not answer.skipped for answer in self._progress.answers.values())
        self._publish(
            m.QuestionnaireEnded(
                questionnaire=asking.questionnaire, reason=reason, answered=answered
            )
        )

    # -- answers -----------------------------------------------------------------------------------

    def answer(self, request: AskAnswer) -> None:
        """One answer; a later one to the same item takes its place."""
        asking = self._asking(request.questionnaire)
        items = {str(item["name"]): item for item in asking.items}
        if request.item not in items:
            raise AskError(f"there is no item {request.item!r}", f"there are {', '.join(items)}")
        item = items[request.item]
        if request.skipped:
            _check_skipped(request, item)
        elif item.get("text"):
            _check_text(request)
        else:
            _check_value(request, item)
        self._publish(
            m.QuestionnaireAnswered(
                questionnaire=request.questionnaire,
                item=request.item,
                question=str(item["question"]),
                value=request.value,
                text=request.text,
                answered_us=max(request.answered_us, -1),
                skipped=request.skipped,
            )
        )


def _check_skipped(request: AskAnswer, item: Mapping[str, Any]) -> None:
    if not item.get("optional"):
        raise AskError(f"{request.item!r} wants an answer", "or end it as declined")
    if request.value is not None or request.text:
        raise AskError("what is left out has no answer")


def _check_text(request: AskAnswer) -> None:
    if request.value is not None:
        raise AskError(f"{request.item!r} is answered in words")
    if not request.text.strip():
        raise AskError("the answer is empty")
    if len(request.text) > LONGEST:
        raise AskError(f"an answer has {LONGEST} characters at most")


def _check_value(request: AskAnswer, item: Mapping[str, Any]) -> None:
    low, high = int(item["low"]), int(item["high"])
    if request.text:
        raise AskError(f"{request.item!r} is answered with a number")
    value = request.value
    if value is None or value != round(value) or not low <= value <= high:
        raise AskError(f"expected a whole number from {low} to {high}, not {value}")
