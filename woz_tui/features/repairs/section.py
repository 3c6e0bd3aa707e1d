"""Moves that save a dialogue: the section `repairs`, and what every file has without it.

A file without the section gets those that bring no sentence of their own into a study: the last
sentence again, and the interruption.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from woz_tui.config.annotated_decoder import Invalid, read_value
from woz_tui.config.condition_texts import says_by_condition
from woz_tui.config.experiment import Action, Step
from woz_tui.config.feature_section import FeatureSection, FileContents
from woz_tui.config.file_position import FilePosition
from woz_tui.config.languages import Language
from woz_tui.config.reload_changes import changed_entries, essences
from woz_tui.config.session_verbs import WAIT
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.config.yaml_nodes import MappingNode, ScalarNode
from woz_tui.drivers.fields import Doc, OneOf, ReadApart
from woz_tui.protocol.sentence import Sentence

#: The panel of these actions in the log.
PANEL = "Repairs"
SAY = "say"
REPEAT, REWORD, INTERRUPT = "repair repeat", "repair reword", "repair interrupt"
#: What stands on the screen.
LABELS: Mapping[str, Sentence] = {
    REPEAT: Sentence("repairs.repeat", "repeat"),
    REWORD: Sentence("repairs.reword", "reword"),
    "repair filler": Sentence("repairs.filler", "filler"),
    "repair yes": Sentence("repairs.says_yes", "yes"),
    "repair no": Sentence("repairs.says_no", "no"),
    "repair dont_know": Sentence("repairs.dont_know", "don't know"),
    "repair please_repeat": Sentence("repairs.please_repeat", "again?"),
    INTERRUPT: Sentence("repairs.interrupt", "interrupt"),
}
#: Repairs that have a sentence.
SPOKEN = ("filler", "yes", "no", "dont_know", "please_repeat")
FIELDS = ("language", "on", "without", *SPOKEN)


@dataclass(frozen=True, kw_only=True)
class RepairKeys:
    """The key `repairs`."""

    repairs: Annotated[
        Any,
        ReadApart("repairs"),
        Doc("moves that save a dialogue; without this section: repeat and interrupt"),
    ] = None


class RepairSection(FeatureSection[tuple[Action, ...]]):
    """Repairs; those without steps depend on what was said."""

    def read(
        self, table: Mapping[str, Cursor], file: Any, contents: FileContents
    ) -> tuple[Action, ...]:
        """All repairs of the file; none where nobody can speak."""
        cursor, variables = table.get("repairs"), contents.variables
        others = [action for panel in contents.panels for action in panel.actions]
        variants = any(len(texts) > 1 for action in others for texts in _wordings(action))
        differing = any(says_by_condition(action, variables) for action in others)
        if all(verb.name != SAY for verb in contents.verbs):
            if cursor is not None and contents.complete:
                cursor.error(
                    Sentence(
                        "repairs.cannot_say", "no driver of this robot offers {verb!r}", verb=SAY
                    )
                )
            return ()
        spoken = list(_spoken(cursor, contents)) if cursor is not None else []
        same = [
            action.name.removeprefix("repair ")
            for action in spoken
            if any(call.verb == SAY for call in action.calls)
            and not says_by_condition(action, variables)
        ]
        if differing and same and cursor is not None:
            cursor.warning(
                Sentence(
                    "repairs.same_everywhere",
                    "{names}: the same in every condition, while other sentences of this"
                    " file differ; write {{yes: {{CONDITION: ...}}}}",
                    names=", ".join(same),
                )
            )
        found = [_action(REPEAT, contents.place)]
        if variants and cursor is not None:
            found.append(_action(REWORD, contents.place))
        return (*found, *spoken, _action(INTERRUPT, contents.place))

    def actions(self, section: tuple[Action, ...]) -> tuple[Action, ...]:
        return section

    def changes(self, old: tuple[Action, ...], new: tuple[Action, ...]) -> Iterable[str]:
        before, after = ({each.label: essences(each) for each in some} for some in (old, new))
        return changed_entries(Sentence("reload.a_repair", "repair"), before, after)

    def schemas(self) -> Mapping[str, Any]:
        english = Language(None, Path(), []).sentences("repairs", SPOKEN)
        text = {"type": ["string", "number", "boolean"]}
        of_file = "of the sentences that are not given here; the file's"
        properties = {
            "language": {**text, "description": of_file},
            "on": {**text, "description": "who speaks, where several drivers can"},
            "without": {
                "type": "array",
                "items": {"enum": [*SPOKEN]},
                "description": "those that are left out",
            },
            **{
                name: {
                    "type": ["string", "object"],
                    "description": f"in English: {english[name]}",
                }
                for name in SPOKEN
            },
        }
        return {
            "repairs": {"type": "object", "properties": properties, "additionalProperties": False}
        }


def _spoken(cursor: Cursor, contents: FileContents) -> Iterator[Action]:
    table = (
        cursor.fields(
            FIELDS,
            Sentence("repairs.repairs_have", "repairs have"),
            Sentence("repairs.settings", "a mapping, such as {{language: en}}"),
        )
        or {}
    )
    language = table.get("language")
    chosen = contents.language if language is None else contents.language.other(language)
    lines = chosen.sentences("repairs", SPOKEN)
    without = table.get("without")
    left_out = read_value(without, tuple[str, ...], (OneOf(SPOKEN),)) if without else ()
    for name in SPOKEN:
        if not isinstance(left_out, Invalid) and name in left_out:
            continue
        given = table.get(name)
        at = given or cursor.at(
            name, ScalarNode(cursor.place, lines[name], plain=False), cursor.place
        )
        step = _step(at, table.get("on"), contents)
        if step is not None:
            yield _action(f"repair {name}", at.place, step)


def _step(cursor: Cursor, on: Cursor | None, contents: FileContents) -> Step | None:
    """A sentence, with its wordings if it has several, or verbs that begin together."""
    verbs = {WAIT.name, *(verb.name for verb in contents.verbs)}
    if isinstance(cursor.node, MappingNode) and any(name in verbs for name in cursor.node.entries):
        table = dict(cursor.entries())
    else:
        table = {SAY: cursor}
    return contents.step(cursor, table, on)


def _wordings(action: Action) -> Iterable[tuple[str, ...]]:
    """What may be said in each condition."""
    for call in action.calls:
        for choice in call.choices.values() if call.verb == SAY else ():
            yield from choice.texts.values()


def _action(name: str, place: FilePosition, *steps: Step) -> Action:
    return Action(name, LABELS[name], "", PANEL, steps, place)


REPAIRS = RepairSection(RepairKeys, ())
