"""Who takes part, and in which order they get the conditions: as it is proposed, or otherwise."""

from __future__ import annotations

import functools
from collections.abc import Iterable
from dataclasses import dataclass

from textual.widget import Widget
from textual.widgets import Input, Static

from woz_tui.config.screen_language import say, worded_data
from woz_tui.console.drawing.cells import Row
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.console.screens.dialog import content, refusal_text
from woz_tui.console.screens.start import ConditionButton, StartDialog
from woz_tui.console.state.event_sentences import method_word
from woz_tui.features.study.kinds import AskAssign, AskProposal
from woz_tui.features.study.trial_dialog import order_row
from woz_tui.protocol.requests import AskSet, Reply


@dataclass(frozen=True, slots=True)
class ProposedOrder:
    """What a participant should get: conditions in their order, and where the session goes on."""

    order: tuple[str, ...]
    method: str = ""
    row: int = -1
    why: str = ""
    condition: str = ""
    trial: int | None = None


def proposal_of(data: object) -> ProposedOrder | None:
    """As a reply tells it; None where it tells none."""
    match worded_data(data):
        case {"order": [*order], **more} if order:
            trial, row = more.get("trial"), more.get("row")
            return ProposedOrder(
                tuple(map(str, order)),
                str(more.get("method") or ""),
                row if isinstance(row, int) else -1,
                str(more.get("why") or ""),
                str(more.get("condition") or ""),
                trial if isinstance(trial, int) else None,
            )
    return None


def proposal_rows(proposal: ProposedOrder, glyphs: Glyphs) -> list[Row]:
    """The order with the present one marked, what comes next, and why."""
    told = ", ".join(part for part in (method_word(proposal.method), proposal.why) if part)
    return [
        (
            (f"{say('study.proposed', 'Proposed')}  ", "muted"),
            *order_row(proposal.order, proposal.condition, glyphs.here),
        ),
        ((_next_trial(proposal.trial, proposal.condition), "strong"),),
        ((told, "muted"),),
    ]


def _next_trial(trial: int | None, condition: str) -> str:
    if trial is None and not condition:
        return say("study.next_first", "next: the first trial")
    if trial is None:
        return say(
            "study.next_first_in", "next: the first trial in {condition}", condition=condition
        )
    if not condition:
        return say("study.next_trial", "next: trial {trial}", trial=trial)
    return say(
        "study.next_trial_in",
        "next: trial {trial} in {condition}",
        trial=trial,
        condition=condition,
    )


class OrderDialog(StartDialog):
    """The dialog of an experiment with a design: the robot process proposes the order of the
    conditions as soon as the code is complete; whoever knows better chooses otherwise.
    """

    def __init__(self) -> None:
        super().__init__()
        self._proposal: ProposedOrder | None = None
        #: Why there is none for this code; empty: nothing is wrong.
        self._refused = ""
        #: A proposal was asked for, and enter was pressed before it came.
        self._awaited = self._accepts = False

    def more_fields(self) -> Iterable[Widget]:
        """What is proposed, and the order, which can be edited."""
        caption = say("study.order", "Order (edit to override)")
        own = Static(caption, classes="caption", id="order-caption")
        for field in (Static("", id="proposal"), own, Input(id="order")):
            field.display = False
            yield field

    # -- what is proposed -----------------------------------------------------------------------

    def written(self, code: str) -> None:
        """Ask what a complete code should get."""
        self._propose(None)
        self._accepts, self._refused = False, ""
        self._awaited = self.state.session.study.designed and bool(code)
        if self._awaited:
            self.requests.ask(
                AskProposal(participant=code), functools.partial(self._proposed, code)
            )
        elif not self.state.session.study.designed:  # the file was read again meanwhile
            super().written(code)

    def _proposed(self, code: str, reply: Reply) -> None:
        if code != self._code:
            return
        self._awaited = False
        if reply.ok:
            self._propose(proposal_of(reply.data))
        else:
            self._refused = refusal_text(reply)
        if self._accepts:
            self.accept()

    def _propose(self, proposal: ProposedOrder | None) -> None:
        self._proposal = proposal
        for place in self.query("#proposal").results(Static):
            place.update(content(proposal_rows(proposal, self.glyphs) if proposal else []))
            place.display = proposal is not None
        several = proposal is not None and len(proposal.order) > 1
        for field in self.query("#order, #order-caption"):
            field.display = several
        for field in self.query("#condition, .one"):
            field.display = not several  # one follows from the order
        if proposal is None:
            return
        # The fields say what is proposed, until somebody writes otherwise.
        self.query_one("#order", Input).value = ", ".join(proposal.order)
        if proposal.trial is not None:
            self.query_one("#trial", Input).value = str(proposal.trial)
        if proposal.condition in self.state.plan.conditions:
            chosen = self.state.plan.conditions.index(proposal.condition)
            for button in list(self.query(ConditionButton))[chosen : chosen + 1]:
                button.value = True

    # -- accepting ------------------------------------------------------------------------------

    def accept(self) -> None:
        """What is about to be proposed is part of it."""
        self._accepts = self._awaited
        if not self._awaited:
            super().accept()

    def wrong_choice(self) -> str:
        """Why the order in its field cannot be, or an empty string."""
        if self._proposal is None or len(self._proposal.order) == 1:
            wrong = super().wrong_choice()
            return wrong and (self._refused or wrong)
        known = self.state.plan.conditions
        unknown = [name for name in self._order() if name not in known]
        if unknown:
            return say(
                "study.unknown_condition",
                "There is no condition {name!r}; there are: {known}",
                name=unknown[0],
                known=", ".join(known),
            )
        return "" if self._order() else say("study.empty_order", "An order needs conditions.")

    def ask(self, code: str, trial: int | None) -> None:
        """Ask for the order, unless it is the participant's already: then only another trial."""
        if self._proposal is None:
            super().ask(code, trial)
            return
        study, order = self.state.session.study, self._order()
        if code == study.participant and [*order] == [*study.order]:
            self._assigned(trial if trial != study.number else None, Reply(ref=0, ok=True))
            return
        assign = AskAssign(participant=code, order=order)
        other = trial if trial != self._proposal.trial else None
        self.requests.ask(assign, functools.partial(self._assigned, other))

    def _assigned(self, trial: int | None, reply: Reply) -> None:
        """Participant, order, condition and trial are set; another trial is asked for behind it."""
        if reply.ok and trial is not None:
            self.requests.ask(AskSet(trial=trial), self.answered)
        else:
            self.answered(reply)

    def _order(self) -> list[str]:
        """The order as it stands in its field; of one condition, the one chosen."""
        if self._proposal is None or len(self._proposal.order) < 2:
            condition = self.chosen()
            return [condition] if condition is not None else []
        written = self.query_one("#order", Input).value
        if written == ", ".join(self._proposal.order):  # a condition's name may have commas
            return list(self._proposal.order)
        return [name.strip() for name in written.split(",") if name.strip()]
