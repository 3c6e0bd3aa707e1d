"""What was asked and answered in sessions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from msgspec.structs import replace as replaced

from woz_tui.analysis.event_rows import ContextRow, context_fields
from woz_tui.analysis.feature_figures import FeatureFigures, Instant
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.analysis.text_format import NONE, counted, duration, listed, times
from woz_tui.features.questionnaires.answers import answer_told, items_of
from woz_tui.features.questionnaires.due import SUSPICION
from woz_tui.features.questionnaires.history import (
    QuestionnaireEpisode,
    QuestionnaireHistory,
    UnansweredEpisode,
)
from woz_tui.features.questionnaires.items import (
    NOT_SHOWN,
    NUMBERS,
    POINTS,
    SKIPPED,
    ItemAnswer,
    asked_items,
    value_labels,
    wording,
)
from woz_tui.features.questionnaires.items import said as in_words
from woz_tui.features.questionnaires.score_rows import ScoreRow, score_rows
from woz_tui.protocol.welcome import Questionnaire, QuestionnaireItem
from woz_tui.timeline import episodes as e
from woz_tui.timeline.timeline import Timeline

_Row = TypeVar("_Row", bound=ContextRow)


@dataclass(frozen=True, slots=True, kw_only=True)
class AnswerRow(ContextRow):
    """The last answer to an item in one round of a questionnaire, or why there is none (`reason`:
    skipped, does_not_apply, prefer_not, declined, left, not_shown, private; empty: there is one);
    `t` is when it was given, or when the round ended.

    `value` is None for texts, several choices (`values`) and without an answer; `low` and `high`
    are None unless the item is a number. `position`: as which it stood among the questions, from 1;
    0: nobody knows. `label`: what the answer is called; `low_label` and `high_label`: the ends.
    `flipped`: the high end stood on the left.
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
    kind: str = "scale"
    low_label: str = ""
    high_label: str = ""
    label: str = ""
    values: tuple[int, ...] = ()
    position: int = 0
    flipped: bool = False
    reason: str = ""
    given: str = ""
    language: str = ""

    @property
    def ends(self) -> tuple[str, str]:
        """What the ends of the scale are called."""
        return self.low_label, self.high_label


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
    answered nor declined, and after which trial. `missing`: questions of rounds to which there is
    no line, and why. `questionnaires`: as the experiment file has them.
    """

    answers: tuple[AnswerRow, ...] = ()
    missing: tuple[AnswerRow, ...] = ()
    questionnaires: tuple[Questionnaire, ...] = ()
    rounds: tuple[RoundRow, ...] = ()
    unanswered: tuple[str, ...] = ()
    scores: tuple[ScoreRow, ...] = ()


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
            LogText(answer_text(answer)),
            *(scale_text(answer.low, answer.high), duration(answer.answered_us)),
            *(LogText(answer.questionnaire), str(answer.round)),
            *(LogText(answer.condition), NONE if answer.trial < 0 else str(answer.trial)),
        )
        for answer in figures.answers
    ]
    heads = ["Item", "Question", "Answer", "Scale", "After"]
    heads += ["Questionnaire", "Round", "Condition", "Trial"]
    return ReportTable("Questionnaires", heads, rows, words=4, on_terminal=4)


#: Why there is no answer, in words.
REASONS = {
    "skipped": "left out",
    "does_not_apply": "does not apply",
    "prefer_not": "prefer not to say",
    "private": "private",
}


def answer_text(answer: AnswerRow) -> str:
    """An answer in a few words, or why there is none."""
    if answer.reason:
        return REASONS.get(answer.reason, answer.reason)
    if answer.kind in ("choice", "choices"):
        return answer.label
    number = "" if answer.value is None else f"{answer.value:g}"
    return number or answer.text


def score_table(figures: QuestionnaireFigures) -> ReportTable:
    """What several items amounted to."""
    rows = [
        (
            *(LogText(row.questionnaire), LogText(row.score)),
            *(NONE if row.value is None else f"{row.value:.2f}", scale_text(row.low, row.high)),
            f"{len(row.items) - row.missing} of {len(row.items)}",
            *(row.how, str(row.round)),
            *(LogText(row.condition), NONE if row.trial < 0 else str(row.trial)),
        )
        for row in figures.scores
    ]
    heads = ["Questionnaire", "Score", "Value", "Range", "Answered", "How", "Round"]
    return ReportTable("Scores", [*heads, "Condition", "Trial"], rows, words=2, on_terminal=5)


def scale_text(low: float | None, high: float | None) -> str:
    """`1 to 7`."""
    return NONE if low is None or high is None else f"{low:g} to {high:g}"


# -- one session -----------------------------------------------------------------------------------


class CountedQuestionnaires(FeatureFigures):
    """Rounds and their answers."""

    def count(self, timeline: Timeline) -> QuestionnaireFigures | None:
        given = tuple(answers(timeline))
        known = tuple(questionnaires(timeline))
        found = QuestionnaireFigures(
            given,
            tuple(unanswered_items(timeline)),
            known,
            tuple(rounds(timeline)),
            tuple(unanswered(timeline)),
            tuple(score_rows(known, given)),
        )
        return found if found != NOTHING else None

    def busy(self, figures: QuestionnaireFigures) -> Collection[str]:
        return {answer.participant for answer in figures.answers}

    def narrowed(
        self, figures: QuestionnaireFigures, people: Collection[str]
    ) -> QuestionnaireFigures:
        return replace(
            figures,
            answers=_narrowed(figures.answers, people),
            missing=_narrowed(figures.missing, people),
            scores=_narrowed(figures.scores, people),
        )

    def values(self, name: str, figures: QuestionnaireFigures | None) -> Mapping[str, Any]:
        found = figures or NOTHING
        return {
            "answers": found.answers,
            "rounds": found.rounds,
            "unanswered": found.unanswered,
            "scores": found.scores,
        }

    def circumstances(self, figures: QuestionnaireFigures) -> Iterator[str]:
        for title in figures.unanswered:
            yield f"{title}: due and not answered"
        for each in figures.rounds:
            items = f" of {each.items}" if each.items else ""
            ended = each.reason or "no end in the log"
            yield f"{each.title or each.questionnaire}: {each.answered}{items} answered, {ended}"

    def attended(self, sessions: Sequence[QuestionnaireFigures]) -> Iterator[str]:
        given: Counter[tuple[str, str]] = Counter()
        declined = 0
        for figures in sessions:
            for each in figures.rounds:
                given[each.title or each.questionnaire, each.questionnaire] += 1
                declined += each.reason == "declined"
        titles = Counter(title for title, _ in given)
        for (title, name), count in given.items():
            named = f"{title} ({name})" if titles[title] > 1 else title
            yield f"The questionnaire {named} was given {times(count)}."
        if declined:
            yield f"Participants declined {counted(declined, 'questionnaire')}."

    def suspicion(self, sessions: Sequence[QuestionnaireFigures], asked: str) -> Iterator[str]:
        checks = {
            (each.name, item.name): None
            for figures in sessions
            for each in figures.questionnaires
            if each.role == SUSPICION
            for item in each.items
            if item.asks != "page"
        }
        name, _, item_name = asked.partition(".")
        for check in {(name, item_name): None} if asked else checks:
            rows = [
                answer
                for figures in sessions
                for answer in figures.answers
                if (answer.questionnaire, answer.item) == check and answer.counted
            ]
            if rows:
                yield _suspected(rows)
            else:
                yield f"Whether a wizard was suspected was not answered ({'.'.join(check)})."

    def instant(self, episode: e.Episode) -> Instant | None:
        if not isinstance(episode, QuestionnaireEpisode) or episode.started is None:
            return None
        return Instant(episode.begin, episode.started.title or episode.name, "questionnaire")


def _suspected(rows: Sequence[AnswerRow]) -> str:
    """What was answered to one item of a suspicion check, each answer with how often."""
    last = rows[-1]
    ends = [
        f"{end:g} = {label}"
        for end, label in ((last.low, last.low_label), (last.high, last.high_label))
        if end is not None and label
    ]
    scale = f"; {listed(ends)}" if ends else ""
    labels = {each.value: each.label for each in rows if each.label and not ends}
    told = Counter(sorted(each.value for each in rows if each.value is not None))
    parts = [f"{labels.get(value, f'{value:g}')} {times(count)}" for value, count in told.items()]
    words = sum(each.value is None and bool(each.text or each.values) for each in rows)
    parts += [f"in words {times(words)}"] if words else []
    private = sum(each.reason == "private" for each in rows)
    parts += [f"private {times(private)}"] if private else []
    none = len(rows) - told.total() - words - private
    parts += [f"none {times(none)}"] if none else []
    return (
        "Whether a wizard was suspected was asked"
        f' ("{last.question}"{scale}); the answers were {listed(parts)}.'
    )


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
            items=len(_questions(each)),
            participant=each.context.participant,
            condition=_condition_of(timeline, each),
            counted=counts,
            asked=tuple(item.name for item in _questions(each)),
        )


def questionnaires(timeline: Timeline) -> Iterator[Questionnaire]:
    """What the experiment file asks; and what was asked, where a log does not say what it holds."""
    known = {each.name: each for each in timeline.state.study.settings.questionnaires}
    yield from known.values()
    others: dict[str, tuple[str, dict[str, QuestionnaireItem]]] = {}
    for each, _ in _numbered(timeline):
        if each.name in known:
            continue
        title = each.started.title if each.started is not None else ""
        _, items = others.setdefault(each.name, (title, {}))
        for name, item in _items(each).items():
            items.setdefault(name, replaced(item, flipped=False))
        for answer in each.answers.values():  # of a round whose beginning is lost
            unknown = QuestionnaireItem(answer.item, answer.question, kind="unknown")
            items.setdefault(answer.item, unknown)
    for name, (title, items) in others.items():
        yield Questionnaire(name, title, when="", items=tuple(items.values()))


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
    """The last answers of each round, in the order in which the items were answered first. What is
    private is in none of them; nor what a later answer has ruled out.
    """
    for each, number, counts in _rounds(timeline):
        asked = _asked(each)
        for answer in each.answers.values():
            if answer.item not in asked and answer.item in _items(each):
                continue
            row = _row(timeline, each, number, answer.item, counts=counts)
            said = answer_told(answer)
            item = _items(each).get(answer.item)
            row = replace(
                row,
                question=answer.question,
                skipped=answer.skipped,
                t=answer.t,
                answered_us=answer.answered_us if answer.answered_us >= 0 else None,
                reason=(answer.reason or SKIPPED) if answer.skipped else "",
                given=answer.given,
            )
            if answer.private and not answer.skipped:
                yield replace(row, reason="private")
                continue
            label = value_labels(item).get(said.value or 0, "") if item is not None else ""
            if item is not None and item.choices and not answer.skipped:
                label = in_words(item, said, "")
            yield replace(
                row,
                value=None if answer.skipped else answer.value,
                text=answer.text,
                values=said.values,
                label="" if said.value is None and not said.values else label,
            )


def unanswered_items(timeline: Timeline) -> Iterator[AnswerRow]:
    """Questions of each round to which there is no answer: those that an earlier answer has ruled
    out were not shown; of others, how the round ended says why.
    """
    for each, number, counts in _rounds(timeline):
        asked = _asked(each)
        ended = each.ended.reason if each.ended is not None else "left"
        for name, item in _items(each).items():
            if item.asks == "page" or (name in asked and name in each.answers):
                continue
            row = _row(timeline, each, number, name, counts=counts)
            why = NOT_SHOWN if name not in asked else SKIPPED if ended == "done" else ended
            if item.only_if is not None and item.only_if.item in _kept_back(each):
                why = "private"  # whether it was shown would tell the answer
            yield replace(row, t=each.end or each.begin, reason=why, question=wording(item))


def _asked(each: QuestionnaireEpisode) -> set[str]:
    """Names of the questions of a round that no earlier answer has ruled out."""
    asked = asked_items(_items(each).values(), _told(each), _kept_back(each))
    return {item.name for item in asked}


def _kept_back(each: QuestionnaireEpisode) -> set[str]:
    """Items of a round whose answer was given, and is not in this copy of the log."""
    return {
        answer.item
        for answer in each.answers.values()
        if answer.private
        and not answer.skipped
        and answer.value is None
        and not (answer.text or answer.ticked)
    }


def _row(
    timeline: Timeline, each: QuestionnaireEpisode, number: int, name: str, *, counts: bool
) -> AnswerRow:
    """A question of a round, without an answer."""
    items = _items(each)
    item = items.get(name)
    kind = item.asks if item is not None else ""
    named = value_labels(item) if item is not None and kind in POINTS else {}
    place = context_fields(each.context) | {
        "trial": -1 if each.trial is None else each.trial,
        "condition": _condition_of(timeline, each),
    }
    questions = [each.name for each in items.values() if each.asks != "page"]
    numbered = item if item is not None and kind in NUMBERS else None
    return AnswerRow(
        **place,
        questionnaire=each.name,
        round=number,
        item=name,
        question="",
        value=None,
        text="",
        skipped=False,
        t=each.begin,
        answered_us=None,
        low=None if numbered is None else float(numbered.low),
        high=None if numbered is None else float(numbered.high),
        counted=counts,
        kind=kind or "scale",
        low_label=named.get(item.low, "") if item is not None else "",
        high_label=named.get(item.high, "") if item is not None else "",
        position=questions.index(name) + 1 if name in questions else 0,
        flipped=item is not None and item.flipped,
        language=each.started.language if each.started is not None else "",
    )


def _narrowed(rows: tuple[_Row, ...], people: Collection[str]) -> tuple[_Row, ...]:
    return tuple(
        each if each.participant in people else replace(each, counted=False) for each in rows
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
    hand) of somebody who had several conditions, and is about all of them. A suspicion check is
    about the whole session.
    """
    roles = {one.name: one.role for one in timeline.state.study.settings.questionnaires}
    if roles.get(each.name) == SUSPICION:
        return ""
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


def _items(questionnaire: QuestionnaireEpisode) -> Mapping[str, QuestionnaireItem]:
    """What was asked, in the order in which it was shown."""
    listed = questionnaire.started.items if questionnaire.started is not None else []
    return {item.name: item for item in items_of(listed)}


def _told(questionnaire: QuestionnaireEpisode) -> Mapping[str, ItemAnswer]:
    return {name: answer_told(told) for name, told in questionnaire.answers.items()}


def _questions(questionnaire: QuestionnaireEpisode) -> list[QuestionnaireItem]:
    """Those that were asked, as far as the answers tell it."""
    asked = asked_items(_items(questionnaire).values(), _told(questionnaire))
    return [item for item in asked if item.asks != "page"]
