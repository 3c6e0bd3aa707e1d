"""The whole engagement model in one picture, and the wizard's hand on it.

Keys play the robot as everywhere, until tab takes the model into the hand: then some letters are
the model's, and which actions they cover meanwhile is said. Everything else plays on.
"""

from __future__ import annotations

from dataclasses import replace

from textual import events

from woz_tui.config.keys.textual_names import from_textual
from woz_tui.config.performers import ENGAGEMENT
from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.engagement.full_engagement import full_rows
from woz_tui.console.screens.drawing import DrawingDialog
from woz_tui.console.screens.engagement_questions import steer
from woz_tui.console.state.wizard_overrides import BY_KEY, KEYS, legend_rows
from woz_tui.protocol.sentence import Sentence

_TAKE = frozenset(("tab", "shift+tab"))
_HINTS = {
    False: Sentence("hand.keys_play", "keys play · tab: by hand · ctrl+q closes"),
    True: Sentence("hand.steers", "BY HAND · tab: all keys play again · ctrl+q closes"),
}


class EngagementDialog(DrawingDialog):
    """States, signs, the condition, the way, what was said; beneath them what the keys do."""

    heading = Sentence("hand.heading", "Engagement")
    hint = _HINTS[False]

    def __init__(self) -> None:
        super().__init__()
        self._steers = False
        self.own_keys = _TAKE

    def on_mount(self) -> None:
        """In a replay there is nothing to take into the hand, and keys move through the log."""
        if self.state.replay is not None:
            self.own_keys = frozenset()
            self.console_app.give_keys()
            self.show_hint(say("dialog.closes", "ctrl+q closes"))

    def count(self) -> int:
        """One, in a session with a model that has said something."""
        return int(self.state.session.model.shown is not None)

    def rows(self, chosen: int, frame: PaintFrame) -> list[Row]:
        """The model, then the legend."""
        shown = self.state.session.model.shown
        if shown is None:
            return []
        table, glyphs = self.console_app.keymap.table, frame.glyphs
        # The hand's keys that play an action of this experiment, with the action's label.
        covered = {key: self.state.label(table[key]) for key in BY_KEY if key in table}
        legend = legend_rows(self.state.engaged, covered, frame.width, glyphs, steers=self._steers)
        if self.state.replay is not None:
            legend = []
        inner = replace(frame, height=max(1, frame.height - len(legend)))
        rows = full_rows(self.state, shown, inner)
        return [*rows, *[()] * (inner.height - len(rows)), *legend]

    def nothing(self) -> str:
        """What stands there in a session without a model."""
        if self.state.perception.hides("engagement"):
            return say("hand.kept", "In this experiment the engagement model is kept from you.")
        if ENGAGEMENT in self.state.verbs:
            return say("hand.nothing_yet", "Nothing has come from the engagement model yet.")
        none = say("hand.none", "This session has no engagement model.")
        how = say("hand.how", "An experiment gets one by a section in its file:")
        return f"{none}\n{how}\n  engagement: {{}}"

    def on_key(self, event: events.Key) -> None:
        """Take the model into the hand or give it back; with it in hand, its keys."""
        chord = from_textual(event.key, event.character)
        event.stop()
        if chord in _TAKE:
            if self.count() and self.state.replay is None:
                self._steers = not self._steers
                self.own_keys = _TAKE | KEYS if self._steers else _TAKE
                self.console_app.give_keys()
                self.show_hint(_HINTS[self._steers])
                self.query(".dialog").set_class(self._steers, "-steers")
                self.refreshed()
        elif self._steers and chord in BY_KEY:
            steer(self.console_app, BY_KEY[chord], chord)
