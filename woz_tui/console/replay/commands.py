"""Commands of a replay: its keys move through the log, none of them plays anything."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from woz_tui.config.keys.console_keys import BuiltinKey
from woz_tui.console import commands as session
from woz_tui.console.commands import Run, opens
from woz_tui.console.input.keyboard import Keyboard
from woz_tui.console.replay.timeline import KEYS
from woz_tui.console.screens.dialog import REPLAY, ConsoleCommand
from woz_tui.console.widgets.feature_console import KeyHint
from woz_tui.protocol.requests import AskMistake, AskReplay
from woz_tui.protocol.sentence import Sentence

#: Seconds that one press of an arrow goes, and one with shift or alt.
NEAR_S, FAR_S = 5.0, 60.0


def _row(*keys: BuiltinKey, run: Run | None = None, hint: KeyHint | None = None) -> ConsoleCommand:
    return ConsoleCommand(keys, run, hint=hint, users=REPLAY)


def _moves(*keys: BuiltinKey, hint: KeyHint | None = None, **more: Any) -> ConsoleCommand:
    """Moves through the log."""
    return ConsoleCommand(keys, sends=lambda press: AskReplay(**more), hint=hint, users=REPLAY)


COMMANDS = (
    _moves(
        BuiltinKey("pause", "space", Sentence("replay.key_pause", "stand still, go on")),
        what="pause",
        hint=KeyHint(1, Sentence("replay.hint_pause", "pause")),
    ),
    _moves(
        BuiltinKey("step", ".", Sentence("replay.key_step", "to the next line of the log")),
        what="step",
        hint=KeyHint(2, Sentence("replay.hint_step", "step")),
    ),
    _moves(
        BuiltinKey("slower", "[", Sentence("replay.key_slower", "half the speed, down to 0.25x")),
        BuiltinKey("slower_too", "<", Sentence("replay.key_slower_too", "half the speed")),
        what="slower",
        hint=KeyHint(3, Sentence("replay.hint_slower", "slower")),
    ),
    _moves(
        BuiltinKey("faster", "]", Sentence("replay.key_faster", "twice the speed, up to 16x")),
        BuiltinKey("faster_too", ">", Sentence("replay.key_faster_too", "twice the speed")),
        what="faster",
        hint=KeyHint(4, Sentence("replay.hint_faster", "faster")),
    ),
    _moves(
        BuiltinKey("back", "left", Sentence("replay.key_back", "5 s back")),
        what="seek",
        by_s=-NEAR_S,
        hint=KeyHint(5, Sentence("replay.hint_back", "5 s back")),
    ),
    _moves(
        BuiltinKey("on", "right", Sentence("replay.key_on", "5 s on")),
        what="seek",
        by_s=NEAR_S,
        hint=KeyHint(6, Sentence("replay.hint_on_5", "5 s on")),
    ),
    _moves(
        BuiltinKey("far_back", "shift+left", Sentence("replay.key_far_back", "60 s back")),
        BuiltinKey("far_back_too", "alt+left", Sentence("replay.key_far_back", "60 s back")),
        what="seek",
        by_s=-FAR_S,
    ),
    _moves(
        BuiltinKey("far_on", "shift+right", Sentence("replay.key_far_on", "60 s on")),
        BuiltinKey("far_on_too", "alt+right", Sentence("replay.key_far_on", "60 s on")),
        what="seek",
        by_s=FAR_S,
    ),
    _moves(
        BuiltinKey(
            "mark_back",
            "pageup",
            Sentence("replay.key_mark_back", "to the marker, stop, trial ... before"),
        ),
        what="go",
        to="before",
    ),
    _moves(
        BuiltinKey(
            "mark_on",
            "pagedown",
            Sentence("replay.key_mark_on", "to the next marker, stop, trial ..."),
        ),
        what="go",
        to="next",
    ),
    _moves(
        BuiltinKey("begin", "home", Sentence("replay.key_begin", "to the beginning")),
        what="go",
        to="start",
    ),
    _moves(BuiltinKey("end", "end", Sentence("replay.key_end", "to the end")), what="go", to="end"),
    _row(
        BuiltinKey(
            "go", "g", Sentence("replay.key_go", "go to a time, or to a marker, stop, trial ...")
        ),
        run=opens("replay.dialogs:GoDialog"),
        hint=KeyHint(7, Sentence("replay.hint_go_to", "go to")),
    ),
    _row(
        BuiltinKey(
            "code", "m", Sentence("replay.key_code", "set a code at this moment (with --coder)")
        ),
        run=opens("replay.dialogs:CodeDialog"),
    ),
    _row(
        BuiltinKey(
            "code_note",
            "n",
            Sentence("replay.key_code_note", "write a note about this moment (with --coder)"),
        ),
        run=opens("replay.dialogs:CodeNoteDialog"),
    ),
    ConsoleCommand(
        (
            BuiltinKey(
                "code_back",
                "x",
                Sentence("replay.key_code_back", "take your last code or note back (with --coder)"),
            ),
        ),
        sends=lambda press: AskMistake(),
        users=REPLAY,
    ),
    _row(
        BuiltinKey(
            "about",
            "i",
            Sentence("replay.key_about", "what this log is, and what is missing in it"),
        ),
        run=opens("replay.dialogs:AboutDialog"),
    ),
    *(replace(command, hint=None) for command in session.COMMANDS if command.serves("replay")),
    _row(
        BuiltinKey(
            "engagement",
            "=",
            Sentence(
                "replay.key_engagement",
                "who was there and were they with the robot: the whole model",
            ),
        ),
        run=opens("screens.engagement:EngagementDialog"),
    ),
    _row(
        BuiltinKey(
            "suspend", "ctrl+z", Sentence("replay.key_suspend", "leave the console for a moment")
        )
    ),
    _row(
        BuiltinKey("help", "?", Sentence("replay.key_help", "these keys")),
        run=opens("replay.dialogs:ReplayHelp"),
        hint=KeyHint(8, KEYS),
    ),
    _row(
        BuiltinKey(
            "leave", "ctrl+q", Sentence("replay.key_leave", "leave; nothing is changed by a replay")
        ),
        run=lambda app: app.exit("left"),
        hint=KeyHint(9, Sentence("replay.hint_leave", "leave")),
    ),
    _row(
        BuiltinKey(
            "stop",
            "escape",
            Sentence("replay.key_stop", "closes a dialog; nothing moves in a replay"),
            movable=False,
        ),
        BuiltinKey(
            "stop_too", "ctrl+c", Sentence("replay.key_stop_too", "the same"), movable=False
        ),
    ),
)


class ReplayKeyboard(Keyboard):
    """A keyboard to which no key is too old: it does no harm in a replay."""

    def arrive(self, chord: str, *, age_us: int = 0, stale: bool = False, at_us: int = 0) -> bool:
        """A key from the terminal."""
        return super().arrive(chord)

    def press(self, chord: str, *, age_us: int = 0, stale: bool = False) -> bool:
        """A key that came by way of the screen."""
        return super().press(chord)
