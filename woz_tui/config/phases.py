"""Phases of an experiment: what is in front, what Space plays, which may follow.

phases:
  - {name: opening, title: Opening, panels: [Greeting], script: [Hello, Sit], planned: 2 min}
  - {name: whales, panels: [Whales], after: opening, on_enter: Show the whale}
  - {name: closing, panels: [Bye], after: opening, lock_others: true}
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from woz_tui.config.action_names import check_actions
from woz_tui.config.annotated_decoder import read_entries
from woz_tui.config.experiment import Action, Phase
from woz_tui.config.problems import quoted
from woz_tui.config.yaml_cursor import Cursor, check_different, texts_of
from woz_tui.config.yaml_nodes import ListNode


def read_phases(
    cursor: Cursor | None, panels: Collection[str], actions: Mapping[str, Action]
) -> tuple[Phase, ...]:
    """The section `phases`; what is wrong with it is reported where it stands.

    `panels` are the titles of all panels, `actions` all actions by name.
    """
    if cursor is not None and isinstance(cursor.node, ListNode) and not cursor.node.nodes:
        cursor.error("the list has no phase; add one, or remove phases")
    found = [
        (entry, replace(phase, name=phase.name or phase.title))
        for entry, phase in read_entries(cursor, "a list of phases", Phase)
    ]
    names = [phase.name for _, phase in found]
    check_different([(entry, phase.name) for entry, phase in found], "a phase", ("name", "title"))
    for entry, phase in found:
        table = dict(entry.entries())
        _check_names(table.get("panels"), panels, "panel")
        _check_names(table.get("after"), names, "phase")
        for field in ("script", "on_enter"):
            _check_actions(table.get(field), actions, phase)
    _check_reachable(found)
    return tuple(phase for _, phase in found)


def _check_names(cursor: Cursor | None, known: Collection[str], what: str) -> None:
    for entry, name in texts_of(cursor):
        if name not in known:
            near = entry.report.hint(name, known, or_list=f"{what}s are")
            entry.error(f"there is no {what} {quoted(name)}{near}")


def _check_actions(cursor: Cursor | None, actions: Mapping[str, Action], phase: Phase) -> None:
    for entry, action in check_actions(cursor, actions):
        if phase.panels and action.panel not in phase.panels:
            panel = f"the panel {quoted(action.panel)} is not in front in this phase"
            entry.warning(f"{panel}; add it to panels: [...]")


def _check_reachable(found: Sequence[tuple[Cursor, Phase]]) -> None:
    """Warn of phases that can never begin; the first one begins by itself."""
    reached = {phase.name for _, phase in found[:1]}
    reached |= {phase.name for _, phase in found if not phase.after}
    more = True
    while more:
        new = {phase.name for _, phase in found if reached.intersection(phase.after)} - reached
        reached |= new
        more = bool(new)
    for number, (entry, phase) in enumerate(found):
        after = dict(entry.entries()).get("after")
        if after is not None and not number and phase.after:
            after.warning("the first phase begins by itself; after has no effect here")
        elif after is not None and phase.name not in reached:
            after.warning(f"{quoted(phase.name)} can never begin: none of these phases can")
