"""Who takes part, and under which condition. Codes, never names."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.containers import Horizontal
from textual.events import Mount
from textual.message import Message
from textual.widget import Widget
from textual.widgets import Input, RadioButton, RadioSet, Static

from woz_tui.config.participant_pattern import example
from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import clean
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.console.screens.dialog import FormDialog, plain
from woz_tui.console.widgets.feature_console import (
    FeatureConsole,
    ParticipantField,
    ParticipantForm,
)
from woz_tui.feature import answers_of, pieces
from woz_tui.protocol.requests import AskSet, Reply
from woz_tui.protocol.sentence import Sentence

#: What a code may look like if the experiment file does not say.
PATTERN = r"P\d\d"


def trial_error(text: str) -> str:
    """Why `text` cannot be a trial's number, or an empty string; it may be left empty."""
    if not text or text.isdecimal():
        return ""
    return say("start.trial_number", "a trial is a whole number, not {text!r}", text=text)


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
        super().action_next_button()
        self._choose()

    def action_previous_button(self) -> None:
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


def _forms() -> dict[str, ParticipantForm]:
    """What features ask of participants, by the feature's name."""
    consoles = pieces("console", FeatureConsole)
    return {name: form for name, each in consoles.items() if (form := each.describes) is not None}


def _input(field: ParticipantField) -> str:
    """The id of its input."""
    return f"field-{field.name}"


class StartDialog(FormDialog):
    """Participant, condition, trial; enter in a field accepts all. Where the wizard was ending the
    session, that goes on behind it.
    """

    heading: str = Sentence("start.heading", "Participant")
    hint = Sentence("start.hint", "tab: next · arrows: condition · enter accepts · ctrl+q closes")

    def __init__(self) -> None:
        super().__init__()
        #: The code that stands in its field.
        self._code: str | None = None
        #: Trial and condition of the participant before were taken out of their fields.
        self._cleared = self._leaving = False

    def body(self) -> Iterable[Widget]:
        """Fields filled in with what holds now."""
        state, study = self.state, self.state.session.study
        caption = say("start.code", "Code of the participant (never a name)")
        yield Static(plain(caption), classes="caption")
        code = example(state.settings.participant_pattern or PATTERN)
        pattern = clean(say("start.example", "e.g. {code}", code=code)) if code else ""
        yield Input(clean(self._present()), placeholder=pattern, id="participant")
        for name, form in _forms().items():
            for field in answers_of(name, form.fields, state, self._present()):
                with Horizontal(classes="field"):
                    yield Static(f"{clean(field.name)}: ", classes="caption")
                    yield Input(placeholder=clean(field.hint), id=_input(field))
        yield from self.more_fields()
        if state.plan.conditions:
            yield Static(plain(say("start.condition", "Condition")), classes="caption one")
            with ConditionList(id="condition"):
                for condition in state.plan.conditions:
                    yield ConditionButton(condition, condition == study.condition, self.glyphs)
        yield Static(plain(say("start.trial", "Trial (optional)")), classes="caption")
        yield Input("" if study.number is None else str(study.number), id="trial")
        if start := state.session.start:
            wizard = say("start.wizard", "Wizard's code: woz run --wizard CODE")
            if start.wizard:
                wizard = say(
                    "start.other_wizard",
                    "Wizard {code}; another: woz run --wizard CODE",
                    code=clean(start.wizard),
                )
            yield Static(plain(wizard), classes="caption")
        yield Static("", id="wrong", classes="wrong")

    def more_fields(self) -> Iterable[Widget]:
        """What else follows from the code."""
        return ()

    def on_mount(self) -> None:
        """The code of who takes part stands there already."""
        self._leaving, self.requests.leaving = self.requests.leaving, False
        self._write(self._present())
        self.call_after_refresh(self._take_typed)

    def answered(self, reply: Reply) -> None:
        """Close, or say why not."""
        super().answered(reply)
        if reply.ok and self._leaving:
            self.console_app.do("leave")

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

    # -- what is written ------------------------------------------------------------------------

    def on_input_changed(self, event: Input.Changed) -> None:
        """The code has changed, perhaps."""
        if event.input.id == "participant":
            event.stop()
            self._write(event.value.strip())

    def _write(self, code: str) -> None:
        if code != self._code:
            self._code = code
            self.complain("")
            self.written(code)

    def written(self, code: str) -> None:
        """Another code stands in its field: what is whose, if anything, is no more filled in."""
        if self.state.session.study.participant not in ("", code):
            self.clear_previous()

    def clear_previous(self) -> None:
        """Somebody else takes part: trial and condition of the one before are not theirs."""
        if self._cleared:
            return
        self._cleared = True
        self.query_one("#trial", Input).value = ""
        for conditions in self.query(ConditionList):
            conditions.clear()

    # -- accepting ------------------------------------------------------------------------------

    def on_input_submitted(self, event: Input.Submitted) -> None:
        event.stop()
        self.accept()

    def on_condition_list_accepted(self) -> None:
        """So does enter on a condition."""
        self.accept()

    def accept(self) -> None:
        """Ask for what stands in the fields, unless something is wrong with it."""
        code = self.query_one("#participant", Input).value.strip()
        trial = self.query_one("#trial", Input).value.strip()
        wrong = "" if code else say("start.no_code", "A participant needs a code.")
        wrong = wrong or self.wrong_choice() or trial_error(trial)
        self.complain(wrong)
        if not wrong:
            ask = functools.partial(self.ask, code, int(trial) if trial else None)
            self._describe(code, [*_forms().items()], ask)

    def _describe(
        self, code: str, forms: list[tuple[str, ParticipantForm]], then: Callable[[], object]
    ) -> None:
        """Say what was typed of the participant, of one form after the other; then the rest."""
        if not forms:
            then()
            return
        (name, form), *others = forms
        fields = answers_of(name, form.fields, self.state, code)
        typed = {
            each.name: text
            for each in fields
            for entry in self.query(f"#{_input(each)}").results(Input)
            if (text := entry.value.strip())
        }

        def answered(reply: Reply) -> None:
            if reply.ok:
                self._describe(code, others, then)
            else:
                self.answered(reply)

        if typed:
            self.requests.ask(form.request(code, typed), answered)
        else:
            self._describe(code, others, then)

    def wrong_choice(self) -> str:
        """Why the conditions cannot be as they were chosen, or an empty string."""
        if self.state.plan.conditions and not self.chosen():
            return say("start.choose", "Choose a condition.")
        return ""

    def ask(self, code: str, trial: int | None) -> None:
        """Ask the robot process for it."""
        asks = AskSet(participant=code, condition=self.chosen(), trial=trial)
        self.requests.ask(asks, self.answered)

    def chosen(self) -> str | None:
        """The condition that is chosen."""
        if not self.state.plan.conditions:
            return None
        index = self.query_one("#condition", RadioSet).pressed_index
        return self.state.plan.conditions[index] if index >= 0 else None
