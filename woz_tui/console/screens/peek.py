"""What a key would do, without playing it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual import events

from woz_tui.config.keys.console_keys import played_by
from woz_tui.config.keys.textual_names import from_textual
from woz_tui.config.screen_language import say, word
from woz_tui.config.utterance_template import HIDDEN_TEXT
from woz_tui.console.drawing.cells import Row, clean
from woz_tui.console.drawing.key_caps import KeyCap, caption, key_name
from woz_tui.console.input.keyboard import HELD_US
from woz_tui.console.screens.dialog import ConsoleApp, LiveReportDialog
from woz_tui.console.widgets.bottom_rows import (
    KEPT,
    asks_again,
    order_keys,
    step_words,
    upcoming,
)
from woz_tui.protocol.sentence import Sentence

if TYPE_CHECKING:
    from woz_tui.config.keys.keymap import KeyMap


def open_peek(app: ConsoleApp) -> None:
    """Show the action that comes next; the key of an action shows that action instead."""
    app.open_dialog(PeekDialog(app.keymap))


class PeekDialog(LiveReportDialog):
    """The first key of an action shows what it says and each of its steps, and sends nothing. Any
    other key, and any key after it, closes this and does what it always does.
    """

    heading = Sentence("peek.heading", "What a key would do")
    hint = Sentence("peek.hint", "key of an action: see it · any other key closes this and acts")
    size_class = "wide"
    indent = 2
    plays = True
    ends_with_key = True
    _action = ""
    _typed = ""
    #: When the last key came, on the clock.
    _came_us = 0

    def __init__(self, keys: KeyMap) -> None:
        super().__init__()
        beside = [key for key, name in keys.builtin_table.items() if played_by(name)]
        self.own_keys = frozenset([*" ".join(keys.table).split(), *beside])

    def lines(self) -> list[Row]:
        """The action of the key pressed last; before, what comes next."""
        action = self._action or ("" if self._typed else upcoming(self.state))
        if action:
            return self._action_rows(action)
        if self._typed:
            key = key_name(self._typed, self.glyphs)
            waits = say("peek.second_key", "waits for its second key")
            return [((key, "key"), (f" {self.glyphs.ellipsis} {waits}", "muted"))]
        return [((say("peek.press", "Press the key of an action."), "muted"),)]

    def _action_rows(self, name: str) -> list[Row]:
        app, state, glyphs = self.console_app, self.state, self.glyphs
        panel = next(
            (each for each in state.panels if any(a.name == name for a in each.actions)), None
        )
        view = state.action(name)
        key = caption(app.caps.get(name, KeyCap("")), glyphs)
        where = state.title(panel) if panel is not None else ""
        rows: list[Row] = [
            (
                (f"{key} " if key else "", "key"),
                (state.label(name), "strong"),
                (f"  {where}", "muted"),
            )
        ]
        if view is not None and view.help:
            rows.append(((view.help, "muted"),))
        if name == upcoming(state):
            key = key_name(app.key_of(order_keys()[0]), glyphs)
            rows.append(((say("peek.next", "{key} plays it next", key=key), "muted"),))
        if (panel is not None and state.is_locked(panel)) or (view is not None and view.locked):
            rows.append(((say("peek.locked", "It is locked and plays nothing."), "warn"),))
        elif panel is not None and (played := clean(state.played_by(panel))):
            rows.append(((say("peek.played_by", "It is played by {part}.", part=played), "warn"),))
        said = state.sentence(name)
        if said == HIDDEN_TEXT:
            rows += [(), ((word(KEPT), "muted"),)]
        elif said:
            rows += [(), ((f"{glyphs.opening}{said}{glyphs.closing}", "plain"),)]
        steps = [glyphs.plain(step_words(step)) for step in state.steps(name)]
        if not said or len(steps) > 1 or " + " in "".join(steps):
            rows.append(())
            rows += [((f"{n}. ", "muted"), (step, "plain")) for n, step in enumerate(steps, 1)]
        return rows

    def on_key(self, event: events.Key) -> None:
        """The key of an action, perhaps the second one of two."""
        chord = from_textual(event.key, event.character)
        event.stop()
        event.prevent_default()
        app = self.console_app
        now = app.clock.now_us()
        held, self._came_us = now - self._came_us < HELD_US, now
        if self._action:
            if not held:  # pressed once more: now it counts
                self.leave()
                if not app.keyboard.press(chord):
                    app.do(app.keymap.builtin_table[chord])
            return
        keys = app.keymap
        both = f"{self._typed} {chord}"
        self._typed = both if both in keys.table else chord
        self._action = keys.table.get(self._typed, played_by(keys.builtin_table.get(chord, "")))
        if self._action and asks_again(self.state, self._action) is not None:
            self.leave()
            app.ask_words(self._action, self._typed)
            return
        if self._action:
            self.own_keys = frozenset((chord,))
            app.give_keys()
            self.show_hint(say("peek.any_key", "any key closes this and does what it always does"))
        self.refreshed()
