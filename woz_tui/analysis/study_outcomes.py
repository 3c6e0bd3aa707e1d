"""Everything that is compared between the conditions of one experiment, as sessions come."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from woz_tui.analysis.figure_sums import ALL_CUES
from woz_tui.analysis.figures import PartFigures, SessionFigures
from woz_tui.analysis.measures import BY_NAME, title_of
from woz_tui.analysis.outcomes import Outcome, OutcomeName
from woz_tui.analysis.participant_flow import ParticipantFlow
from woz_tui.analysis.participants import counted_parts, who_took_part
from woz_tui.analysis.reaction_totals import ReactionTotals

#: Main figures that are compared; times of reactions are told with all cues instead.
COMPARED = ("wizard_actions_per_minute", "mistake_rate", "engaged_share", "speech_s", "duration")


@dataclass(slots=True)
class StudyOutcomes:
    """Outcomes by what they are, reactions by condition, and who came and is counted. `said`: gives
    what features gather, with the condition that each participant had first.
    """

    said: Sequence[Callable[[Mapping[str, str]], Iterable[Outcome]]] = ()
    reactions: dict[str, ReactionTotals] = field(default_factory=dict)
    flow: ParticipantFlow = field(default_factory=ParticipantFlow)
    #: Participant -> when their first condition began, and which it was.
    _began: dict[str, tuple[str, str]] = field(default_factory=dict)
    _first: dict[str, str] = field(default_factory=dict)
    _measures: dict[str, Outcome] = field(default_factory=dict)

    def add(self, figures: SessionFigures) -> None:
        """Add a session with participants."""
        self.flow.add(figures)
        self._began_with(figures)
        for part in counted_parts(figures.parts):
            self._part(part, figures)

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
            there = self._measures.setdefault(name, Outcome(title, first=self._first)).at(
                part.condition
            )
            there.asked.add(who)
            if value is None:
                there.missing["not measured"] += 1
            else:
                there.answers.setdefault(who, []).append(value)

    def scales(self) -> list[Outcome]:
        """What people said, as features gather it."""
        return [outcome for said in self.said for outcome in said(self._first)]

    def measures(self) -> Iterator[Outcome]:
        """Main figures that somebody has."""
        for outcome in self._measures.values():
            if any(any(values) for _, values in outcome.lines()):
                yield outcome

    @property
    def outcomes(self) -> list[Outcome]:
        """All of them, with what people said first."""
        return [*self.scales(), *self.measures()]
