"""How a study stands, from the messages of its session alone.

The robot process keeps one to know what may be asked; a console or a replay that keeps one too,
fed with the same messages, knows the same: the order, the trial, what is due.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from woz_tui.core import messages as m
from woz_tui.experiment.due import OVER, due_behind


@dataclass(frozen=True, slots=True)
class Due:
    """A questionnaire that is due, and the trial behind which it is (-1: behind the last)."""

    questionnaire: str
    trial: int = -1


@dataclass
class Progress:
    """See the module's text.

    Args:
        told: `settings["study"]` of a welcome; may be replaced when the file was read again.
    """

    told: Mapping[str, Any]
    participant: str = ""
    condition: str = ""
    #: The number of the next trial, or of the present one.
    trial: int = 1
    #: The trial that is under way.
    running: m.TrialStarted | None = None
    on_break: bool = False
    assigned: m.ConditionsAssigned | None = None
    #: Lines of the preflight list, by what was checked.
    checks: dict[str, m.PreflightChecked] = field(default_factory=dict)
    #: The questionnaire that is under way, and the answers so far by item.
    asking: m.QuestionnaireStarted | None = None
    answers: dict[str, m.QuestionnaireAnswered] = field(default_factory=dict)
    due: list[Due] = field(default_factory=list)
    #: Questionnaires that this participant has had, or has declined.
    had: set[str] = field(default_factory=set)

    # -- figures -----------------------------------------------------------------------------------

    @property
    def order(self) -> Sequence[str]:
        """The conditions of the present participant, in their order; empty if nobody said."""
        if self.assigned is None or self.assigned.participant != self.participant:
            return ()
        return self.assigned.order

    @property
    def trials(self) -> int:
        """Trials in each condition; 0: nobody said."""
        design = self.told.get("design") or {}
        return int(design.get("trials", 0))

    @property
    def planned(self) -> int:
        """Trials of the participant in all; 0: nobody said, or no order was assigned yet."""
        if self.assigned is None or self.assigned.participant != self.participant:
            return 0
        return self.trials * max(len(self.order), 1)

    def condition_of(self, trial: int) -> str:
        """The condition that the order has for this trial; empty if it says nothing."""
        place = (trial - 1) // self.trials if self.trials and trial > 0 else -1
        return self.order[place] if 0 <= place < len(self.order) else ""

    def label(self, condition: str) -> str:
        """What the wizard is told instead of a condition."""
        return str((self.told.get("blind") or {}).get(condition, condition))

    def ticked(self, check: str) -> bool:
        """Whether this line of the preflight list is in order."""
        return check in self.checks and self.checks[check].level == "ok"

    def questionnaires(self, *whens: str) -> Iterator[Mapping[str, Any]]:
        """Those that belong `when`, in the file's order; without any `whens` all."""
        for each in self.told.get("questionnaires") or ():
            if not whens or each.get("when") in whens:
                yield each

    # -- what happens ------------------------------------------------------------------------------

    def see(self, message: m.Message) -> None:
        """A message of the session, each once and in their order."""
        match message:
            case m.SessionStart():
                self.participant, self.condition = message.participant, message.condition
            case m.SessionChanged():
                self._changed(message)
            case m.ConditionsAssigned():
                self._somebody(message.participant)
                self.assigned = message
            case m.TrialStarted():
                self.running, self.trial, self.due = message, message.trial, []
            case m.TrialEnded():
                self._ended(message)
            case m.BreakStarted() | m.BreakEnded():
                self.on_break = isinstance(message, m.BreakStarted)
            case m.PreflightChecked():
                self.checks[message.check] = message
            case m.QuestionnaireStarted():
                self.asking, self.answers = message, {}
            case m.QuestionnaireAnswered():
                self.answers[message.item] = message
            case m.QuestionnaireEnded():
                self._asked(message)

    def _changed(self, message: m.SessionChanged) -> None:
        if message.participant is not None:
            self._somebody(message.participant)
        if message.condition is not None:
            self.condition = message.condition
        if message.trial is not None:
            self.trial = message.trial

    def _somebody(self, participant: str) -> None:
        if participant != self.participant:
            self.participant, self.trial, self.due, self.had = participant, 1, [], set()

    def _ended(self, message: m.TrialEnded) -> None:
        self.running = None
        if message.outcome not in OVER:
            return
        self.trial = message.trial + 1
        self.due = [
            Due(str(each["name"]), -1 if when == "end" else message.trial)
            for when in due_behind(
                message.trial, message.outcome, trials=self.trials, planned=self.planned
            )
            for each in self.questionnaires(when)
        ]

    def _asked(self, message: m.QuestionnaireEnded) -> None:
        self.asking, self.answers = None, {}
        if message.reason != "left":
            self.had.add(message.questionnaire)
            self.due = [due for due in self.due if due.questionnaire != message.questionnaire]

    def trial_of(self, questionnaire: str) -> int:
        """The trial that a questionnaire is about which begins now (-1: none)."""
        due = next((due for due in self.due if due.questionnaire == questionnaire), None)
        if due is not None:
            return due.trial
        return self.running.trial if self.running is not None else -1
