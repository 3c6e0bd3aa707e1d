"""Remedies for the wizard: a verb that they name is the button that does it, where there is one."""

from __future__ import annotations

import re

from woz_tui.console.cells import clean
from woz_tui.console.console_state import ConsoleState
from woz_tui.protocol.messages import FilledCall, Json

#: A verb, with an argument or without, as it stands in an experiment file: `torque: on`.
_CALL = re.compile(r"`(?P<verb>\w+)(?:: (?P<value>[^`{}\[\]]+))?`")
_SAME = {"on": "true", "yes": "true", "off": "false", "no": "false"}


def remedy_text(remedy: str, state: ConsoleState) -> str:
    """`switch them on first: Awake (w)` for what a driver calls `torque: on`.

    What no button does stays as it is: it can be found by typing.
    """
    return _CALL.sub(lambda found: _button(found, state) or found[0], remedy)


def _button(found: re.Match[str], state: ConsoleState) -> str:
    """The button with the fewest other calls, and its key; empty: there is none."""
    sizes = {
        action.name: len(calls)
        for panel in state.panels
        for action in panel.actions
        if (calls := state.calls(action.name)) and any(_does(found, call) for call in calls)
    }
    if not sizes:
        return ""
    name = min(sizes, key=lambda each: (not state.keys.get(each), sizes[each]))
    key = state.keys.get(name, "")
    return f"{clean(state.label(name))} ({key})" if key else f"“{clean(state.label(name))}”"


def _does(found: re.Match[str], call: FilledCall) -> bool:
    value = found["value"]
    return call.verb == found["verb"] and (
        value is None or _plain(value) in map(_plain, call.args.values())
    )


def _plain(value: Json) -> str:
    text = str(value).strip().lower()
    return _SAME.get(text, text)
