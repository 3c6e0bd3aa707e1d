"""The console's own keys, as data; a wizard's keymap file may move all but the stop."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Builtin:
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

BUILTIN: tuple[Builtin, ...] = (
    Builtin("stop", "escape", "stop everything", movable=False),
    Builtin("stop_too", "ctrl+c", "stop everything", movable=False),
    Builtin("release", "ctrl+r", "release the stop"),
    Builtin("script_next", "space", "play the script's next line"),
    Builtin("script_back", "<", "script one line back, without playing"),
    Builtin("script_on", ">", "script one line on, without playing"),
    Builtin("phase_next", ")", "go on to the next phase", reserves=("^", "!"), yields=True),
    Builtin("phases", '"', "choose the phase", reserves=("'", "}"), yields=True),
    Builtin("say", "/", "type something to say"),
    Builtin("find", ":", "find any action by typing"),
    Builtin("find_too", "ctrl+p", "find any action by typing"),
    Builtin(
        *("peek", "'", "see what a key would do, without playing it"),
        reserves=("`", "{"),
        yields=True,
    ),
    Builtin("marker", ".", "put a marker into the log"),
    Builtin("note", ",", "write a note into the log"),
    Builtin("mistake_last", "backspace", "mark the last action as a mistake"),
    Builtin("mistake", "ctrl+w", "choose an action and mark it as a mistake"),
    Builtin("cut", "ctrl+x", "interrupt the last action"),
    Builtin(
        *("queue", "ctrl+j", "list the queue: what waits, in which lane, for how long"),
        reserves=("insert", "]"),
        yields=True,
        last=True,
    ),
    Builtin(
        *("queue_empty", "delete", "empty the queue; what runs goes on"),
        reserves=("[", "end"),
        yields=True,
        last=True,
    ),
    *(
        Builtin(f"repair_{name}", chord, what, reserves=_SPARE, yields=True, last=True)
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
    Builtin(
        *("take_over", "end", "play the robot from this console, where nobody plays it"),
        reserves=("insert", "home", "}"),
        yields=True,
        last=True,
    ),
    Builtin("failures", "enter", "list failures and mark them as seen"),
    Builtin(
        *("events", "|", "filter the events: all, own acts, faults, machine"),
        reserves=("home",),
        yields=True,
        last=True,
    ),
    Builtin("panel_next", "tab", "next page of panels, or next panel"),
    Builtin("panel_back", "shift+tab", "page before, or previous panel"),
    Builtin(
        *("page_next", "pagedown", "next page of panels, or next panel"),
        reserves=("insert",),
        yields=True,
        last=True,
    ),
    Builtin(
        *("page_back", "pageup", "page before, or previous panel"),
        reserves=("home",),
        yields=True,
        last=True,
    ),
    Builtin("head_up", "up", "head up"),
    Builtin("head_down", "down", "head down"),
    Builtin("head_left", "left", "head to the left"),
    Builtin("head_right", "right", "head to the right"),
    Builtin("drive_forward", "alt+up", "drive forward", reserves=("ctrl+u",)),
    Builtin("drive_back", "alt+down", "drive back", reserves=("ctrl+n",)),
    Builtin("drive_left", "alt+left", "turn left", reserves=("ctrl+y",)),
    Builtin("drive_right", "alt+right", "turn right", reserves=("ctrl+o",)),
    Builtin("hip_forward", "shift+up", "bend the hip forward", reserves=("ctrl+k",)),
    Builtin("hip_back", "shift+down", "bend the hip back", reserves=("ctrl+v",)),
    Builtin("hip_left", "shift+left", "lean the hip to the left", reserves=("ctrl+g",)),
    Builtin("hip_right", "shift+right", "lean the hip to the right", reserves=("ctrl+s",)),
    Builtin("start", "ctrl+t", "participant, condition, trial"),
    Builtin("trial", "*", "trials, breaks, questionnaires"),
    Builtin("preflight", "ctrl+f", "preflight: check that everything is ready"),
    Builtin("reload", "ctrl+e", "reload the experiment file"),
    Builtin("drivers", "ctrl+d", "state of each driver, and what to do"),
    Builtin("body", ";", "the robot's body and face in full size, with all values"),
    Builtin("knobs", "+", "the MIDI panel: function and position of each control"),
    Builtin(
        *("engagement", "=", "engagement: the whole model, and control by hand"),
        reserves=("ctrl+a",),
    ),
    Builtin("robot", "@", "the robot's settings", reserves=("ctrl+b", "&", "("), yields=True),
    Builtin("move", "%", "type the name of an animation", reserves=("$", "~"), yields=True),
    Builtin("camera", "_", "camera picture of the robot", reserves=("|", "#"), yields=True),
    Builtin("profile", "-", "choose the profile: what may be used"),
    Builtin("redraw", "ctrl+l", "redraw the screen"),
    Builtin("theme", "ctrl+]", "colours: dark, light, the terminal's own"),
    Builtin("help", "?", "list of all keys"),
    Builtin("suspend", "ctrl+z", "suspend the console; the robot goes on"),
    Builtin("leave", "ctrl+q", "quit: end the session or leave it running"),
)


def builtin(name: str) -> Builtin | None:
    """The console's key with this id, or None."""
    return next((item for item in BUILTIN if item.id == name), None)


def builtins_with(repairs: Collection[str], builtins: Iterable[Builtin]) -> tuple[Builtin, ...]:
    """`builtins` without the keys of repairs that the experiment does not have."""
    return tuple(
        item
        for item in builtins
        if not item.id.startswith("repair_") or item.id.replace("_", " ", 1) in repairs
    )
