"""Everything that is compared between the conditions of one experiment, as sessions come."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from operator import attrgetter
from typing import TypeVar

from woz_tui.analysis.event_rows import AnswerRow, RoundRow
from woz_tui.analysis.figure_sums import ALL_CUES
from woz_tui.analysis.figures import PartFigures, SessionFigures
from woz_tui.analysis.measures import BY_NAME, title_of
from woz_tui.analysis.outcomes import Outcome, OutcomeName
from woz_tui.analysis.participant_flow import ParticipantFlow
from woz_tui.analysis.participants import counted_parts, participants_of, who_took_part
from woz_tui.analysis.reaction_totals import ReactionTotals

K = TypeVar("K")
#: Main figures that are compared; times of reactions are told with all cues instead.
COMPARED = ("wizard_actions_per_minute", "mistake_rate", "engaged_share", "speech_s", "duration")
#: A scale: its questionnaire, its item and its ends.
_Scale = tuple[str, str, float | None, float | None]


@dataclass(frozen=True, slots=True)
class _Blank:
    """An item that was asked and has no answer, and why."""

    condition: str
    who: str
    reason: str


@dataclass(slots=True)
class StudyOutcomes:
    """Outcomes by what they are, reactions by condition, and who came and is counted."""

    reactions: dict[str, ReactionTotals] = field(default_factory=dict)
    flow: ParticipantFlow = field(default_factory=ParticipantFlow)
    #: Participant -> when their first condition began, and which it was.
    _began: dict[str, tuple[str, str]] = field(default_factory=dict)
    _first: dict[str, str] = field(default_factory=dict)
    _measures: dict[str, Outcome] = field(default_factory=dict)
    _scales: dict[_Scale, Outcome] = field(default_factory=dict)
    #: By questionnaire and item, until somebody's answer tells the scale.
    _blank: dict[tuple[str, str], list[_Blank]] = field(default_factory=dict)

    def add(self, figures: SessionFigures) -> None:
        """Add a session with participants."""
        self.flow.add(figures)
        self._began_with(figures)
        for part in counted_parts(figures.parts):
            self._part(part, figures)
        people = participants_of(figures) if figures.all_trials else ()
        rounds = {(each.questionnaire, each.round): each for each in figures.rounds}
        answered = set[tuple[str, int, str]]()
        for answer in figures.answers:
            answered.add((answer.questionnaire, answer.round, answer.item))
            if answer.counted or answer.participant in people:
                self._answer(answer, who_took_part(answer.participant, figures.session))
        for each in rounds.values():
            if each.counted or each.participant in people:
                who = who_took_part(each.participant, figures.session)
                self._unanswered(each, who, answered)

    def _began_with(self, figures: SessionFigures) -> None:
        for part in counted_parts(figures.parts):
            who = who_took_part(part.participant, figures.session)
            trials = (each for each in figures.trials if each.participant == part.participant)
            condition = next((each.condition for each in trials), part.condition)
            found = (figures.started, condition)
            if who not in self._began or found[0] < self._began[who][0]:
                self._began[who], self._first[who] = found, condition

    def _part(self, part: PartFigures, figures: SessionFigures) -> None:
        who = who_took_part(part.participant, figures.session)
        if ALL_CUES in part.reactions:
            found = self.reactions.setdefault(part.condition, ReactionTotals())
            found.add(who, part.reactions[ALL_CUES], figures.window_us)
        for name in COMPARED:
            value = BY_NAME[name].of(part)
            title = OutcomeName(name, title_of(name), BY_NAME[name].unit)
            there = self._outcome(self._measures, name, title).at(part.condition)
            there.asked.add(who)
            if value is None:
                there.missing["not measured"] += 1
            else:
                there.answers.setdefault(who, []).append(value)

    def _outcome(self, known: dict[K, Outcome], key: K, name: OutcomeName) -> Outcome:
        return known.setdefault(key, Outcome(name, first=self._first))

    def _answer(self, answer: AnswerRow, who: str) -> None:
        if answer.low is None or answer.high is None:
            return
        key = (answer.questionnaire, answer.item, answer.low, answer.high)
        name = OutcomeName(
            f"{answer.questionnaire}.{answer.item}", answer.question, "", answer.low, answer.high
        )
        there = self._outcome(self._scales, key, name).at(answer.condition)
        there.asked.add(who)
        if answer.value is None:
            there.missing["skipped"] += 1
        else:
            there.answers.setdefault(who, []).append(answer.value)

    def _unanswered(self, each: RoundRow, who: str, answered: set[tuple[str, int, str]]) -> None:
        """Keeps the items of a round to which there is no line."""
        for item in each.asked:
            if (each.questionnaire, each.round, item) not in answered:
                blank = _Blank(each.condition, who, each.reason or "no end in the log")
                self._blank.setdefault((each.questionnaire, item), []).append(blank)

    def scales(self) -> list[Outcome]:
        """Scales of questionnaires; those about no condition (asked once) come last."""
        for (questionnaire, item, _, _), outcome in self._scales.items():
            for blank in self._blank.pop((questionnaire, item), ()):
                there = outcome.at(blank.condition)
                there.asked.add(blank.who)
                there.missing[blank.reason] += 1
        return sorted(self._scales.values(), key=attrgetter("is_once"))

    def measures(self) -> Iterator[Outcome]:
        """Main figures that somebody has."""
        for outcome in self._measures.values():
            if any(any(values) for _, values in outcome.lines()):
                yield outcome

    @property
    def outcomes(self) -> list[Outcome]:
        """All of them, with what people said first."""
        return [*self.scales(), *self.measures()]
