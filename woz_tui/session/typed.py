"""Sentences that a wizard has typed: buttons of a panel of their own until the session ends."""

from __future__ import annotations

import string
from collections.abc import Sequence
from dataclasses import replace

from woz_tui.experiment.shape import Action, Call, Experiment, Panel, Place, Together

#: The title of their panel.
PANEL = "Typed"
#: So many are kept; the first make way.
MOST = 40
#: Letters of a sentence on its button and in its name.
LABEL = 40
_NOWHERE = Place("", 0, 0)
_KEYS = (*string.digits[1:], "0", *string.ascii_lowercase, *string.ascii_uppercase)


def with_typed(experiment: Experiment, typed: Sequence[Action]) -> Experiment:
    """The experiment with this panel, instead of the one it may have."""
    panels = without_typed(experiment).panels
    if typed:
        panels = (*panels, Panel(PANEL, tuple(typed), _NOWHERE))
    return replace(experiment, panels=panels)


def without_typed(experiment: Experiment) -> Experiment:
    """The experiment as its file has it."""
    panels = tuple(panel for panel in experiment.panels if panel.place is not _NOWHERE)
    return replace(experiment, panels=panels)


def added(
    experiment: Experiment, typed: tuple[Action, ...], text: str, driver: str
) -> tuple[Action, ...]:
    """`typed` with a button for this sentence of `driver`; as it is, if there is one."""
    call = Call("say", {"text": text}, driver, _NOWHERE)
    if any(action.calls == [call] for action in typed):
        return typed
    used = {action.name for panel in experiment.panels for action in panel.actions}
    label = text if len(text) <= LABEL else f"{text[: LABEL - 3].rstrip()}..."
    name, number = f"typed: {label}", 2
    while name in used:
        name, number = f"typed: {label} ({number})", number + 1
    step = Together((call,))
    action = Action(name, label, _free_key(experiment), PANEL, (step,), _NOWHERE, help="typed")
    return (*typed, action)[-MOST:]


def _free_key(experiment: Experiment) -> str:
    """A key that no action has or begins with; empty: all are taken."""
    taken = {
        action.key.split(" ")[0]
        for panel in experiment.panels
        for action in panel.actions
        if action.key
    }
    return next((key for key in _KEYS if key not in taken), "")
