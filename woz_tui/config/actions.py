"""Panels and actions: what each key does."""

from __future__ import annotations

from dataclasses import dataclass

from woz_tui.config.annotated_decoder import names_of, read_partly
from woz_tui.config.experiment import ARRIVED, Action, Panel, ParallelCalls, Step, Wait
from woz_tui.config.experiment_file import ActionEntry, PanelEntry
from woz_tui.config.keys.chords import KeyNameError, normal_key
from woz_tui.config.session_verbs import WAIT
from woz_tui.config.verb_calls import CallReader, Vocabulary
from woz_tui.config.yaml_cursor import Cursor, read_seconds, read_text, read_word
from woz_tui.config.yaml_nodes import ListNode, ScalarNode
from woz_tui.drivers.fields import Range
from woz_tui.protocol.sentence import Sentence, said_by

#: What an action may say beside verbs and their arguments.
ACTION_FIELDS = names_of(ActionEntry)

#: Seconds. A longer pause inside an action is a slip of the decimal point.
_LONGEST_WAIT = Range(0.0, 3600.0, "s")


@dataclass(frozen=True, slots=True)
class ActionDraft:
    """An action with where the file has it, for checks across the file."""

    cursor: Cursor
    action: Action

    @property
    def entries(self) -> dict[str, Cursor]:
        """What the file says of it, by name."""
        return dict(self.cursor.entries())


class StepReader:
    """Reads what stands in one action: verbs together, or steps one after the other."""

    def __init__(self, vocabulary: Vocabulary) -> None:
        self._calls = CallReader(vocabulary)

    def together(self, cursor: Cursor, table: dict[str, Cursor], on: Cursor | None) -> Step | None:
        """The verbs of an action that has no steps."""
        return self._calls.read(cursor, table, on, ACTION_FIELDS)

    def until_arrived(self, step: Step | None, until: Cursor | None) -> Step | None:
        """`step`; if it says `until`, it ends when its motions have arrived."""
        if until is None or not isinstance(step, ParallelCalls):
            return step
        return self._calls.until_arrived(step, until)

    def step(self, cursor: Cursor, on: Cursor | None = None) -> Step | None:
        """`{say: Hello, eyes: green}` or `{wait: 0.5}`; `on` if the step names nobody itself."""
        table = cursor.table(
            Sentence("check.a_step", "a step, such as {{say: Hello}} or {{wait: 0.5}}")
        )
        if table is None:
            return None
        if set(table) == {WAIT.name}:
            seconds = read_seconds(table[WAIT.name], _LONGEST_WAIT)
            return Wait(seconds or 0.0)
        until = table.pop("until", None)
        step = self._calls.read(cursor, table, table.pop("on", on), ("on", "until", "wait"))
        if until is not None and read_word(until, (ARRIVED,)) is None:
            return step
        return self.until_arrived(step, until)


class PanelReader:
    """Reads `panels`; `drafts` are its actions, even those that have errors inside."""

    def __init__(self, steps: StepReader, layout: str) -> None:
        self._reader = steps
        self._layout = layout
        self.drafts: list[ActionDraft] = []

    def read(self, cursor: Cursor) -> list[Panel]:
        """Every panel that has a title and actions."""
        entries = cursor.list(Sentence("check.panels", "a list of panels"))
        if entries is not None and not entries:
            cursor.error(Sentence("check.panel_missing", "a panel is missing here"))
        return [panel for entry in entries or () if (panel := self._panel(entry)) is not None]

    def _panel(self, cursor: Cursor) -> Panel | None:
        panel = read_partly(cursor, PanelEntry)
        if panel is None:
            return None
        listed = dict(cursor.entries()).get("actions")
        entries = (
            listed.list(Sentence("check.actions", "a list of actions"))
            if listed is not None
            else None
        )
        if listed is not None and entries == []:
            listed.warning(Sentence("check.action_missing", "an action is missing here"))
        read = [self._action(entry, panel.title) for entry in entries or ()]
        drafts = [draft for draft in read if draft is not None]
        self.drafts += drafts
        actions = tuple(draft.action for draft in drafts)
        return Panel(panel.title, actions, cursor.place, panel.locked, panel.covers, panel.for_)

    def _action(self, cursor: Cursor, panel: str) -> ActionDraft | None:
        table = cursor.table(
            Sentence(
                "check.an_action_such_as",
                "an action, such as {example}",
                example=ActionEntry.example,
            )
        )
        entry = read_partly(cursor.only(ACTION_FIELDS), ActionEntry)
        if table is None or entry is None:
            return None
        fields = {name: table.pop(name) for name in ACTION_FIELDS if name in table}
        return ActionDraft(
            cursor,
            Action(
                name=entry.name or entry.label,
                label=entry.label or entry.name,
                key=self._key(fields.get("key")),
                panel=panel,
                steps=tuple(self._steps(cursor, fields, table)),
                place=cursor.place,
                when_busy=entry.when_busy,
                help=entry.help,
                locked=entry.locked,
                then=entry.then,
            ),
        )

    def _key(self, cursor: Cursor | None) -> str:
        """The key in its normal form; empty if there is none or it is wrong."""
        if cursor is None:
            return ""
        written: str | list[str] = ""
        match cursor.node:
            case ListNode():
                parts = [
                    read_text(entry, Sentence("check.a_key", "a key")) for entry in cursor.items()
                ]
                written = [part for part in parts if part is not None]
            case ScalarNode(is_empty=False, text=text):
                written = text
            case ScalarNode():
                cursor.error(
                    Sentence(
                        "check.key_missing_quotes",
                        "a key is missing here; characters such as # - ! & * need quotes",
                    )
                )
                return ""
            case _:
                cursor.error(
                    Sentence(
                        "check.key_not_mapping",
                        "expected a key such as a, F1 or ctrl+a, not a mapping",
                    )
                )
                return ""
        try:
            return normal_key(written, self._layout)
        except KeyNameError as error:
            cursor.error(said_by(error))
            return ""

    def _steps(
        self, cursor: Cursor, fields: dict[str, Cursor], table: dict[str, Cursor]
    ) -> list[Step]:
        on, steps = fields.get("on"), fields.get("steps")
        if steps is None:
            together = self._reader.together(cursor, table, on)
            step = self._reader.until_arrived(together, fields.get("until"))
            return [step] if step is not None else []
        if "until" in fields:
            fields["until"].error(
                Sentence(
                    "check.beside_steps", "cannot be next to steps; put it into one of the steps"
                )
            )
        for entry in table.values():
            entry.error(
                Sentence(
                    "check.beside_steps", "cannot be next to steps; put it into one of the steps"
                )
            )
        entries = steps.list(
            Sentence("check.steps", "a list of steps, such as [{{say: Hello}}, {{wait: 0.5}}]")
        )
        if entries is not None and not entries:
            steps.error(Sentence("check.step_missing", "a step is missing here"))
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
