"""Remedies for the wizard: a verb that they name is the button that does it, where there is one."""

from __future__ import annotations

import re

from woz_tui.console.drawing.cells import clean
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.protocol.messages import FilledCall, Json

#: A verb, with an argument or without, as it stands in an experiment file: `torque: on`.
_CALL = re.compile(r"`(?P<verb>\w+)(?:: (?P<value>[^`{}\[\]]+))?`")
_SAME = {"on": "true", "yes": "true", "off": "false", "no": "false"}


def remedy_text(remedy: str, state: ConsoleState) -> str:
    """`switch them on first: Awake (w)` for what a driver calls `torque: on`.

    What no button does stays as it is: it can be found by typing.
    """
    told, end = "", 0
    for call in _CALL.finditer(remedy):
        name = button_of(call["verb"], call["value"], state)
        key, label = state.keys.get(name, ""), clean(state.label(name))
        button = f"{label} ({key})" if key else f"“{label}”" if name else call[0]
        told += remedy[end : call.start()] + button
        end = call.end()
    return told + remedy[end:]


def button_of(verb: str, value: str | None, state: ConsoleState) -> str:
    """The action that sends a verb, with an argument of this value if one is given; of several one
    that has a key, and the fewest other verbs. Empty: there is none.
    """
    sizes = {
        action.name: len(calls)
        for panel in state.panels
        for action in panel.actions
        if (calls := state.calls(action.name)) and any(_does(verb, value, call) for call in calls)
    }
    return min(sizes, key=lambda name: (not state.keys.get(name), sizes[name]), default="")


def _does(verb: str, value: str | None, call: FilledCall) -> bool:
    return call.verb == verb and (value is None or _plain(value) in map(_plain, call.args.values()))


def _plain(value: Json) -> str:
    text = str(value).strip().lower()
    return _SAME.get(text, text)
