"""Who takes part, and under which condition. Codes, never names."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.events import Mount
from textual.message import Message
from textual.widget import Widget
from textual.widgets import Input, RadioButton, RadioSet, Static

from woz_tui.config.participant_pattern import example
from woz_tui.console.drawing.cells import Row, clean
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.console.screens.dialog import FormDialog, content, plain, refusal_text
from woz_tui.console.screens.trial import order_row
from woz_tui.protocol.requests import AskAssign, AskProposal, AskSet, Reply

#: What a code may look like if the experiment file does not say.
PATTERN = r"P\d\d"


def trial_error(text: str) -> str:
    """Why `text` cannot be a trial's number, or an empty string; it may be left empty."""
    return "" if not text or text.isdecimal() else f"a trial is a whole number, not {text!r}"


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
    match data:
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
    told = ", ".join(part for part in (proposal.method, proposal.why) if part)
    trial = f"trial {proposal.trial}" if proposal.trial is not None else "the first trial"
    where = f" in {proposal.condition}" if proposal.condition else ""
    return [
        (("Proposed  ", "muted"), *order_row(proposal.order, proposal.condition, glyphs.here)),
        ((f"next: {trial}{where}", "strong"),),
        ((told, "muted"),),
    ]


class ConditionButton(RadioButton):
    """A radio button that is told from its neighbours by its sign, not by colour alone."""

    def __init__(self, label: str, chosen: bool, glyphs: Glyphs) -> None:
        self._chosen_sign = glyphs.yes
        self._sign(chosen)
        if glyphs.ascii:
            self.BUTTON_LEFT, self.BUTTON_RIGHT = "(", ")"
        super().__init__(plain(label), value=chosen)

    def _sign(self, chosen: bool) -> None:
        self.BUTTON_INNER = self._chosen_sign if chosen else " "

    def watch_value(self) -> None:
        """Show the sign of the new value."""
        self._sign(self.value)
        super().watch_value()


class ConditionList(RadioSet):
    """What is lit is chosen: arrows choose, and enter accepts the whole dialog, as in a field. As
    long as nothing is chosen nothing is lit.
    """

    BINDINGS: ClassVar[list[BindingType]] = [Binding("enter", "accept")]

    class Accepted(Message):
        """Enter was pressed; what it chose is chosen."""

    def _on_mount(self, event: Mount) -> None:
        """The cursor is on what is chosen, not on the first."""
        event.prevent_default()  # Textual would call the one below once more
        super()._on_mount(event)
        self._selected = self.pressed_index if self.pressed_index >= 0 else None

    def clear(self) -> None:
        """Nothing is chosen any more."""
        with self.prevent(RadioButton.Changed):
            for button in self.query(ConditionButton):
                button.value = False
        self._pressed_button = self._selected = None

    def action_next_button(self) -> None:
        """Choose the next one."""
        super().action_next_button()
        self._choose()

    def action_previous_button(self) -> None:
        """Choose the one before."""
        super().action_previous_button()
        self._choose()

    def action_toggle_button(self) -> None:
        """Choose what is lit, or the first."""
        if self._selected is None:
            super().action_next_button()
        self._choose()

    def _choose(self) -> None:
        """What is lit is chosen, once there are buttons to choose from."""
        if self._selected is not None and self._selected != self.pressed_index and self.is_mounted:
            super().action_toggle_button()

    def action_accept(self) -> None:
        """A choice may be a message on its way: the acceptance goes behind it."""
        self.call_after_refresh(self.post_message, self.Accepted())


class StartDialog(FormDialog):
    """Participant, condition, trial; enter in a field accepts all.

    In an experiment with a design the robot process proposes the order of the conditions as soon as
    the code is complete; whoever knows better chooses otherwise.

    Args:
        then: What comes once it has been accepted.
    """

    heading = "Participant"
    hint = "tab: next · arrows: condition · enter accepts · ctrl+q closes"

    def __init__(self, then: Callable[[], object] | None = None) -> None:
        super().__init__()
        self._then = then
        self._proposal: ProposedOrder | None = None
        #: Why there is none for this code; empty: nothing is wrong.
        self._refused = ""
        self._for = ""
        #: A proposal was asked for, and enter was pressed before it came.
        self._awaited = self._accepts = False
        #: Trial and condition of the participant before were taken out of their fields.
        self._cleared = False

    def body(self) -> Iterable[Widget]:
        """Fields filled in with what holds now."""
        state, study = self.state, self.state.session.study
        yield Static("Code of the participant (never a name)", classes="caption")
        yield Input(clean(self._present()), placeholder=clean(self._pattern()), id="participant")
        own = Static("Order (edit to override)", classes="caption", id="order-caption")
        for field in (Static("", id="proposal"), own, Input(id="order")):
            field.display = False
            yield field
        if state.plan.conditions:
            yield Static("Condition", classes="caption one")
            with ConditionList(id="condition"):
                for condition in state.plan.conditions:
                    yield ConditionButton(condition, condition == study.condition, self.glyphs)
        yield Static("Trial (optional)", classes="caption")
        yield Input("" if study.number is None else str(study.number), id="trial")
        if start := state.session.start:
            wizard = f"Wizard {clean(start.wizard)}; another" if start.wizard else "Wizard's code"
            yield Static(f"{wizard}: woz run --wizard CODE", classes="caption")
        yield Static("", id="wrong", classes="wrong")

    def on_mount(self) -> None:
        """Ask for the present participant's order."""
        self._ask_proposal(self._present())
        self.call_after_refresh(self._take_typed)

    def answered(self, reply: Reply) -> None:
        """Close, or say why not; then what was to come."""
        super().answered(reply)
        if reply.ok and self._then is not None:
            self._then()

    def _take_typed(self) -> None:
        """What was typed before the dialog was there is the beginning of the code."""
        typed = self.console_app.keyboard.session_came()
        for field in self.query("#participant").results(Input) if typed else ():
            field.focus()
            field.insert_text_at_cursor(typed)

    def closing(self) -> None:
        """The robot is played from now on, also if there was no time to put this together."""
        self.console_app.keyboard.session_came()

    def _present(self) -> str:
        """Who takes part; nobody yet: whoever did before the robot process was lost."""
        return self.state.session.study.participant or self.state.before

    def _pattern(self) -> str:
        found = example(self.state.settings.participant_pattern or PATTERN)
        return f"e.g. {found}" if found else ""

    # -- what is proposed -----------------------------------------------------------------------

    def on_input_changed(self, event: Input.Changed) -> None:
        """Ask what a complete code should get."""
        if event.input.id == "participant":
            event.stop()
            self._ask_proposal(event.value.strip())

    def _ask_proposal(self, code: str) -> None:
        if code == self._for:
            return
        self._for = code
        self.complain("")
        self._propose(None)
        self._accepts, self._refused = False, ""
        study = self.state.session.study
        if study.participant not in ("", code) and not study.designed:
            self._clear_previous()
        self._awaited = study.designed and bool(code)
        if self._awaited:
            self.requests.ask(
                AskProposal(participant=code), functools.partial(self._proposed, code)
            )

    def _clear_previous(self) -> None:
        """Somebody else takes part: trial and condition of the one before are not theirs."""
        if self._cleared:
            return
        self._cleared = True
        self.query_one("#trial", Input).value = ""
        for conditions in self.query(ConditionList):
            conditions.clear()

    def _proposed(self, code: str, reply: Reply) -> None:
        """Without a design there is nothing to propose."""
        if code != self._for:
            return
        self._awaited = False
        if reply.ok:
            self._propose(proposal_of(reply.data))
        else:
            self._refused = refusal_text(reply)
        if self._accepts:
            self._accept()

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
        if proposal is not None:
            self._fill_in(proposal)

    def _fill_in(self, proposal: ProposedOrder) -> None:
        """The fields say what is proposed, until somebody writes otherwise."""
        self.query_one("#order", Input).value = ", ".join(proposal.order)
        if proposal.trial is not None:
            self.query_one("#trial", Input).value = str(proposal.trial)
        if proposal.condition in self.state.plan.conditions:
            chosen = self.state.plan.conditions.index(proposal.condition)
            for button in list(self.query(ConditionButton))[chosen : chosen + 1]:
                button.value = True

    # -- accepting ------------------------------------------------------------------------------

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Accept everything at once."""
        event.stop()
        self.on_condition_list_accepted()

    def on_condition_list_accepted(self) -> None:
        """So does enter on a condition; what is about to be proposed is part of it."""
        if self._awaited:
            self._accepts = True
        else:
            self._accept()

    def _accept(self) -> None:
        self._accepts = False
        code = self.query_one("#participant", Input).value.strip()
        trial = self.query_one("#trial", Input).value.strip()
        wrong = "" if code else "A participant needs a code."
        wrong = wrong or self._wrong_order() or trial_error(trial)
        self.complain(wrong)
        if wrong:
            return
        number = int(trial) if trial else None
        if self._proposal is None:
            condition = self._condition()
            asks = AskSet(participant=code, condition=condition, trial=number)
            self.requests.ask(asks, self.answered)
        else:
            self._assign(code, number)

    def _assign(self, code: str, trial: int | None) -> None:
        """The order, unless it is the participant's already: then only another trial."""
        study, order = self.state.session.study, self._order()
        if code == study.participant and [*order] == [*study.order]:
            self._assigned(trial if trial != study.number else None, Reply(ref=0, ok=True))
            return
        assign = AskAssign(participant=code, order=order)
        other = trial if self._proposal is not None and trial != self._proposal.trial else None
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
            condition = self._condition()
            return [condition] if condition is not None else []
        written = self.query_one("#order", Input).value
        if written == ", ".join(self._proposal.order):  # a condition's name may have commas
            return list(self._proposal.order)
        return [name.strip() for name in written.split(",") if name.strip()]

    def _wrong_order(self) -> str:
        """Why the order in its field cannot be, or an empty string."""
        if self._proposal is None or len(self._proposal.order) == 1:
            return self._no_condition()
        known = self.state.plan.conditions
        unknown = [name for name in self._order() if name not in known]
        if unknown:
            return f"There is no condition {unknown[0]!r}; there are: {', '.join(known)}"
        return "" if self._order() else "An order needs conditions."

    def _condition(self) -> str | None:
        if not self.state.plan.conditions:
            return None
        index = self.query_one("#condition", RadioSet).pressed_index
        return self.state.plan.conditions[index] if index >= 0 else None

    def _no_condition(self) -> str:
        if self.state.plan.conditions and self._condition() is None:
            return self._refused or "Choose a condition."
        return ""
