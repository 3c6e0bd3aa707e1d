"""Which questionnaire is under way, which have been answered, and which are due."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from msgspec.structs import replace

from woz_tui.config.study_words import OVER
from woz_tui.features.questionnaires.due import due_after_trial
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import (
    Episode,
    EpisodeOutcome,
    keep_latest,
)
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState, moment


@dataclass(frozen=True, slots=True)
class DueQuestionnaire:
    """A questionnaire that is due, and the trial behind which it is (-1: behind the last)."""

    questionnaire: str
    trial: int = -1


class QuestionnaireEpisode(Episode, frozen=True, kw_only=True):
    """One round of a questionnaire; `started` is None if that line is lost.

    `answers` has the last one to each item, in the order in which items were answered first.
    """

    kind = "questionnaire"
    name: str
    started: QuestionnaireStarted | None = None
    answers: Mapping[str, QuestionnaireAnswered] = {}
    ended: QuestionnaireEnded | None = None

    @property
    def label(self) -> str:
        """Its name."""
        return self.name

    @property
    def trial(self) -> int | None:
        """The trial that it is about: as its first line says, or else the one in which it began."""
        if self.started is not None and self.started.trial >= 0:
            return self.started.trial
        return self.context.trial

    @property
    def source(self) -> str:
        """Who put it: wizard or participant."""
        return self.started.source if self.started else ""

    @property
    def lines(self) -> Iterable[m.Message]:
        """With the answers."""
        both = (self.started, *self.answers.values(), self.ended)
        return (line for line in both if line is not None)


class UnansweredEpisode(Episode, frozen=True, kw_only=True):
    """The moment from which on a questionnaire is not due any more that nobody has answered."""

    kind = "unanswered"
    due: DueQuestionnaire


class QuestionnaireHistory(FeatureHistory):
    """The questionnaires of a session.

    Attributes:
        questionnaire: What is under way.
        had: Questionnaires that this participant has had or declined, and their ends by name.
        rounds: The last end of each questionnaire, whoever had it.
        rounds_begun: How often each questionnaire was begun.
        over, order: The trial whose questionnaires are due, and the order of conditions that the
            participant had at its end.
    """

    deeds = (QuestionnaireStarted, QuestionnaireAnswered, QuestionnaireEnded)
    earlier = (QuestionnaireEnded,)

    def __init__(self) -> None:
        self.questionnaire: QuestionnaireEpisode | None = None
        self.had: dict[str, QuestionnaireEnded] = {}
        self.rounds: dict[str, QuestionnaireEnded] = {}
        self.rounds_begun: Counter[str] = Counter()
        self.over: m.TrialEnded | None = None
        self.order: m.ConditionsAssigned | None = None
        #: Which questionnaires have been had since that trial.
        self._had_since: frozenset[str] = frozenset()
        self._participant: str | None = None
        #: Whether this participant has had a trial.
        self._tried = False

    # -- what is due -------------------------------------------------------------------------------

    def due(self, state: SessionState) -> list[DueQuestionnaire]:
        """Those that are due before the first trial or behind the one that ended last, in the
        file's order.
        """
        over, order, design = self.over, self.order, state.study.settings.design
        if over is None and self._participant and not self._tried:
            names = _names(state, "start")
            return [DueQuestionnaire(name) for name in names if name not in self.had]
        if over is None:
            return []
        trials = order.trials if order is not None and order.trials else 0
        trials = trials or (design.trials if design is not None else 0)
        planned = trials * max(len(order.order), 1) if order is not None else 0
        whens = due_after_trial(over.trial, over.outcome, trials=trials, planned=planned)
        return [
            DueQuestionnaire(name, -1 if when == "end" else over.trial)
            for when in whens
            for name in _names(state, when)
            if name not in self._had_since
        ]

    def open_at_end(self, state: SessionState) -> tuple[DueQuestionnaire, ...]:
        """What is due and what is for the end, and was neither answered nor declined; without any
        participant and trial nothing is for the end.
        """
        due = self.due(state)
        begun = bool(state.study.participant) or state.study.last_started is not None
        named = self.had.keys() | {each.questionnaire for each in due}
        at_end = _names(state, "end") if begun else ()
        return (*due, *(DueQuestionnaire(name) for name in at_end if name not in named))

    def open_if_done(self, state: SessionState) -> tuple[DueQuestionnaire, ...]:
        """`open_at_end` as it would be if the trial under way were done now."""
        if (trial := state.study.trial) is None:
            return self.open_at_end(state)
        after = QuestionnaireHistory()
        vars(after).update(vars(self))
        after._end_trial(m.TrialEnded(trial=trial.started.trial, outcome="done"), state)
        return after.open_at_end(state)

    def study(self, state: SessionState) -> Mapping[str, Any]:
        return {"due": [each.questionnaire for each in self.due(state)]}

    def owed(
        self, message: m.Message, state: SessionState, before: tuple[str, ...]
    ) -> tuple[str, ...]:
        match message:
            case QuestionnaireEnded(questionnaire=name, reason=reason):
                left = reason == EpisodeOutcome.LEFT
                return before if left else tuple(each for each in before if each != name)
            case m.TrialStarted() | m.TrialEnded():
                return tuple(each.questionnaire for each in self.due(state))
        return before

    # -- who, and which trial ----------------------------------------------------------------------

    def _somebody(self, participant: str | None) -> None:
        """Another participant begins anew, and has had no questionnaire."""
        if participant is not None and participant != self._participant:
            self._participant = participant
            self.had, self._tried = {}, False
            self.over, self._had_since = None, frozenset()

    def _start(self, message: m.SessionStart, state: SessionState) -> None:
        self._somebody(message.participant)

    def _change(
        self,
        message: m.SessionChanged | m.ParticipantWithdrawn | m.ConditionsAssigned,
        state: SessionState,
    ) -> Iterator[Episode]:
        before = self.due(state)
        self._somebody(message.participant)
        yield from self._passed(before, message, state)

    def _begin_trial(self, message: m.TrialStarted, state: SessionState) -> Iterator[Episode]:
        before = self.due(state)
        self.over, self._had_since, self._tried = None, frozenset(), True
        yield from self._passed(before, message, state)

    def _passed(
        self, before: Iterable[DueQuestionnaire], message: m.Message, state: SessionState
    ) -> Iterator[Episode]:
        """What was due before, and is so no more without an answer."""
        now, t = self.due(state), state.t
        for due in before:
            if due not in now:
                yield UnansweredEpisode(
                    begin=t, end=t, seq=message.seq, outcome=EpisodeOutcome.MOMENT, due=due
                )

    def _end_trial(self, message: m.TrialEnded, state: SessionState) -> None:
        if message.outcome in OVER:
            study = state.study
            own = study.assigned is not None and study.assigned.participant == study.participant
            self.over, self._had_since = message, frozenset()
            self.order = study.assigned if own else None

    # -- questionnaires ----------------------------------------------------------------------------

    def _begin(self, message: QuestionnaireStarted, state: SessionState) -> Iterator[Episode]:
        """There is one at a time."""
        yield from self._cut(state)
        name = message.questionnaire
        self.rounds_begun[name] += 1
        self.questionnaire = QuestionnaireEpisode(
            begin=state.t, seq=message.seq, name=name, started=message
        )
        yield self.questionnaire

    def _answer(self, message: QuestionnaireAnswered, state: SessionState) -> Iterator[Episode]:
        """Without its beginning in the log, the questionnaire begins with it."""
        name = message.questionnaire
        if self.questionnaire is None or self.questionnaire.name != name:
            yield from self._cut(state)
            self.questionnaire = QuestionnaireEpisode(begin=state.t, seq=message.seq, name=name)
            yield self.questionnaire
        answers = dict(self.questionnaire.answers)
        keep_latest(answers, message.item, message)
        self.questionnaire = replace(self.questionnaire, answers=answers)

    def _end(self, message: QuestionnaireEnded, state: SessionState) -> Iterator[Episode]:
        """Nothing but a moment comes of it if its beginning is not in the log."""
        name, t = message.questionnaire, state.t
        keep_latest(self.rounds, name, message)
        if message.reason != EpisodeOutcome.LEFT:
            keep_latest(self.had, name, message)
            self._had_since = (self._had_since & self.had.keys()) | {name}
        current = self.questionnaire
        if current is not None and current.name == name:
            self.questionnaire = None
            yield replace(current, end=t, outcome=message.reason, ended=message)
            return
        yield from self._cut(state)
        yield from moment(message, t)

    def _cut(self, state: SessionState) -> Iterator[Episode]:
        """Ends the one that is under way without a line in the log."""
        current, self.questionnaire = self.questionnaire, None
        if current is not None:
            yield replace(current, end=state.t, cut=True)

    cases: ClassVar[Mapping[type[m.Message], HistoryCase]] = {
        m.SessionStart: _start,
        m.SessionChanged: _change,
        m.ParticipantWithdrawn: _change,
        m.ConditionsAssigned: _change,
        m.TrialStarted: _begin_trial,
        m.TrialEnded: _end_trial,
        QuestionnaireStarted: _begin,
        QuestionnaireAnswered: _answer,
        QuestionnaireEnded: _end,
    }


def _names(state: SessionState, when: str) -> Iterator[str]:
    for each in state.study.settings.questionnaires:
        if each.when == when:
            yield each.name
