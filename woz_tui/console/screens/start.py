"""Who takes part, and under which condition. Codes, never names."""

from __future__ import annotations

import re
from collections.abc import Iterable

from textual.content import Content
from textual.widget import Widget
from textual.widgets import Input, RadioButton, RadioSet, Static

from woz_tui.console.glyphs import Glyphs
from woz_tui.console.screens.dialog import Form
from woz_tui.core.requests import AskSet

#: What a code may look like if the experiment file does not say.
PATTERN = "[A-Za-z0-9]{1,16}"


def wrong_code(code: str, pattern: str) -> str:
    """Why `code` cannot be a participant, or an empty string."""
    if not code:
        return "A participant needs a code."
    try:
        fits = re.fullmatch(pattern, code) is not None
    except re.error:
        fits = True  # the robot process checks it again
    return "" if fits else f"{code!r} does not match the file's pattern {pattern}"


def wrong_trial(text: str) -> str:
    """Why `text` cannot be a trial's number, or an empty string; it may be left empty."""
    return "" if not text or text.isdecimal() else f"a trial is a whole number, not {text!r}"


class Choice(RadioButton):
    """A radio button that is told from its neighbours by its sign, not by colour alone."""

    def __init__(self, label: str, chosen: bool, glyphs: Glyphs) -> None:
        self._chosen_sign = glyphs.yes
        self._sign(chosen)
        if glyphs.ascii:
            self.BUTTON_LEFT, self.BUTTON_RIGHT = "(", ")"
        super().__init__(Content(label), value=chosen)

    def _sign(self, chosen: bool) -> None:
        self.BUTTON_INNER = self._chosen_sign if chosen else " "

    def watch_value(self) -> None:
        """Show the sign of the new value."""
        self._sign(self.value)
        super().watch_value()


class StartDialog(Form):
    """Participant, condition, trial; enter in a field accepts all."""

    heading = "Participant"
    hint = "tab next field · enter accepts · ctrl+q closes"

    def body(self) -> Iterable[Widget]:
        """Fields filled in with what holds now."""
        picture = self.picture
        yield Static("Code of the participant (never a name)", classes="caption")
        yield Input(picture.participant, placeholder=self._pattern(), id="participant")
        if picture.conditions:
            yield Static("Condition", classes="caption")
            with RadioSet(id="condition"):
                for condition in picture.conditions:
                    yield Choice(condition, condition == picture.condition, self.glyphs)
        yield Static("Trial (may stay empty)", classes="caption")
        yield Input("" if picture.trial is None else str(picture.trial), id="trial")
        yield Static("", id="wrong", classes="wrong")

    def _pattern(self) -> str:
        pattern = self.picture.settings.get("participant_pattern")
        return pattern if isinstance(pattern, str) and pattern else PATTERN

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Accept everything at once."""
        event.stop()
        code = self.query_one("#participant", Input).value.strip()
        trial = self.query_one("#trial", Input).value.strip()
        wrong = wrong_code(code, self._pattern()) or self._no_condition() or wrong_trial(trial)
        self.complain(wrong)
        if not wrong:
            request = AskSet(
                participant=code,
                condition=self._condition(),
                trial=int(trial) if trial else None,
            )
            self.desk.ask(request, self.answered)

    def _condition(self) -> str | None:
        if not self.picture.conditions:
            return None
        index = self.query_one("#condition", RadioSet).pressed_index
        return self.picture.conditions[index] if index >= 0 else None

    def _no_condition(self) -> str:
        if self.picture.conditions and self._condition() is None:
            return "Choose a condition."
        return ""
