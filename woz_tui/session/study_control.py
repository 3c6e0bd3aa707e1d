"""Carries out what concerns the study: conditions, trials, breaks, preflight ticks.

Every change is a message; what follows from them is the timeline's. Refusals are `RequestError`s.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from woz_tui.bus.hub import Hub
from woz_tui.config.experiment import Experiment
from woz_tui.config.study import Design
from woz_tui.config.utterance_template import VISITOR, names
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.requesters import WIZARD
from woz_tui.session.condition_proposal import ConditionProposal, Owed, propose
from woz_tui.session.earlier_sessions import EarlierSessions
from woz_tui.session.participant_identity import SessionIdentity, check_condition, check_participant
from woz_tui.session.session_plan import study_settings
from woz_tui.session.variables import VariableValues, by_condition
from woz_tui.timeline.session_state import SessionState

#: Where the wizard chose the order, and no design did.
BY_HAND = "hand"


class StudyController:
    """The study of a session.

    Args:
        hub: Where everything is published.
        state: What holds in the session.
        read: Gives the experiment as its file was read last.
        identity: Gives who takes part, and under which condition.
        set_trial: Sets participant, condition and trial; None leaves one as it is.
        allow_next: Raises `RequestError` while something is under way into which neither another
            trial nor another participant may come.
        tell_owed: Tells what a participant has yet to do from earlier sessions.
        logs: The folders with the logs of earlier sessions and with that of this one.
    """

    def __init__(
        self,
        hub: Hub,
        state: SessionState,
        *,
        read: Callable[[], Experiment],
        identity: Callable[[], SessionIdentity],
        set_trial: Callable[[str | None, str | None, int | None], None],
        allow_next: Callable[[], None],
        tell_owed: Callable[[str, Owed], None],
        logs: Iterable[Path],
    ) -> None:
        self._hub, self._read = hub, read
        self._identity, self._set_trial = identity, set_trial
        #: What holds, and what the file says.
        self.state = state.study
        self.settings = self.state.settings = study_settings(read())
        self._earlier = EarlierSessions(*logs)
        self._proposed: dict[str, ConditionProposal] = {}
        self._allow_next, self._tell_owed = allow_next, tell_owed

    # -- beginning and ending ----------------------------------------------------------------------

    def begin(self) -> None:
        """Say what is kept from the wizard, if the file keeps anything."""
        study = self._read().study
        if study.perception.hide or study.perception.blur:
            self._publish_perception()

    def adopt(self) -> None:
        """Go on with a changed file; what is under way goes on as it began."""
        old, new = self.settings, study_settings(self._read())
        self.settings = self.state.settings = new
        self._proposed.clear()
        if old.perception != new.perception:
            self._publish_perception()

    def close(self) -> None:
        """The session ends: so does what is under way."""
        self._end_break("the session ended")
        self._end_trial("aborted", "the session ended")

    def _publish_perception(self) -> None:
        perception = self._read().study.perception
        self._hub.publish(
            m.PerceptionChanged(hidden=[*perception.hide], blurred=[*perception.blur])
        )

    # -- values ------------------------------------------------------------------------------------

    def filled(self, values: Mapping[str, str]) -> VariableValues:
        """`values`, and the variables that depend on the condition."""
        texts = self._read().by_condition
        now, why = by_condition(texts, self._identity().condition, values)
        tells: dict[str, tuple[str, ...]]
        tells = {"condition": ("condition",), VISITOR: ("identity",)}
        for name, found in texts.items():
            whose = any(VISITOR in names(text) for text in found.values())
            tells[name] = ("condition", "identity") if whose else ("condition",)
        return VariableValues({**now, **values}, why, tells)

    def label(self, condition: str) -> str:
        """What a blind wizard reads instead of a condition; `?` if the file no longer names it."""
        blind = self.settings.blind
        return blind.get(condition, "?") if blind else condition

    # -- conditions --------------------------------------------------------------------------------

    def propose(self, participant: str) -> ConditionProposal:
        """The order for this participant, from what the logs say. Reads files: to be called from a
        thread of its own, one at a time.
        """
        experiment = self._read()
        design = self._design()
        check_participant(participant, experiment.participant_pattern)
        found = self._earlier.read(experiment.title, experiment.path.name, self.settings)
        proposal = propose(participant, design, experiment.conditions, found.past)
        if found.unreadable:
            left_out = f"; not counted because they cannot be read: {', '.join(found.unreadable)}"
            proposal = replace(proposal, why=proposal.why + left_out)
        self._proposed[participant] = proposal
        return proposal

    def _design(self) -> Design:
        design = self._read().study.design
        if design is None:
            raise RequestError(
                "the file has no design",
                "add one to the file, for example design: {order: latin-square}",
            )
        return design

    def assign(self, participant: str, order: list[str], by: str = WIZARD) -> None:
        """This participant gets the conditions in this order, from the next trial on. `by`: who
        says so.
        """
        design, experiment = self._design(), self._read()
        check_participant(participant, experiment.participant_pattern)
        self._between_trials()
        _check_order(order, design, experiment.conditions)
        proposal = self._proposed.get(participant)
        as_proposed = proposal if proposal and [*proposal.order] == order else None
        trial = as_proposed.trial if as_proposed else 1
        place = min((trial - 1) // design.trials, len(order) - 1)
        self._set_trial(participant, order[place] if order else None, trial)
        self._hub.publish(
            m.ConditionsAssigned(
                participant=participant,
                order=order,
                method=as_proposed.method if as_proposed else BY_HAND,
                row=as_proposed.row if as_proposed else -1,
                why=as_proposed.why if as_proposed else f"chosen by {by}",
                trials=design.trials,
                over=[*as_proposed.over] if as_proposed else [],
            )
        )
        if as_proposed:
            self._tell_owed(participant, as_proposed.owed)

    def allow(self, participant: str | None, *, other_trial: bool = False) -> None:
        """Raises `RequestError` if the participant, or the trial's number, cannot change now."""
        if other_trial or participant not in (None, self.state.participant):
            self._between_trials()

    def _between_trials(self) -> None:
        if (trial := self.state.trial) is not None:
            raise RequestError(
                f"trial {trial.started.trial} is running", "end it first", command="trial"
            )
        self._allow_next()

    # -- trials and breaks -------------------------------------------------------------------------

    def trial(self, what: str, text: str, tells: tuple[str, ...] = ()) -> None:
        """Begin or end a trial or a break; `what` as in `AskTrial`, `tells` what `text` does."""
        match what:
            case "begin":
                self._begin_trial()
            case "break":
                if self.state.in_break is not None:
                    raise RequestError("a break is already running")
                self._hub.publish(m.BreakStarted(text=text, tells=tells))
            case "resume":
                if self.state.in_break is None:
                    raise RequestError("no break is running")
                self._end_break(text, tells)
            case _:
                if self.state.trial is None:
                    raise RequestError("no trial is running", "start one", command="trial")
                self._end_break("")
                self._end_trial(what, text, tells)

    def _begin_trial(self) -> None:
        state = self.state
        if not state.participant:
            raise RequestError("no participant is set", "choose one first", command="start")
        self._between_trials()
        number = state.next_trial
        if state.all_over:
            raise RequestError(
                f"all {state.planned} trials of {state.participant} are done",
                "choose the next participant, or set a trial number to repeat a trial",
                command="start",
            )
        condition = state.condition_of(number) or state.condition
        conditions = self._read().conditions
        if conditions and not condition:
            raise RequestError(
                "no condition is set", "choose the participant's order first", command="start"
            )
        if conditions and condition not in conditions:  # not named: the wizard may be blind
            raise RequestError(
                f"the file no longer has the condition of trial {number} of {state.participant}",
                "choose a new order, whose trials begin with the first, or give the condition its"
                " old name and read the file again",
                command="start",
            )
        identity = self._identity()
        if (identity.condition, identity.trial) != (condition, number):
            changed = condition if condition != identity.condition else None
            self._set_trial(None, changed, number)
        self._end_break("")
        self._hub.publish(m.TrialStarted(trial=number, condition=condition, planned=state.planned))

    def _end_trial(self, outcome: str, text: str, tells: tuple[str, ...] = ()) -> None:
        if (trial := self.state.trial) is not None:
            number = trial.started.trial
            self._hub.publish(m.TrialEnded(trial=number, outcome=outcome, text=text, tells=tells))

    def _end_break(self, text: str, tells: tuple[str, ...] = ()) -> None:
        if self.state.in_break is not None:
            self._hub.publish(m.BreakEnded(text=text, tells=tells))

    # -- preflight ---------------------------------------------------------------------------------

    def check(self, check: str, ok: bool, text: str, source: str) -> None:
        """Tick a line of the file's list, or take the tick away."""
        known = [each.check for each in self.settings.preflight]
        if check not in known:
            raise RequestError(
                f"the preflight list has no {check!r}",
                f"there are {', '.join(known)}" if known else "the file has none: preflight: [...]",
            )
        level = "ok" if ok else "warning"
        self._hub.publish(m.PreflightChecked(check=check, level=level, detail=text, source=source))


def _check_order(order: list[str], design: Design, conditions: tuple[str, ...]) -> None:
    """Raises `RequestError` unless the design allows it, whichever order it proposes itself."""
    for condition in order:
        check_condition(condition, conditions)
    if len(set(order)) < len(order):
        raise RequestError("the order has a condition twice")
    if design.within and len(order) < len(conditions):
        raise RequestError("each participant gets all conditions; the order lacks some")
    if not design.within and len(order) != 1:
        raise RequestError("each participant gets one condition")
