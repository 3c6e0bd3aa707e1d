"""What scales of questionnaires amount to over the participants of many sessions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any

from woz_tui.analysis.feature_figures import GatheredFigures
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.outcomes import Outcome, OutcomeName
from woz_tui.analysis.participant_groups import ConditionTotal, Total, total_of
from woz_tui.analysis.participants import participants_of, who_took_part
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.analysis.report_tables import OVER, total_text
from woz_tui.analysis.text_format import NONE
from woz_tui.features.questionnaires.figures import (
    REASONS,
    AnswerRow,
    RoundRow,
    asked_in,
    scale_text,
)
from woz_tui.features.questionnaires.items import NOT_SHOWN, value_labels
from woz_tui.features.questionnaires.score_totals import (
    ScoreTotal,
    ScoreTotals,
    score_total_tables,
)


@dataclass(frozen=True, slots=True)
class ItemTotal:
    """A scale of a questionnaire in one condition: over participants, as in `Total`. `wordings` are
    all questions that were asked under the item's name and on this scale, in any condition;
    `question` is the first of them.
    """

    questionnaire: str
    item: str
    question: str
    condition: str
    low: float | None
    high: float | None
    total: Total
    wordings: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ChoiceTotal:
    """A choice of an item in one condition: how many `chose` it of those who `answered`. Somebody
    who was asked several times in it chose what they chose once.
    """

    questionnaire: str
    item: str
    question: str
    condition: str
    value: int
    label: str
    chose: int
    answered: int


@dataclass(slots=True)
class _Choices:
    """An item of choices."""

    question: str
    labels: Mapping[int, str]
    #: Condition -> participant -> codes.
    chosen: dict[str, dict[str, set[int]]] = field(default_factory=dict)
    #: Condition -> why there was no choice -> how often.
    missing: dict[str, Counter[str]] = field(default_factory=dict)


@dataclass(slots=True)
class _Item:
    wordings: dict[str, None] = field(default_factory=dict)
    #: Condition -> participant -> answers.
    values: dict[str, dict[str, list[float]]] = field(default_factory=dict)


#: A scale: its questionnaire, its item and its ends.
_Scale = tuple[str, str, float | None, float | None]


@dataclass(frozen=True, slots=True)
class _Blank:
    """An item that was asked and has no answer, and why."""

    condition: str
    who: str
    reason: str


class _ScaleOutcomes:
    """The outcomes of an experiment's scales."""

    def __init__(self) -> None:
        self._scales: dict[_Scale, Outcome] = {}
        #: By questionnaire and item, until somebody's answer tells the scale.
        self._blank: dict[tuple[str, str], list[_Blank]] = {}

    def answer(self, answer: AnswerRow, who: str) -> None:
        """Adds an answer on a scale."""
        if answer.low is None or answer.high is None:
            return
        key = (answer.questionnaire, answer.item, answer.low, answer.high)
        name = OutcomeName(
            name=f"{answer.questionnaire}.{answer.item}",
            title=answer.question,
            low=answer.low,
            high=answer.high,
            ends=answer.ends,
        )
        there = self._scales.setdefault(key, Outcome(name)).at(answer.condition)
        there.asked.add(who)
        if answer.value is None:
            there.missing[answer.reason or "skipped"] += 1
        else:
            there.answers.setdefault(who, []).append(answer.value)

    def unanswered(self, each: RoundRow, who: str, answered: set[tuple[str, int, str]]) -> None:
        """Keeps the items of a round to which there is no line."""
        for item in each.asked:
            if (each.questionnaire, each.round, item) not in answered:
                blank = _Blank(each.condition, who, each.reason or "no end in the log")
                self._blank.setdefault((each.questionnaire, item), []).append(blank)

    def scales(self, first: Mapping[str, str]) -> list[Outcome]:
        """Scales of questionnaires; those about no condition (asked once) come last."""
        for (questionnaire, item, _, _), outcome in self._scales.items():
            for blank in self._blank.pop((questionnaire, item), ()):
                there = outcome.at(blank.condition)
                there.asked.add(blank.who)
                there.missing[blank.reason] += 1
        for outcome in self._scales.values():
            outcome.first = first
        return sorted(self._scales.values(), key=attrgetter("is_once"))


class GatheredScales(GatheredFigures):
    """Means of scales by condition."""

    def __init__(self) -> None:
        #: By experiment, questionnaire, item and the ends of its scale.
        self._outcomes: dict[str, _ScaleOutcomes] = {}
        self._scores: dict[str, ScoreTotals] = {}
        self._items: dict[tuple[str, str, str, float | None, float | None], _Item] = {}
        #: By experiment, questionnaire, item and what its choices are called.
        self._choices: dict[tuple[str, str, str, tuple[str, ...]], _Choices] = {}

    def add(self, experiment: str, figures: SessionFigures) -> None:
        people = participants_of(figures) if figures.all_trials else ()
        found, outcomes = asked_in(figures), self._outcomes.setdefault(experiment, _ScaleOutcomes())
        rounds = {(each.questionnaire, each.round): each for each in found.rounds}
        answered = set[tuple[str, int, str]]()
        for answer in found.answers:
            answered.add((answer.questionnaire, answer.round, answer.item))
            if answer.counted or answer.participant in people:
                outcomes.answer(answer, who_took_part(answer.participant, figures.session))
        for each in rounds.values():
            if each.counted or each.participant in people:
                who = who_took_part(each.participant, figures.session)
                outcomes.unanswered(each, who, answered)
        labels = {
            (asked.name, item.name): value_labels(item)
            for asked in found.questionnaires
            for item in asked.items
            if item.choices
        }
        for answer in (*found.answers, *found.missing):
            if not (answer.counted or answer.participant in people):
                continue
            if answer.kind in ("choice", "choices"):
                self._add_choice(experiment, answer, figures, labels)
                continue
            if answer.value is None:
                continue
            key = (experiment, answer.questionnaire, answer.item, answer.low, answer.high)
            item = self._items.setdefault(key, _Item())
            item.wordings[answer.question] = None
            values = item.values.setdefault(answer.condition, {})
            values.setdefault(who_took_part(answer.participant, figures.session), []).append(
                answer.value
            )

        for score in found.scores:
            if score.counted or score.participant in people:
                who = who_took_part(score.participant, figures.session)
                self._scores.setdefault(experiment, ScoreTotals()).add(score, who)

    def _add_choice(
        self,
        experiment: str,
        answer: AnswerRow,
        figures: SessionFigures,
        labels: Mapping[tuple[str, str], Mapping[int, str]],
    ) -> None:
        """Codes have no order and no mean: they are counted."""
        codes = answer.values or (() if answer.value is None else (round(answer.value),))
        if not codes and answer.reason in ("", NOT_SHOWN):
            return
        named = labels.get((answer.questionnaire, answer.item), {})
        key = (experiment, answer.questionnaire, answer.item, tuple(named.values()))
        choices = self._choices.setdefault(key, _Choices(answer.question, named))
        if not codes:
            choices.missing.setdefault(answer.condition, Counter())[answer.reason] += 1
            return
        people = choices.chosen.setdefault(answer.condition, {})
        people.setdefault(who_took_part(answer.participant, figures.session), set()).update(codes)

    def choices(self, experiment: str) -> list[ChoiceTotal]:
        """How many chose what, by questionnaire, item, condition and choice."""
        return [
            ChoiceTotal(
                *(questionnaire, name, each.question, condition, value),
                label=each.labels.get(value, ""),
                chose=sum(value in codes for codes in people.values()),
                answered=len(people),
            )
            for (of, questionnaire, name, _), each in self._choices.items()
            if of == experiment
            for condition, people in sorted(each.chosen.items())
            for value in each.labels or sorted(set().union(*people.values()))
        ]

    def without_choice(self, experiment: str) -> Iterator[tuple[tuple[str, ...], str, int]]:
        """Question, questionnaire, item, and why no choice was made; the condition; how often."""
        for (of, questionnaire, name, _), each in self._choices.items():
            for condition, reasons in sorted(each.missing.items()) if of == experiment else ():
                for reason, count in reasons.items():
                    why = f"no answer: {REASONS.get(reason, reason)}"
                    yield (each.question, questionnaire, name, why), condition, count

    def outcomes(self, experiment: str, first: Mapping[str, str]) -> list[Outcome]:
        there, scores = self._outcomes.get(experiment), self._scores.get(experiment)
        return [
            *(scores.outcomes(first) if scores is not None else ()),
            *(there.scales(first) if there is not None else ()),
        ]

    def scores(self, experiment: str) -> list[ScoreTotal]:
        """Means of all scores, by questionnaire, score and condition."""
        there = self._scores.get(experiment)
        return there.totals() if there is not None else []

    def items(self, experiment: str) -> list[ItemTotal]:
        """Means of all scales, by questionnaire, item, scale and condition."""
        return [
            ItemTotal(
                *(questionnaire, name, next(iter(item.wordings)), condition, low, high),
                total=total_of(values),
                wordings=tuple(item.wordings),
            )
            for (of, questionnaire, name, low, high), item in self._items.items()
            if of == experiment
            for condition, values in sorted(item.values.items())
        ]

    def tables(self, experiment: str, totals: Sequence[ConditionTotal]) -> Iterator[ReportTable]:
        conditions = any(total.condition for total in totals)
        yield from score_total_tables(self.scores(experiment), conditions)
        yield from item_tables(self.items(experiment), totals)
        yield choice_table(self.choices(experiment), [*self.without_choice(experiment)])

    def remarks(self, experiment: str) -> Iterator[str]:
        reworded = dict.fromkeys(
            f"{each.questionnaire}.{each.item}"
            for each in self.items(experiment)
            if len(each.wordings) > 1
        )
        if reworded:
            yield f"the words of {', '.join(reworded)} were changed between these sessions"

    def values(self, experiment: str) -> Mapping[str, Any]:
        return {
            "scales": self.items(experiment),
            "scores": self.scores(experiment),
            "choices": self.choices(experiment),
        }


def item_tables(
    items: Sequence[ItemTotal], totals: Sequence[ConditionTotal]
) -> Iterator[ReportTable]:
    """Means of questionnaire scales: by condition, and of what was asked once, about all of them.
    In a study without conditions there is one table.
    """
    title = f"Questionnaires: {OVER}"
    if not any(total.condition for total in totals):
        yield _item_totals(title, items)
        return
    yield _item_totals(title, [item for item in items if item.condition])
    once = [item for item in items if not item.condition]
    people = max((item.total.n for item in once), default=0)
    yield _item_totals(f"Asked once, about no condition (n = {people})", once, "all")


def _item_totals(title: str, items: Sequence[ItemTotal], without: str = "none") -> ReportTable:
    """A row for each item, a column for each condition; `without`: the head where there is none."""
    conditions = sorted({item.condition for item in items})
    rows: dict[tuple[str, ...], dict[str, Total]] = {}
    for item in items:
        words = " / ".join(item.wordings)
        key = (words, item.questionnaire, item.item, scale_text(item.low, item.high))
        rows.setdefault(key, {})[item.condition] = item.total
    heads = ["Questionnaire", "Item", "Scale", *(LogText(each or without) for each in conditions)]
    cells = [
        [*map(LogText, key), *(total_text(row.get(each)) for each in conditions), LogText(question)]
        for (question, *key), row in rows.items()
    ]
    return ReportTable(title, [*heads, "Question"], cells, words=3, on_terminal=len(heads))


def choice_table(
    choices: Sequence[ChoiceTotal], without: Sequence[tuple[tuple[str, ...], str, int]] = ()
) -> ReportTable:
    """A row for each choice, and behind all for each reason `without` one; a column for each
    condition, and for what was asked once.
    """
    of_missing = {condition for _, condition, _ in without}
    conditions = sorted({each.condition for each in choices} | of_missing)
    rows: dict[tuple[str, ...], dict[str, str]] = {}
    for each in choices:
        label = each.label or str(each.value)
        key = (each.question, each.questionnaire, each.item, label)
        rows.setdefault(key, {})[each.condition] = f"{each.chose} of {each.answered}"
    for missing, condition, count in without:
        rows.setdefault(missing, {})[condition] = str(count)
    heads = ["Questionnaire", "Item", "Choice", *(LogText(each or "all") for each in conditions)]
    cells = [
        [*map(LogText, key), *(row.get(each, NONE) for each in conditions), LogText(question)]
        for (question, *key), row in rows.items()
    ]
    title = "Choices: participants who made them"
    return ReportTable(title, [*heads, "Question"], cells, words=3, on_terminal=len(heads))
