"""What was asked and answered in sessions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from woz_tui.analysis.event_rows import ContextRow, context_fields
from woz_tui.analysis.feature_figures import FeatureFigures, Instant
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.analysis.text_format import NONE, counted, duration, times
from woz_tui.features.questionnaires.history import (
    QuestionnaireEpisode,
    QuestionnaireHistory,
    UnansweredEpisode,
)
from woz_tui.timeline import episodes as e
from woz_tui.timeline.timeline import Timeline


@dataclass(frozen=True, slots=True, kw_only=True)
class AnswerRow(ContextRow):
    """The last answer to an item in one round of a questionnaire; `t` is when it was given.

    `value` is None for texts and for what was left out; `low` and `high` are None unless the item
    is a scale, and `ends` says what they are called.
    """

    questionnaire: str
    round: int
    item: str
    question: str
    value: float | None
    text: str
    skipped: bool
    t: int
    answered_us: int | None
    low: float | None = None
    high: float | None = None
    ends: tuple[str, str] = ("", "")


@dataclass(frozen=True, slots=True)
class RoundRow:
    """A questionnaire put to somebody once. `reason`: done, declined, left; empty: no end.
    `condition` and `counted` are as of its answers; `asked` names its items.
    """

    questionnaire: str
    round: int
    title: str
    t: int
    reason: str
    answered: int
    items: int
    participant: str = ""
    condition: str = ""
    counted: bool = True
    asked: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class QuestionnaireFigures:
    """What was asked in a session. `unanswered`: titles of questionnaires that were due and neither
    answered nor declined, and after which trial.
    """

    answers: tuple[AnswerRow, ...] = ()
    rounds: tuple[RoundRow, ...] = ()
    unanswered: tuple[str, ...] = ()


NOTHING = QuestionnaireFigures()


def asked_in(figures: SessionFigures) -> QuestionnaireFigures:
    """What was asked in a session."""
    found: QuestionnaireFigures = figures.features.get("questionnaires", NOTHING)
    return found


def answer_table(figures: QuestionnaireFigures) -> ReportTable:
    """What was answered to questionnaires."""
    rows = [
        (
            *(LogText(answer.item), LogText(answer.question)),
            "left out"
            if answer.skipped
            else LogText(answer.text if answer.value is None else f"{answer.value:g}"),
            *(scale_text(answer.low, answer.high), duration(answer.answered_us)),
            *(LogText(answer.questionnaire), str(answer.round)),
            *(LogText(answer.condition), NONE if answer.trial < 0 else str(answer.trial)),
        )
        for answer in figures.answers
    ]
    heads = ["Item", "Question", "Answer", "Scale", "After"]
    heads += ["Questionnaire", "Round", "Condition", "Trial"]
    return ReportTable("Questionnaires", heads, rows, words=4, on_terminal=4)


def scale_text(low: float | None, high: float | None) -> str:
    """`1 to 7`."""
    return NONE if low is None or high is None else f"{low:g} to {high:g}"


# -- one session -----------------------------------------------------------------------------------


class CountedQuestionnaires(FeatureFigures):
    """Rounds and their answers."""

    def count(self, timeline: Timeline) -> QuestionnaireFigures | None:
        found = QuestionnaireFigures(
            tuple(answers(timeline)), tuple(rounds(timeline)), tuple(unanswered(timeline))
        )
        return found if found != NOTHING else None

    def busy(self, figures: QuestionnaireFigures) -> Collection[str]:
        return {answer.participant for answer in figures.answers}

    def narrowed(
        self, figures: QuestionnaireFigures, people: Collection[str]
    ) -> QuestionnaireFigures:
        return replace(
            figures,
            answers=tuple(
                each if each.participant in people else replace(each, counted=False)
                for each in figures.answers
            ),
        )

    def values(self, name: str, figures: QuestionnaireFigures | None) -> Mapping[str, Any]:
        found = figures or NOTHING
        return {
            "answers": found.answers,
            "rounds": found.rounds,
            "unanswered": found.unanswered,
        }

    def circumstances(self, figures: QuestionnaireFigures) -> Iterator[str]:
        for title in figures.unanswered:
            yield f"{title}: due and not answered"
        for each in figures.rounds:
            items = f" of {each.items}" if each.items else ""
            ended = each.reason or "no end in the log"
            yield f"{each.title or each.questionnaire}: {each.answered}{items} answered, {ended}"

    def attended(self, sessions: Sequence[QuestionnaireFigures]) -> Iterator[str]:
        given: Counter[str] = Counter()
        declined = 0
        for figures in sessions:
            for each in figures.rounds:
                given[each.title or each.questionnaire] += 1
                declined += each.reason == "declined"
        for name, count in given.items():
            yield f"The questionnaire {name} was given {times(count)}."
        if declined:
            yield f"Participants declined {counted(declined, 'questionnaire')}."

    def tables(self, figures: QuestionnaireFigures) -> Iterator[ReportTable]:
        yield answer_table(figures)

    def instant(self, episode: e.Episode) -> Instant | None:
        if not isinstance(episode, QuestionnaireEpisode) or episode.started is None:
            return None
        return Instant(episode.begin, episode.started.title or episode.name, "questionnaire")


FIGURES = CountedQuestionnaires()


def rounds(timeline: Timeline) -> Iterator[RoundRow]:
    """Each time a questionnaire was given to somebody."""
    for each, number, counts in _rounds(timeline):
        started = each.started
        yield RoundRow(
            questionnaire=each.name,
            round=number,
            title=started.title if started is not None else "",
            t=each.begin,
            reason=each.ended.reason if each.ended is not None else "",
            answered=sum(not answer.skipped for answer in each.answers.values()),
            items=len(_items(each)),
            participant=each.context.participant,
            condition=_condition_of(timeline, each),
            counted=counts,
            asked=tuple(_items(each)),
        )


def unanswered(timeline: Timeline) -> Iterator[str]:
    """Titles of the questionnaires that were due and not answered, with the trial before them."""
    state = timeline.state
    titles = {each.name: each.heading for each in state.study.settings.questionnaires}
    for due in (
        *(each.due for each in timeline.of(UnansweredEpisode)),
        *state.history(QuestionnaireHistory).open_at_end(state),
    ):
        after = "at the end" if due.trial < 0 else f"after trial {due.trial}"
        yield f"{titles.get(due.questionnaire, due.questionnaire)} ({after})"


def answers(timeline: Timeline) -> Iterator[AnswerRow]:
    """The last answers of each round, in the order in which the items were answered first."""
    for each, number, counts in _rounds(timeline):
        items = _items(each)
        place = context_fields(each.context) | {
            "trial": -1 if each.trial is None else each.trial,
            "condition": _condition_of(timeline, each),
        }
        for answer in each.answers.values():
            item = items.get(answer.item, {})
            yield AnswerRow(
                **place,
                questionnaire=each.name,
                round=number,
                item=answer.item,
                question=answer.question,
                value=None if answer.skipped else answer.value,
                text=answer.text,
                skipped=answer.skipped,
                t=answer.t,
                answered_us=answer.answered_us if answer.answered_us >= 0 else None,
                low=_number(item.get("low")),
                high=_number(item.get("high")),
                ends=_ends(item.get("ends")),
                counted=counts,
            )


def _rounds(timeline: Timeline) -> Iterator[tuple[QuestionnaireEpisode, int, bool]]:
    """Each round, its number, and whether its answers count."""
    rounds = [*_numbered(timeline)]
    #: Of rounds that were left and of others: the last of a questionnaire that has answers.
    last = {(_left(each), _about(each)): number for each, number in rounds if each.answers}
    for each, number in rounds:
        about = _about(each)
        again = (
            _left(each)
            and about[1:] != ("", None)  # nobody knows whether it was the same visitor
            and ((False, about) in last or number < last.get((True, about), 0))
        )
        yield each, number, not again and _of_counted_trials(timeline, each)


def _condition_of(timeline: Timeline, each: QuestionnaireEpisode) -> str:
    """The condition that it is about: none where it was asked outside of trials (at the end, or by
    hand) of somebody who had several conditions, and is about all of them.
    """
    if each.trial is not None or timeline.inside(each.context):
        return each.context.condition
    who = each.context.participant
    trials = (one for one in timeline.of(e.TrialEpisode) if one.context.participant == who)
    several = len({one.context.condition for one in trials}) > 1
    return "" if several else each.context.condition


def _of_counted_trials(timeline: Timeline, each: QuestionnaireEpisode) -> bool:
    """Whether a questionnaire is about a trial that counts, or about none. One about a condition is
    about all its trials, of which one is enough.
    """
    if each.trial == 0 or not timeline.counts(each.context):  # 0: practice
        return False
    known = {one.name: one.when for one in timeline.state.study.settings.questionnaires}
    trials = [
        trial
        for trial in timeline.of(e.TrialEpisode)
        if trial.begin <= each.begin and trial.context.participant == each.context.participant
    ]
    behind = [trial for trial in trials if trial.started.trial == each.trial][-1:]
    if behind and known.get(each.name) == "condition":
        condition = behind[0].started.condition
        behind = [trial for trial in trials if trial.started.condition == condition]
    return not behind or any(not timeline.left_out(trial) for trial in behind)


def _left(each: QuestionnaireEpisode) -> bool:
    return each.ended is not None and each.ended.reason == "left"


def _about(each: QuestionnaireEpisode) -> tuple[str, str, int | None]:
    return each.name, each.context.participant, each.trial


def _numbered(timeline: Timeline) -> Iterator[tuple[QuestionnaireEpisode, int]]:
    """Questionnaires, and how often each had been put by then."""
    counts: Counter[str] = Counter()
    for each in timeline.of(QuestionnaireEpisode):
        counts[each.name] += 1
        yield each, counts[each.name]


def _items(questionnaire: QuestionnaireEpisode) -> Mapping[str, Mapping[str, Any]]:
    listed = questionnaire.started.items if questionnaire.started is not None else []
    return {str(item.get("name", "")): item for item in listed}


def _ends(told: object) -> tuple[str, str]:
    match told:
        case [str(low), str(high)]:
            return low, high
    return "", ""


def _number(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) else None
