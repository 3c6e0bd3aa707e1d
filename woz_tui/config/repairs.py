"""Moves that save a dialogue: the section `repairs`, and what every file has without it.

A file without the section gets those that bring no sentence of their own into a study: the last
sentence again, and the interruption.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from woz_tui.config.actions import StepReader
from woz_tui.config.annotated_decoder import Invalid, read_value
from woz_tui.config.condition_texts import Variables, says_by_condition
from woz_tui.config.experiment import Action, Step
from woz_tui.config.file_position import FilePosition
from woz_tui.config.languages import SPOKEN, Language
from woz_tui.config.verb_calls import Vocabulary
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.config.yaml_nodes import MappingNode, ScalarNode
from woz_tui.drivers.fields import OneOf

#: The panel of these actions in the log.
PANEL = "Repairs"
SAY = "say"
REPEAT, REWORD, INTERRUPT = "repair repeat", "repair reword", "repair interrupt"
#: What stands on the screen.
LABELS: Mapping[str, str] = {
    REPEAT: "repeat",
    REWORD: "reword",
    "repair filler": "filler",
    "repair yes": "yes",
    "repair no": "no",
    "repair dont_know": "don't know",
    "repair please_repeat": "again?",
    INTERRUPT: "interrupt",
}
FIELDS = ("language", "on", "without", *SPOKEN)


class RepairReader:
    """Reads the section.

    Args:
        vocabulary: The verbs there are.
        steps: Reads what a repair does.
        language: The experiment's.
    """

    def __init__(self, vocabulary: Vocabulary, steps: StepReader, language: Language) -> None:
        self._vocabulary = vocabulary
        self._steps = steps
        self._language = language

    def read(
        self,
        cursor: Cursor | None,
        place: FilePosition,
        others: Sequence[Action],
        variables: Variables,
    ) -> tuple[Action, ...]:
        """All repairs of the file; none where nobody can speak. `others`: its other actions, and
        `variables`: of its sentences.
        """
        variants = any(len(texts) > 1 for action in others for texts in _wordings(action))
        differing = any(says_by_condition(action, variables) for action in others)
        if not self._vocabulary.offers(SAY):
            if cursor is not None and not self._vocabulary.robots.incomplete:
                cursor.error(f"no driver of this robot offers {SAY!r}")
            return ()
        spoken = list(self._spoken(cursor)) if cursor is not None else []
        same = [
            action.name.removeprefix("repair ")
            for action in spoken
            if any(call.verb == SAY for call in action.calls)
            and not says_by_condition(action, variables)
        ]
        if differing and same and cursor is not None:
            cursor.warning(
                f"{', '.join(same)}: the same in every condition, while other sentences of this"
                " file differ; write {yes: {CONDITION: ...}}"
            )
        found = [_action(REPEAT, place)]
        if variants and cursor is not None:
            found.append(_action(REWORD, place))
        return (*found, *spoken, _action(INTERRUPT, place))

    def _spoken(self, cursor: Cursor) -> Iterator[Action]:
        table = cursor.fields(FIELDS, "repairs have", "a mapping, such as {language: en}") or {}
        language = table.get("language")
        chosen = self._language if language is None else self._language.other(language)
        lines = chosen.repairs()
        without = table.get("without")
        left_out = read_value(without, tuple[str, ...], (OneOf(SPOKEN),)) if without else ()
        for name in SPOKEN:
            if not isinstance(left_out, Invalid) and name in left_out:
                continue
            given = table.get(name)
            at = given or cursor.at(
                name, ScalarNode(cursor.place, lines[name], plain=False), cursor.place
            )
            step = self._step(at, table.get("on"))
            if step is not None:
                yield _action(f"repair {name}", at.place, step)

    def _step(self, cursor: Cursor, on: Cursor | None) -> Step | None:
        """A sentence, with its wordings if it has several, or verbs that begin together."""
        verbs: Collection[str] = self._vocabulary.names
        if isinstance(cursor.node, MappingNode) and any(
            name in verbs for name in cursor.node.entries
        ):
            table = dict(cursor.entries())
        else:
            table = {SAY: cursor}
        return self._steps.together(cursor, table, on)


def _wordings(action: Action) -> Iterable[tuple[str, ...]]:
    """What may be said in each condition."""
    for call in action.calls:
        for choice in call.choices.values() if call.verb == SAY else ():
            yield from choice.texts.values()


def _action(name: str, place: FilePosition, *steps: Step) -> Action:
    return Action(name, LABELS[name], "", PANEL, steps, place)
