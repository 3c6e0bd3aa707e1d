"""Panels and actions: what each key does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from woz_tui.config.experiment import Action, Panel, Step, Wait
from woz_tui.config.keys.chords import KeyNameError, normal_key
from woz_tui.config.session_verbs import WAIT
from woz_tui.config.verb_calls import CallReader, Vocabulary
from woz_tui.config.yaml_cursor import (
    Cursor,
    is_set,
    missing,
    one_or_more,
    read_filled,
    read_seconds,
    read_text,
    read_texts,
    read_word,
)
from woz_tui.config.yaml_nodes import ListNode, ScalarNode
from woz_tui.drivers.fields import Range

#: What an action may say beside verbs and their arguments.
ACTION_FIELDS = ("key", "label", "name", "help", "locked", "when_busy", "on", "steps", "then")
PANEL_FIELDS = ("title", "locked", "covers", "actions")
_THEN = "the name of an action, or a list of them"
WHEN_BUSY = ("queue", "replace", "refuse")

#: Seconds. A longer pause inside an action is a slip of the decimal point.
_LONGEST_WAIT = Range(0.0, 3600.0, "s")


@dataclass(frozen=True, slots=True)
class ActionDraft:
    """An action with the path under which the file has it, for checks across the file."""

    path: str
    action: Action


class StepReader:
    """Reads what stands in one action: verbs together, or steps one after the other."""

    def __init__(self, vocabulary: Vocabulary) -> None:
        self._calls = CallReader(vocabulary)

    def together(self, cursor: Cursor, table: dict[str, Cursor], on: Cursor | None) -> Step | None:
        """The verbs of an action that has no steps."""
        return self._calls.read(cursor, table, on, ACTION_FIELDS)

    def step(self, cursor: Cursor, on: Cursor | None = None) -> Step | None:
        """`{say: Hello, eyes: green}` or `{wait: 0.5}`; `on` if the step names nobody itself."""
        table = cursor.table("a step, such as {say: Hello} or {wait: 0.5}")
        if table is None:
            return None
        if set(table) == {WAIT.name}:
            seconds = read_seconds(table[WAIT.name], _LONGEST_WAIT)
            return Wait(seconds or 0.0)
        return self._calls.read(cursor, table, table.pop("on", on), ("on", "wait"))


class PanelReader:
    """Reads `panels`; `drafts` are its actions, even those that have errors inside."""

    def __init__(self, steps: StepReader, layout: str) -> None:
        self._reader = steps
        self._layout = layout
        self.drafts: list[ActionDraft] = []

    def read(self, cursor: Cursor) -> list[Panel]:
        """Every panel that has a title and actions."""
        entries = cursor.list("a list of panels")
        if entries is not None and not entries:
            cursor.error("a panel is missing here")
        return [panel for entry in entries or () if (panel := self._panel(entry)) is not None]

    def _panel(self, cursor: Cursor) -> Panel | None:
        example = "a panel, such as {title: Speech, actions: [...]}"
        table = cursor.fields(PANEL_FIELDS, "a panel has", example)
        if table is None:
            return None
        title_cursor = missing(table, "title", cursor)
        title = read_text(title_cursor) if title_cursor is not None else None
        locked = is_set(table.get("locked"))
        listed = "a list of verbs, such as [drive, nudge]"
        covers = tuple(verb for _, verb in read_texts(table.get("covers"), listed, "a verb"))
        empty = bool(covers) and "actions" not in table
        actions_cursor = None if empty else missing(table, "actions", cursor)
        actions = self._actions(actions_cursor, title or "") if actions_cursor is not None else []
        return Panel(title or "", tuple(actions), cursor.place, locked, covers)

    def _actions(self, cursor: Cursor, panel: str) -> list[Action]:
        entries = cursor.list("a list of actions")
        if entries is not None and not entries:
            cursor.warning("an action is missing here")
        drafts = [self._action(entry, panel) for entry in entries or ()]
        found = [draft for draft in drafts if draft is not None]
        self.drafts += found
        return [draft.action for draft in found]

    def _action(self, cursor: Cursor, panel: str) -> ActionDraft | None:
        table = cursor.table("an action, such as {key: h, label: Hello, say: Hello!}")
        if table is None:
            return None
        fields = {name: table.pop(name) for name in ACTION_FIELDS if name in table}
        label = read_filled(fields.get("label"))
        name = read_filled(fields.get("name"))
        if label is None and name is None and not {"label", "name"} & fields.keys():
            missing({}, "label", cursor, "text on the button")
        when_busy = fields.get("when_busy")
        return ActionDraft(
            cursor.path,
            Action(
                name=name or label or "",
                label=label or name or "",
                key=self._key(fields.get("key")),
                panel=panel,
                steps=tuple(self._steps(cursor, fields, table)),
                place=cursor.place,
                when_busy=(when_busy and read_word(when_busy, WHEN_BUSY)) or WHEN_BUSY[0],
                help=read_filled(fields.get("help")) or "",
                locked=is_set(fields.get("locked")),
                then=tuple(text for _, text in one_or_more(fields.get("then"), _THEN)),
            ),
        )

    def _key(self, cursor: Cursor | None) -> str:
        """The key in its normal form; empty if there is none or it is wrong."""
        if cursor is None:
            return ""
        try:
            return normal_key(self._written(cursor), self._layout)
        except KeyNameError as error:
            cursor.error(str(error))
            return ""

    def _written(self, cursor: Cursor) -> str | Sequence[str]:
        if isinstance(cursor.node, ListNode):
            parts = [read_text(entry, "a key") for entry in cursor.items()]
            return [part for part in parts if part is not None]
        if isinstance(cursor.node, ScalarNode) and not cursor.node.is_empty:
            return cursor.node.text
        raise KeyNameError(
            "a key is missing here; characters such as # - ! & * need quotes"
            if isinstance(cursor.node, ScalarNode)
            else "expected a key such as a, F1 or ctrl+a, not a mapping"
        )

    def _steps(
        self, cursor: Cursor, fields: dict[str, Cursor], table: dict[str, Cursor]
    ) -> list[Step]:
        on, steps = fields.get("on"), fields.get("steps")
        if steps is None:
            together = self._reader.together(cursor, table, on)
            return [together] if together is not None else []
        for entry in table.values():
            entry.error("cannot be next to steps; put it into one of the steps")
        entries = steps.list("a list of steps, such as [{say: Hello}, {wait: 0.5}]")
        if entries is not None and not entries:
            steps.error("a step is missing here")
        return [
            step for entry in entries or () if (step := self._reader.step(entry, on)) is not None
        ]


def panel_titles(cursor: Cursor | None) -> list[str]:
    """The titles of all panels, read ahead for the verbs that name one."""
    found = []
    for panel in cursor.items() if cursor is not None else ():
        title = dict(panel.entries()).get("title")
        if title is not None and isinstance(title.node, ScalarNode):
            found.append(title.node.text)
    return found
