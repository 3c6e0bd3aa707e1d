"""Names of actions where a file refers to them."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.config.experiment import Action
from woz_tui.config.problems import quoted
from woz_tui.config.yaml_cursor import Cursor, texts_of
from woz_tui.protocol.sentence import Sentence


def check_actions(
    names: Cursor | None, actions: Mapping[str, Action], *, answers: bool = False
) -> list[tuple[Cursor, Action]]:
    """Report names of actions that do not exist or are locked; return the others with places.
    `answers`: they are to be played as the answer to a cue.
    """
    found = []
    for entry, name in texts_of(names):
        action = actions.get(name)
        if action is None:
            near = entry.report.hint(
                name, actions, or_list=Sentence("check.actions_are", "actions are")
            )
            entry.error(
                Sentence(
                    "check.no_action",
                    "there is no action {name}{near}",
                    name=quoted(name),
                    near=near,
                )
            )
        elif action.locked:
            named = quoted(name)
            entry.warning(
                Sentence("check.no_answer", "{name} is locked and cannot be an answer", name=named)
                if answers
                else Sentence("check.locked", "{name} is locked and cannot be played", name=named)
            )
        else:
            found.append((entry, action))
    return found
