"""What the console knows of the study: order, trial, break, questionnaires, preflight list.

Everything comes from the welcome's `settings.study` and from messages, so that a log that is
played back shows the same.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from woz_tui.console.figures import seconds
from woz_tui.console.study.questions import Asked, items_of
from woz_tui.core import messages as m
from woz_tui.core.settings import Questionnaire, StudySettings
from woz_tui.experiment.due import OVER, due_behind

#: Sentences for the wizard that may wait to be read.
_TIDINGS = 8
#: What a wizard did with a cue: how it is said, and its look.
_JUDGED = {
    "right": ("right", "good"),
    "wrong": ("wrong", "bad"),
    "missed": ("missed", "warn"),
    "uncalled": ("nothing asked for it", "warn"),
}


class Tiding(NamedTuple):
    """A sentence for the wizard and its look. `right`: names of the actions that would have
    answered a cue.
    """

    text: str
    look: str
    right: tuple[str, ...] = ()


class Trial(NamedTuple):
    """The trial under way: since `began`, in microseconds on the axis of `t`."""

    number: int
    began: int
    condition: str = ""


@dataclass(slots=True)
class Study:
    """Fields are for reading; `tell` and `take` change them."""

    questionnaires: tuple[Questionnaire, ...] = ()
    #: Whether the file has a design: then the robot process proposes orders and counts trials.
    designed: bool = False
    #: Trials in each condition (0: nobody said).
    trials: int = 0
    participant: str = ""
    #: What a human has to see to -> whether it is ticked.
    checks: dict[str, bool] = field(default_factory=dict)
    #: The participant's conditions in their order, as the wizard may know them.
    order: tuple[str, ...] = ()
    planned: int = 0
    trial: Trial | None = None
    #: The number of the next trial, or of the present one.
    next: int = 1
    #: The last trial that is over: its number and how it ended.
    last: tuple[int, str] | None = None
    break_began: int | None = None
    #: The questionnaire that is put to somebody now.
    asked: Asked | None = None
    #: Names of those that should be asked now.
    due: list[str] = field(default_factory=list)
    #: Names of those that were answered or declined in this session.
    over: set[str] = field(default_factory=set)
    #: The last cue of a training.
    cue: m.CueGiven | None = None
    #: Consoles at which a participant sits.
    participants: set[str] = field(default_factory=set)
    #: Programs that see what is kept from the wizard: what each calls itself, by console.
    seers: dict[str, str] = field(default_factory=dict)
    _tidings: deque[Tiding] = field(default_factory=lambda: deque(maxlen=_TIDINGS))

    # -- reading ------------------------------------------------------------------------------

    @property
    def counts(self) -> bool:
        """Whether trials are counted: by the design, or because one has been begun."""
        running = self.trial is not None or self.break_began is not None
        return self.designed or running or self.last is not None

    @property
    def all_over(self) -> bool:
        """Whether the participant has had all trials that were planned."""
        return self.trial is None and self.next > self.planned > 0

    def questionnaire(self, name: str) -> Questionnaire | None:
        """The questionnaire of this name."""
        return next((one for one in self.questionnaires if one.name == name), None)

    def unticked(self) -> list[str]:
        """What nobody has seen to."""
        return [check for check, ticked in self.checks.items() if not ticked]

    def open_at_end(self) -> list[str]:
        """Questionnaires for the end of the session that nobody has answered or declined."""
        return [
            one.name
            for one in self.questionnaires
            if one.when == "end" and one.name not in self.over
        ]

    def right_for(self, told: m.CueAnswered) -> tuple[str, ...]:
        """Names of the actions that would have answered a cue that was missed or answered wrongly;
        none for others, or if nobody knows.
        """
        known = self.cue is not None and self.cue.cue == told.cue
        wanted = known and told.judged in ("wrong", "missed")
        return tuple(self.cue.expects) if wanted and self.cue is not None else ()

    def read_tidings(self) -> list[Tiding]:
        """Sentences that nobody has read, oldest first."""
        told = list(self._tidings)
        self._tidings.clear()
        return told

    # -- from the robot process -----------------------------------------------------------------

    def tell(self, told: StudySettings) -> None:
        """What the experiment file says, and where the session stands."""
        self.questionnaires = tuple(told.questionnaires)
        self.checks = {each.check: each.ok for each in told.preflight}
        self.designed = told.design is not None
        self.trials = told.design.trials if told.design is not None else 0
        self.order, self.planned = tuple(told.assigned), told.planned
        self.next, self.due = told.trial, [*told.due]

    def take(self, message: m.Message) -> None:
        """Work a message in; others than those of the study are passed over."""
        reducer = _REDUCERS.get(type(message))
        if reducer is not None:
            reducer(self, message)

    def _somebody(self, participant: str) -> None:
        """Another participant has another order, and has been asked nothing yet."""
        if participant != self.participant:
            self.participant, self.order, self.planned = participant, (), 0
            self.last, self.next, self.due, self.over = None, 1, [], set()

    def _start(self, told: m.SessionStart) -> None:
        self._somebody(told.participant)

    def _change(self, told: m.SessionChanged) -> None:
        if told.participant is not None:
            self._somebody(told.participant)
        if told.trial is not None:
            self.next = told.trial

    def _assign(self, told: m.ConditionsAssigned) -> None:
        self._somebody(told.participant)
        self.order = tuple(told.order)
        self.planned = self.trials * max(1, len(self.order))

    def _begin(self, told: m.TrialStarted) -> None:
        self.trial, self.break_began = Trial(told.trial, told.t, told.condition), None
        self.next = told.trial
        self.planned, self.due = told.planned or self.planned, []
        missing = self.unticked() if self.last is None else []
        if missing:
            listed = f"{len(missing)} not ticked in the preflight: {'; '.join(missing)}"
            self._tidings.append(Tiding(listed, "warn"))

    def _end(self, told: m.TrialEnded) -> None:
        self.trial, self.break_began, self.last = None, None, (told.trial, told.outcome)
        if told.outcome in OVER:
            self.next = told.trial + 1
            whens = due_behind(told.trial, told.outcome, trials=self.trials, planned=self.planned)
            self.due = [
                one.name for when in whens for one in self.questionnaires if one.when == when
            ]

    def _break(self, told: m.BreakStarted) -> None:
        self.break_began = told.t

    def _resume(self, told: m.BreakEnded) -> None:
        self.break_began = None

    def _check(self, told: m.PreflightChecked) -> None:
        if told.check in self.checks:
            self.checks[told.check] = told.level == "ok"

    def _ask(self, told: m.QuestionnaireStarted) -> None:
        known = self.questionnaire(told.questionnaire)
        self.asked = Asked(
            Questionnaire(
                told.questionnaire,
                told.title,
                known.introduction if known is not None else "",
                items=items_of(told.items) or (known.items if known is not None else ()),
            )
        )

    def _answer(self, told: m.QuestionnaireAnswered) -> None:
        if self.asked is not None and self.asked.name == told.questionnaire:
            self.asked.take(told)

    def _asked(self, told: m.QuestionnaireEnded) -> None:
        if self.asked is not None and self.asked.name == told.questionnaire:
            self.asked = None
        if told.reason in ("done", "declined"):
            self.over.add(told.questionnaire)
            self.due = [name for name in self.due if name != told.questionnaire]

    def _cue(self, told: m.CueGiven) -> None:
        self.cue = told

    def _judge(self, told: m.CueAnswered) -> None:
        self._tidings.append(Tiding(*judged(told), self.right_for(told)))

    def _attach(self, told: m.ConsoleAttached) -> None:
        if told.role == "participant":
            self.participants.add(told.console)
        elif told.sees == "all":
            self.seers[told.console] = told.name or told.console

    def _gone(self, told: m.ConsoleLost) -> None:
        self.participants.discard(told.console)
        self.seers.pop(told.console, None)


def judged(told: m.CueAnswered) -> tuple[str, str]:
    """`right, 1.24 s`, with its look."""
    word, look = _JUDGED.get(told.judged, (told.judged, "plain"))
    took = f", {seconds(told.reaction_us)}" if told.reaction_us >= 0 else ""
    return f"{word}{took}", look


_REDUCERS: dict[type[m.Message], Callable[[Study, Any], None]] = {
    m.SessionStart: Study._start,
    m.SessionChanged: Study._change,
    m.ConditionsAssigned: Study._assign,
    m.TrialStarted: Study._begin,
    m.TrialEnded: Study._end,
    m.BreakStarted: Study._break,
    m.BreakEnded: Study._resume,
    m.PreflightChecked: Study._check,
    m.QuestionnaireStarted: Study._ask,
    m.QuestionnaireAnswered: Study._answer,
    m.QuestionnaireEnded: Study._asked,
    m.CueGiven: Study._cue,
    m.CueAnswered: Study._judge,
    m.ConsoleAttached: Study._attach,
    m.ConsoleLost: Study._gone,
}
