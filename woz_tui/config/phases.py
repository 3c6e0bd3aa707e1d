"""Phases of an experiment: what is in front, what Space plays, which may follow.

phases:
  - {name: opening, title: Opening, panels: [Greeting], script: [Hello, Sit], planned: 2 min}
  - {name: whales, panels: [Whales], after: opening, on_enter: Show the whale}
  - {name: closing, panels: [Bye], after: opening, lock_others: true}
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from woz_tui.config.annotated_decoder import INVALID, fields_of, read_value
from woz_tui.config.experiment import PLANNED, Action, Phase
from woz_tui.config.problems import quoted
from woz_tui.config.yaml_cursor import (
    Cursor,
    is_set,
    missing,
    one_or_more,
    read_filled,
    read_texts,
)

#: What a phase may say.
FIELDS = tuple(item.name for item in fields_of(Phase))


def read_phases(
    cursor: Cursor | None, panels: Collection[str], actions: Mapping[str, Action]
) -> tuple[Phase, ...]:
    """The section `phases`; what is wrong with it is reported where it stands.

    `panels` are the titles of all panels, `actions` all actions by name.
    """
    entries = cursor.list("a list of phases") if cursor is not None else None
    if cursor is not None and entries == []:
        cursor.error("the list has no phase; add one, or remove phases")
    found = [(entry, phase) for entry in entries or () if (phase := _phase(entry)) is not None]
    names = [phase.name for _, phase in found]
    first: dict[str, int] = {}
    for entry, phase in found:
        table = dict(entry.entries())
        if phase.name in first:
            table.get("name", table.get("title", entry)).error(
                f"{quoted(phase.name)} is already the name of a phase (line {first[phase.name]})"
            )
        first.setdefault(phase.name, entry.place.line)
        _check_names(table.get("panels"), panels, "panel")
        _check_names(table.get("after"), names, "phase")
        for field in ("script", "on_enter"):
            _check_actions(table.get(field), actions, phase)
    _check_reachable(found)
    return tuple(phase for _, phase in found)


def _phase(cursor: Cursor) -> Phase | None:
    table = cursor.fields(FIELDS, "a phase has", "a phase, such as {name: opening, panels: [...]}")
    if table is None:
        return None
    title, name = read_filled(table.get("title")), read_filled(table.get("name"))
    if title is None and name is None and not {"title", "name"} & table.keys():
        missing({}, "name", cursor, "name in logs and tables")

    def texts(field: str, expected: str) -> tuple[str, ...]:
        return tuple(text for _, text in one_or_more(table.get(field), expected))

    planned: Any = read_value(table["planned"], float, (PLANNED,)) if "planned" in table else 0.0
    return Phase(
        name=name or title or "",
        title=title or "",
        panels=tuple(text for _, text in read_texts(table.get("panels"), once=True)),
        script=tuple(text for _, text in read_texts(table.get("script"))),
        on_enter=texts("on_enter", "the name of an action, or a list of them"),
        after=texts("after", "the name of a phase, or a list of them"),
        planned=0.0 if planned is INVALID else planned,
        lock_others=is_set(table.get("lock_others")),
    )


def _listed(cursor: Cursor | None) -> Iterator[tuple[Cursor, str]]:
    """What was read from a text or a list, without another report."""
    if cursor is not None:
        for entry in (*cursor.items(),) or (cursor,):
            text = getattr(entry.node, "text", "")
            if text.strip():
                yield entry, text


def _check_names(cursor: Cursor | None, known: Collection[str], what: str) -> None:
    for entry, name in _listed(cursor):
        if name not in known:
            near = entry.report.hint(name, known, or_list=f"{what}s are")
            entry.error(f"there is no {what} {quoted(name)}{near}")


def _check_actions(cursor: Cursor | None, actions: Mapping[str, Action], phase: Phase) -> None:
    for entry, name in _listed(cursor):
        action = actions.get(name)
        if action is None:
            near = entry.report.hint(name, actions)
            entry.error(f"there is no action {quoted(name)}{near}")
        elif action.locked:
            entry.warning(f"{quoted(name)} is locked and cannot be played")
        elif phase.panels and action.panel not in phase.panels:
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
