"""What a key would do, without playing it."""

from __future__ import annotations

from textual import events

from woz_tui.config.keys.textual_names import from_textual
from woz_tui.config.utterance_template import HIDDEN_TEXT
from woz_tui.console.bottom_rows import KEPT, step_words, upcoming
from woz_tui.console.cells import Row, clean
from woz_tui.console.key_caps import KeyCap, caption, key_name
from woz_tui.console.screens.dialog import LiveReportDialog


class PeekDialog(LiveReportDialog):
    """Press a key: its action, what it says and each of its steps. Nothing is sent."""

    heading = "What a key would do"
    hint = "press a key: nothing is played · ctrl+q closes"
    size_class = "wide"
    indent = 2
    _action = ""
    _typed = ""

    def lines(self) -> list[Row]:
        """The action of the key pressed last; before, the script's next one."""
        action = self._action or ("" if self._typed else upcoming(self.state))
        if action:
            return self._of(action)
        if self._typed:
            return [self._of_the_console()]
        return [(("Press the key of an action.", "muted"),)]

    def _of_the_console(self) -> Row:
        """A key that plays no action."""
        app, key = self.console_app, key_name(self._typed, self.glyphs)
        own = app.keymap.builtin_table.get(self._typed)
        if own is None and any(chord.startswith(f"{self._typed} ") for chord in app.keymap.table):
            waits = f" {self.glyphs.ellipsis} waits for its second key"
            return ((key, "key"), (waits, "muted"))
        if own is None:
            return ((f"{key} is not assigned", "warn"),)
        return ((f"{key} ", "key"), (app.commands[own].words, "strong"))

    def _of(self, name: str) -> list[Row]:
        app, state, glyphs = self.console_app, self.state, self.glyphs
        panel = next(
            (each for each in state.panels if any(a.name == name for a in each.actions)), None
        )
        view = state.action(name)
        key = caption(app.caps.get(name, KeyCap("")), glyphs)
        where = panel.title if panel is not None else ""
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
            script = key_name(app.key_of("script_next"), glyphs)
            rows.append(((f"{script} plays it next", "muted"),))
        if (panel is not None and state.is_locked(panel)) or (view is not None and view.locked):
            rows.append((("It is locked and plays nothing.", "warn"),))
        elif panel is not None and (played := clean(state.played_by(panel))):
            rows.append(((f"It is played by {played}.", "warn"),))
        said = state.sentence(name)
        if said == HIDDEN_TEXT:
            rows += [(), ((KEPT, "muted"),)]
        elif said:
            rows += [(), ((f"{glyphs.opening}{said}{glyphs.closing}", "plain"),)]
        steps = [glyphs.plain(step_words(step)) for step in state.steps(name)]
        if not said or len(steps) > 1 or " + " in "".join(steps):
            rows.append(())
            rows += [((f"{n}. ", "muted"), (step, "plain")) for n, step in enumerate(steps, 1)]
        return rows

    def on_key(self, event: events.Key) -> None:
        """A key of an action, perhaps the second one of two; of the script; or of this dialog."""
        chord = from_textual(event.key, event.character)
        if not chord:
            return
        event.stop()
        event.prevent_default()
        app = self.console_app
        keys = app.keymap
        if chord == app.key_of("peek"):
            self.leave()
            return
        both = f"{self._typed} {chord}"
        self._typed = both if both in keys.table else chord
        own = keys.builtin_table.get(chord, "")
        repair = own.replace("_", " ", 1) if own.startswith("repair_") else ""
        played = upcoming(self.state) if own == "script_next" else repair
        self._action = keys.table.get(self._typed, played)
        self.refreshed()
