"""Names of actions where a file refers to them."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.config.experiment import Action
from woz_tui.config.problems import quoted
from woz_tui.config.yaml_cursor import Cursor, texts_of


def check_actions(
    names: Cursor | None, actions: Mapping[str, Action], purpose: str = "be played"
) -> list[tuple[Cursor, Action]]:
    """Report names of actions that do not exist or are locked; return the others with places."""
    found = []
    for entry, name in texts_of(names):
        action = actions.get(name)
        if action is None:
            near = entry.report.hint(name, actions, or_list="actions are")
            entry.error(f"there is no action {quoted(name)}{near}")
        elif action.locked:
            entry.warning(f"{quoted(name)} is locked and cannot {purpose}")
        else:
            found.append((entry, action))
    return found
