"""The field in which a slot is filled in, in the rows of the next sentence."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

from textual import events
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.widgets import Input, Static

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row, clean
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.screens.dialog import Dialog, content
from woz_tui.features.scripts.kinds import AskScript
from woz_tui.features.scripts.shown_script import shown_script
from woz_tui.features.slots.console import around, offers, with_hint
from woz_tui.features.slots.history import kept_values
from woz_tui.features.slots.open_slots import gap, heard, open_slots, slots_of, view_of
from woz_tui.features.slots.slot_value import LONGEST, SlotValueError, checked_value, tidied
from woz_tui.protocol.requests import AskAction

#: Cells of the field: at least, and how many more than what stands in it.
FIELD, MORE = 14, 3


class SlotInput(Input):
    """A field in which a digit takes what is offered, as long as nothing has been typed."""

    def __init__(self, takes: Callable[[str], bool]) -> None:
        super().__init__(id="slot", max_length=LONGEST)
        self._takes = takes

    def on_key(self, event: events.Key) -> None:
        """What is lit is as good as empty: a letter would replace it."""
        untouched = not self.value or len(self.selected_text) == len(self.value)
        if untouched and event.character and self._takes(event.character):
            event.stop()
            event.prevent_default()


class SlotDialog(Dialog):
    """Asks for one slot after the other, then plays the action.

    Args:
        action: Its name.
        keys: The keys that were pressed; empty: it was found.
        of_order: They play the script's next line.
    """

    typed_into = True
    BINDINGS: ClassVar[list[BindingType]] = [Binding("tab", "heard", priority=True)]

    def __init__(self, action: str, keys: str, *, of_order: bool) -> None:
        super().__init__()
        self._action, self._keys, self._of_order = action, keys, of_order
        self._line: tuple[str, int] | None = None
        self._slots: list[str] = []
        self._at = 0
        self._values: dict[str, str] = {}
        self._sources: dict[str, str] = {}
        #: What was put in by tab, and which of the words that was.
        self._heard, self._word = "", -1
        self._wrong = ""
        self._began_us = 0

    def compose(self) -> ComposeResult:
        """The sentence with a field in it, and what it may get."""
        with Vertical(id="slots"):
            with Horizontal():
                yield Static("", id="before")
                yield SlotInput(self._take)
                yield Static("", id="after")
            yield Static("", id="offers")

    def on_mount(self) -> None:
        """The first slot that is open; where none is, all are asked for anew."""
        state = self.state
        self._began_us = self.console_app.clock.now_us()
        self._slots = open_slots(state, self._action) or slots_of(state, self._action)
        self._line = self._place() if self._of_order else None
        if not self._slots:
            self.leave()
            return
        self._begin()

    def takes_late(self, chord: str) -> bool:
        """A digit may say something, too."""
        return super().takes_late(chord) and not chord.isdigit()

    @property
    def _slot(self) -> str:
        return self._slots[self._at]

    @property
    def _entry(self) -> Input:
        return self.query_one("#slot", Input)

    def _place(self) -> tuple[str, int]:
        script = shown_script(self.state)
        return script.name, script.position

    def refreshed(self) -> None:
        """The script has moved on: what is asked for would be said elsewhere."""
        if self._line is not None and self._place() != self._line:
            self.leave()
        elif self._slots:
            self._show()

    def _begin(self) -> None:
        kept = kept_values(self.state.session).get(self._slot)
        self._heard, self._word, self._wrong = "", -1, ""
        entry = self._entry
        entry.placeholder = self._slot
        entry.value = clean(kept.text) if kept is not None else ""
        entry.focus()
        entry.action_select_all()
        self._show()

    def _show(self) -> None:
        """The sentence around the field, as much as there is room."""
        if not self.query("#slot"):
            return
        entry, width = self._entry, self.app.size.width
        field = min(max(FIELD, len(entry.value) + MORE), width // 2)
        frame = PaintFrame(width, 2, self.now, self.glyphs)
        before, after = around(
            gap(self.state, self._action, self._slot, self._values), frame, field
        )
        entry.styles.width = field
        self.update("before", content([((f" {before}", "strong"),)]))
        self.update("after", content([((after, "strong"),)]))
        free = say("slots.type", "type what stands here")
        row: Row = offers(self.state, self._slot) or ((f" {free}", "muted"),)
        if self._wrong:
            row = ((f" {self._wrong}", "warn"),)
        last = self._at + 1 == len(self._slots)
        hint = (
            say("slots.says_it", "enter says it · ctrl+q closes")
            if last
            else say("slots.goes_on", "enter goes on · ctrl+q closes")
        )
        keys = with_hint(row, hint, width, self.glyphs.ellipsis)
        shown = tuple((self.glyphs.plain(text), look) for text, look in keys)
        self.update("offers", content([shown]))

    def on_input_changed(self, event: Input.Changed) -> None:
        """The field grows with what is typed."""
        event.stop()
        self._wrong = ""
        self._show()

    def _take(self, digit: str) -> bool:
        """Whether a digit stands for something that is offered; then it is taken."""
        offered = view_of(self.state, self._slot).offer
        place = "123456789".find(digit)
        if not 0 <= place < len(offered) or not self.is_on_top:
            return False
        self._accept(offered[place], "offered")
        return True

    def action_heard(self) -> None:
        """The next of the words that were heard."""
        if words := heard(self.state, self._slot):
            self._word = (self._word + 1) % len(words)
            self._heard = words[self._word]
            self._entry.value = self._heard
            self._entry.cursor_position = len(self._heard)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """What stands in the field."""
        event.stop()
        if self.is_on_top:
            typed = tidied(event.value)
            self._accept(typed, "heard" if typed and typed == self._heard else "typed")

    def _accept(self, text: str, source: str) -> None:
        try:
            self._values[self._slot] = checked_value(text)
        except SlotValueError as error:
            wrong = word(error.args[0])
            self._wrong = say("slots.wrong", "{slot} {wrong}:", slot=self._slot, wrong=wrong)
            self._show()
            return
        self._sources[self._slot] = source
        if self._at + 1 < len(self._slots):
            self._at += 1
            self._begin()
        else:
            self._play()

    def _play(self) -> None:
        took_us = self.console_app.clock.now_us() - self._began_us
        filled: dict[str, Any] = {
            "key": self._keys,
            "slots": self._values,
            "slot_sources": self._sources,
            "slots_took_us": max(0, took_us),
        }
        self.leave()
        if self._line is not None:
            self.requests.ask(AskScript(to=self._line[1], **filled))
        else:
            source = "key" if self._keys else "palette"
            self.requests.ask(AskAction(action=self._action, source=source, **filled))
