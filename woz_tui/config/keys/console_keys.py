"""The console's own keys, as data; a wizard's keymap file may move all but the stop."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class BuiltinKey:
    """One key of the console.

    `reserves` are taken, in this order, on terminals where `chord` cannot arrive. `yields`: an
    experiment may have `chord` for an action of its own; this key then goes to a reserve. `last`:
    it yields to the console's other keys too, and to their reserves.
    """

    id: str
    chord: str
    description: str
    movable: bool = True
    reserves: tuple[str, ...] = ()
    yields: bool = False
    last: bool = False


#: Keys for the repairs that have lost their own.
_SPARE = (*"}~|\\", "home", "end", "insert")

BUILTIN_KEYS: tuple[BuiltinKey, ...] = (
    BuiltinKey("stop", "escape", "stop everything", movable=False),
    BuiltinKey("stop_too", "ctrl+c", "stop everything", movable=False),
    BuiltinKey("release", "ctrl+r", "release the stop"),
    BuiltinKey("script_next", "space", "play the script's next line"),
    BuiltinKey("script_back", "<", "script one line back, without playing"),
    BuiltinKey("script_on", ">", "script one line on, without playing"),
    BuiltinKey("phase_next", ")", "go on to the next phase", reserves=("^", "!"), yields=True),
    BuiltinKey("phases", '"', "choose the phase", reserves=("'", "}"), yields=True),
    BuiltinKey("say", "/", "type something to say"),
    BuiltinKey("find", ":", "find any action by typing"),
    BuiltinKey("find_too", "ctrl+p", "find any action by typing"),
    BuiltinKey(
        *("peek", "'", "see what a key would do, without playing it"),
        reserves=("`", "{"),
        yields=True,
    ),
    BuiltinKey("marker", ".", "put a marker into the log"),
    BuiltinKey("note", ",", "write a note into the log"),
    BuiltinKey("mistake_last", "backspace", "mark the last action as a mistake"),
    BuiltinKey("mistake", "ctrl+w", "choose an action and mark it as a mistake"),
    BuiltinKey("cut", "ctrl+x", "interrupt the last action"),
    BuiltinKey(
        *("queue", "ctrl+j", "list the queue: what waits, in which lane, for how long"),
        reserves=("insert", "]"),
        yields=True,
        last=True,
    ),
    BuiltinKey(
        *("queue_empty", "delete", "empty the queue; what runs goes on"),
        reserves=("[", "end"),
        yields=True,
        last=True,
    ),
    *(
        BuiltinKey(f"repair_{name}", chord, what, reserves=_SPARE, yields=True, last=True)
        for name, chord, what in (
            ("repeat", "$", "repair: repeat the last sentence"),
            ("reword", "#", "repair: the last sentence in other words"),
            ("filler", "{", "repair: let me think"),
            ("yes", "(", "repair: yes"),
            ("no", "&", "repair: no"),
            ("dont_know", "[", "repair: I do not know"),
            ("please_repeat", "]", "repair: please say that again"),
            ("interrupt", "!", "repair: interrupt and type a sentence"),
        )
    ),
    BuiltinKey(
        *("take_over", "end", "play the robot from this console, where nobody plays it"),
        reserves=("insert", "home", "}"),
        yields=True,
        last=True,
    ),
    BuiltinKey("failures", "enter", "list failures and mark them as seen"),
    BuiltinKey(
        *("events", "|", "filter the events: all, own acts, faults, machine"),
        reserves=("home",),
        yields=True,
        last=True,
    ),
    BuiltinKey("panel_next", "tab", "next page of panels, or next panel"),
    BuiltinKey("panel_back", "shift+tab", "page before, or previous panel"),
    BuiltinKey(
        *("page_next", "pagedown", "next page of panels, or next panel"),
        reserves=("insert",),
        yields=True,
        last=True,
    ),
    BuiltinKey(
        *("page_back", "pageup", "page before, or previous panel"),
        reserves=("home",),
        yields=True,
        last=True,
    ),
    BuiltinKey("head_up", "up", "head up"),
    BuiltinKey("head_down", "down", "head down"),
    BuiltinKey("head_left", "left", "head to the left"),
    BuiltinKey("head_right", "right", "head to the right"),
    BuiltinKey("drive_forward", "alt+up", "drive forward", reserves=("ctrl+u",)),
    BuiltinKey("drive_back", "alt+down", "drive back", reserves=("ctrl+n",)),
    BuiltinKey("drive_left", "alt+left", "turn left", reserves=("ctrl+y",)),
    BuiltinKey("drive_right", "alt+right", "turn right", reserves=("ctrl+o",)),
    BuiltinKey("hip_forward", "shift+up", "bend the hip forward", reserves=("ctrl+k",)),
    BuiltinKey("hip_back", "shift+down", "bend the hip back", reserves=("ctrl+v",)),
    BuiltinKey("hip_left", "shift+left", "lean the hip to the left", reserves=("ctrl+g",)),
    BuiltinKey("hip_right", "shift+right", "lean the hip to the right", reserves=("ctrl+s",)),
    BuiltinKey("start", "ctrl+t", "participant, condition, trial"),
    BuiltinKey("trial", "*", "trials, breaks, questionnaires"),
    BuiltinKey("preflight", "ctrl+f", "preflight: check that everything is ready"),
    BuiltinKey("reload", "ctrl+e", "reload the experiment file"),
    BuiltinKey("drivers", "ctrl+d", "state of each driver, and what to do"),
    BuiltinKey("body", ";", "the robot's body and face in full size, with all values"),
    BuiltinKey("knobs", "+", "the MIDI panel: function and position of each control"),
    BuiltinKey(
        *("engagement", "=", "engagement: the whole model, and control by hand"),
        reserves=("ctrl+a",),
    ),
    BuiltinKey("robot", "@", "the robot's settings", reserves=("ctrl+b", "&", "("), yields=True),
    BuiltinKey("move", "%", "type the name of an animation", reserves=("$", "~"), yields=True),
    BuiltinKey("camera", "_", "camera picture of the robot", reserves=("|", "#"), yields=True),
    BuiltinKey("profile", "-", "choose the profile: what may be used"),
    BuiltinKey("redraw", "ctrl+l", "redraw the screen"),
    BuiltinKey("theme", "ctrl+]", "colours: dark, light, the terminal's own"),
    BuiltinKey("help", "?", "list of all keys"),
    BuiltinKey("suspend", "ctrl+z", "suspend the console; the robot goes on"),
    BuiltinKey("leave", "ctrl+q", "quit: end the session or leave it running"),
)


def builtin_key(name: str) -> BuiltinKey | None:
    """The console's key with this id, or None."""
    return next((item for item in BUILTIN_KEYS if item.id == name), None)


def builtin_keys_with(
    repairs: Collection[str], builtins: Iterable[BuiltinKey]
) -> tuple[BuiltinKey, ...]:
    """`builtins` without the keys of repairs that the experiment does not have."""
    return tuple(
        item
        for item in builtins
        if not item.id.startswith("repair_") or item.id.replace("_", " ", 1) in repairs
    )
