"""Conditions and trials of a session: who gets which, when one begins and ends, and breaks.

Every change is a message; what follows from them is the timeline's. Refusals are `RequestError`s.
"""

from __future__ import annotations

import asyncio
from dataclasses import replace

from woz_tui.config.experiment import Experiment
from woz_tui.features.study.condition_proposal import ConditionProposal, propose
from woz_tui.features.study.design import Design
from woz_tui.features.study.earlier_sessions import EarlierSessions
from woz_tui.features.study.kinds import AskAssign, AskProposal, AskTrial
from woz_tui.features.study.section import DESIGN
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.requesters import SESSION_ENDED, WIZARD
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.participant_identity import check_condition, check_participant
from woz_tui.session.session_features import Client, FeatureSession, SessionFeature

#: Where the wizard chose the order, and no design did.
BY_HAND = "hand"


class TrialController(SessionFeature):
    """Conditions and trials of a session."""

    requests = (AskAssign, AskTrial)
    lookups = (AskProposal,)

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        self.state = session.state.study
        self._earlier = EarlierSessions(*session.logs)
        self._proposed: dict[str, ConditionProposal] = {}

    def carry_out(self, request: AskAssign | AskTrial, client: Client) -> str:
        if isinstance(request, AskAssign):
            self.assign(request.participant, request.order, client.by)
        else:
            self.trial(request.what, request.text, client.tells)
        return ""

    def look_up(self, request: AskProposal) -> m.Json:
        return self.propose(request.participant).data()

    # -- beginning and ending ----------------------------------------------------------------------

    async def prepare(self) -> None:
        """Give the participant of the command line the order that the start dialog would propose;
        whoever names a condition there has chosen.
        """
        who = self.session.identity
        if not who.participant or who.condition or DESIGN.of(self.session.experiment) is None:
            return
        try:
            proposal = await asyncio.to_thread(self.propose, who.participant)
            self.assign(who.participant, [*proposal.order])
        except RequestError as error:
            self.session.hub.publish(
                m.Notice(
                    level="warning",
                    text=Sentence(
                        "study.no_order",
                        "{participant} has no order of conditions: {reason}",
                        participant=who.participant,
                        reason=error.reason,
                    ),
                    remedy=error.hint
                    or Sentence("study.choose_again", "choose the participant again"),
                )
            )

    def adopt(self, experiment: Experiment) -> None:
        """What is under way goes on as it began."""
        self._proposed.clear()

    def close(self) -> None:
        """What is under way ends with the session."""
        self._end_break(SESSION_ENDED)
        self._end_trial("aborted", SESSION_ENDED)

    # -- conditions --------------------------------------------------------------------------------

    def propose(self, participant: str) -> ConditionProposal:
        """The order for this participant, from what the logs say. Reads files: to be called from a
        thread of its own, one at a time.
        """
        experiment = self.session.experiment
        design = self._design()
        check_participant(participant, experiment.participant_pattern)
        found = self._earlier.read(experiment.title, experiment.path.name, self.state.settings)
        proposal = propose(participant, design, experiment.conditions, found.past)
        if found.unreadable:
            why = Sentence(
                "study.unreadable",
                "{why}; not counted because they cannot be read: {logs}",
                why=proposal.why,
                logs=", ".join(found.unreadable),
            )
            proposal = replace(proposal, why=why)
        self._proposed[participant] = proposal
        return proposal

    def _design(self) -> Design:
        design = DESIGN.of(self.session.experiment)
        if design is None:
            raise RequestError(
                Sentence("study.no_design", "the file has no design"),
                Sentence(
                    "study.add_design",
                    "add one to the file, for example design: {{order: latin-square}}",
                ),
            )
        return design

    def assign(self, participant: str, order: list[str], by: str = WIZARD) -> None:
        """This participant gets the conditions in this order, from the next trial on. `by`: who
        says so.
        """
        design, experiment = self._design(), self.session.experiment
        check_participant(participant, experiment.participant_pattern)
        self.session.allow_next()
        _check_order(order, design, experiment.conditions)
        proposal = self._proposed.get(participant)
        as_proposed = proposal if proposal and [*proposal.order] == order else None
        trial = as_proposed.trial if as_proposed else 1
        place = min((trial - 1) // design.trials, len(order) - 1)
        self.session.set(participant, order[place] if order else None, trial)
        self.session.hub.publish(
            m.ConditionsAssigned(
                participant=participant,
                order=order,
                method=as_proposed.method if as_proposed else BY_HAND,
                row=as_proposed.row if as_proposed else -1,
                why=as_proposed.why
                if as_proposed
                else Sentence("study.chosen_by", "chosen by {by}", by=by),
                trials=design.trials,
                over=[*as_proposed.over] if as_proposed else [],
            )
        )
        if as_proposed:
            self.session.tell_owed(participant, as_proposed.owed)

    def allow_next(self) -> None:
        if (trial := self.state.trial) is not None:
            raise RequestError(
                Sentence(
                    "study.trial_is_running", "trial {trial} is running", trial=trial.started.trial
                ),
                Sentence("study.end_trial", "end it first"),
                command="trial",
            )

    # -- trials and breaks -------------------------------------------------------------------------

    def trial(self, what: str, text: str, tells: tuple[str, ...] = ()) -> None:
        """Begin or end a trial or a break; `what` as in `AskTrial`, `tells` what `text` does."""
        match what:
            case "begin":
                self._begin_trial()
            case "break":
                if self.state.in_break is not None:
                    raise RequestError(
                        Sentence("study.break_running", "a break is already running")
                    )
                self.session.hub.publish(m.BreakStarted(text=text, tells=tells))
            case "resume":
                if self.state.in_break is None:
                    raise RequestError(Sentence("study.no_break", "no break is running"))
                self._end_break(text, tells)
            case _:
                if self.state.trial is None:
                    raise RequestError(
                        Sentence("study.no_trial", "no trial is running"),
                        Sentence("study.start_trial", "start one"),
                        command="trial",
                    )
                self._end_break("")
                self._end_trial(what, text, tells)

    def _begin_trial(self) -> None:
        state = self.state
        if not state.participant:
            raise RequestError(
                Sentence("study.no_participant", "no participant is set"),
                Sentence("study.choose_participant", "choose one first"),
                command="start",
            )
        self.session.allow_next()
        number = state.next_trial
        if state.all_over:
            raise RequestError(
                Sentence(
                    "study.all_done",
                    "all {planned} trials of {participant} are done",
                    planned=state.planned,
                    participant=state.participant,
                ),
                Sentence(
                    "study.next_participant",
                    "choose the next participant, or set a trial number to repeat a trial",
                ),
                command="start",
            )
        condition = state.condition_of(number) or state.condition
        conditions = self.session.experiment.conditions
        if conditions and not condition:
            raise RequestError(
                Sentence("session.condition_unset", "no condition is set"),
                Sentence("study.choose_order", "choose the participant's order first"),
                command="start",
            )
        if conditions and condition not in conditions:  # not named: the wizard may be blind
            raise RequestError(
                Sentence(
                    "study.condition_gone",
                    "the file no longer has the condition of trial {number} of {participant}",
                    number=number,
                    participant=state.participant,
                ),
                Sentence(
                    "study.new_order",
                    "choose a new order, whose trials begin with the first, or give the condition"
                    " its old name and read the file again",
                ),
                command="start",
            )
        identity = self.session.identity
        if (identity.condition, identity.trial) != (condition, number):
            changed = condition if condition != identity.condition else None
            self.session.set(None, changed, number)
        self._end_break("")
        self.session.hub.publish(
            m.TrialStarted(trial=number, condition=condition, planned=state.planned)
        )

    def _end_trial(self, outcome: str, text: str, tells: tuple[str, ...] = ()) -> None:
        if (trial := self.state.trial) is not None:
            number = trial.started.trial
            self.session.hub.publish(
                m.TrialEnded(trial=number, outcome=outcome, text=text, tells=tells)
            )

    def _end_break(self, text: str, tells: tuple[str, ...] = ()) -> None:
        if self.state.in_break is not None:
            self.session.hub.publish(m.BreakEnded(text=text, tells=tells))


def _check_order(order: list[str], design: Design, conditions: tuple[str, ...]) -> None:
    """Raises `RequestError` unless the design allows it, whichever order it proposes itself."""
    for condition in order:
        check_condition(condition, conditions)
    if len(set(order)) < len(order):
        raise RequestError(Sentence("study.condition_twice", "the order has a condition twice"))
    if design.within and len(order) < len(conditions):
        raise RequestError(
            Sentence(
                "study.order_lacks",
                "each participant gets all conditions; the order lacks some",
            )
        )
    if not design.within and len(order) != 1:
        raise RequestError(Sentence("study.one_condition", "each participant gets one condition"))
