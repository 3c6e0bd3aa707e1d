"""The sections of an experiment file that are about the study, read into one `Study`.

`design`, `preflight`, `perception`:

design: {order: latin-square, trials: 3, blind: {warm: Lemon, cold: Orange}}
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from woz_tui.config.annotated_decoder import (
    INVALID,
    Invalid,
    read_settings,
    read_value,
)
from woz_tui.config.condition_texts import texts
from woz_tui.config.counterbalancing import letters
from woz_tui.config.problems import quoted
from woz_tui.config.study import (
    Design,
    PerceptionLimits,
    Study,
)
from woz_tui.config.study_words import CUES
from woz_tui.config.yaml_cursor import (
    Cursor,
    read_flag,
    texts_of,
)
from woz_tui.config.yaml_nodes import MappingNode, ScalarNode
from woz_tui.drivers.fields import NotEmpty, OneOrMore

# -- design ----------------------------------------------------------------------------------------


def read_design(cursor: Cursor | None, conditions: Sequence[str]) -> Design | None:
    """The section, or None if there is none or it is wrong, which has been reported then."""
    if cursor is None:
        return None
    if cursor.table("a mapping, such as {order: latin-square, trials: 3}") is None:
        return None
    entries = dict(cursor.entries())
    settings: Any = read_settings(cursor, Design)
    labels = _labels(
        entries.get("blind"), conditions, settings.seed if settings is not INVALID else 0
    )
    if settings is INVALID:
        return None
    design: Design = replace(settings, blind=labels)
    if not design.within and "order" not in entries:
        design = replace(design, order="blocks")
    for name, message in _problems(design, conditions):
        entries.get(name, cursor).error(message)
    return design


def _problems(design: Design, conditions: Sequence[str]) -> Iterator[tuple[str, str]]:
    """What does not go together, each with the setting that is to blame."""
    count = len(conditions)
    if design.order == "latin-square" and not design.within:
        yield (
            "order",
            "with one condition for each participant there is no order; write order: blocks",
        )
    elif count < 2 and (design.order != "fixed" or not design.within):
        instead = f"write order: fixed{'' if design.within else ' without within: false'}"
        yield "order", f"needs at least two conditions, not {count}; list more, or {instead}"
    if design.block is not None and design.order != "blocks":
        yield "block", "only order: blocks has blocks"
    elif design.block is not None and count and design.block % count:
        yield "block", f"must be a multiple of the number of conditions, {count}"


def _labels(cursor: Cursor | None, conditions: Sequence[str], seed: int) -> dict[str, str]:
    """What the wizard is told instead of each condition."""
    if cursor is None:
        return {}
    if isinstance(cursor.node, ScalarNode):
        if cursor.node.text.lower() not in ("true", "yes", "on", "false", "no", "off"):
            cursor.wrong("true, or a label for each condition")
            return {}
        if not read_flag(cursor):
            return {}
        if not conditions:
            cursor.error("hides the conditions, but the file has none; add conditions: [...]")
        return letters(conditions, seed)
    if not isinstance(cursor.node, MappingNode):
        cursor.wrong("true, or a label for each condition")
        return {}
    labels = texts(cursor, conditions)
    first: dict[str, str] = {}
    for condition, entry in cursor.entries():
        label = labels.get(condition)
        if label is None:
            continue
        if not label.strip():
            entry.error("is empty")
        elif label in conditions:
            entry.error(
                f"{quoted(label)} is a condition's name; choose a label that does not reveal it"
            )
        elif label in first:
            entry.error(f"{quoted(label)} is the label of {quoted(first[label])} already")
        first.setdefault(label, condition)
    return labels


@dataclass(frozen=True, slots=True)
class StudyReferences:
    """What the sections refer to. `playable` (verbs and titles of panels): None where the robot
    files are not right.
    """

    conditions: Sequence[str]
    playable: Collection[str] | None


def read_study(file: Study, table: Mapping[str, Cursor], around: StudyReferences) -> Study:
    """All sections that `table`, the file's top level, has; `file`: as they stand there. What is
    wrong has been reported.
    """
    design = read_design(table.get("design"), around.conditions)
    _check_perception(file.perception, table.get("perception"))
    return Study(
        design=design,
        preflight=file.preflight,
        answers=_answering(table.get("answers"), around.playable),
        perception=file.perception,
    )


def _answering(
    cursor: Cursor | None, playable: Collection[str] | None
) -> dict[str, tuple[str, ...]]:
    """What answers which cue; a list alone answers every one."""
    if cursor is None:
        return {}
    expected = "cues with verbs or panels that answer them, such as speech: [say]"
    if not isinstance(cursor.node, MappingNode):
        found = _playable(cursor, playable)
        return dict.fromkeys(CUES, found) if found else {}
    entries = cursor.fields(CUES, "a cue is", expected) or {}
    return {cue: _playable(entry, playable) for cue, entry in entries.items() if cue in CUES}


_PLAYABLE = (
    OneOrMore("a verb or a panel's title"),
    NotEmpty("nothing stands here; leave it out, and speech answers"),
)


def _playable(cursor: Cursor, playable: Collection[str] | None) -> tuple[str, ...]:
    names = read_value(cursor, tuple[str, ...], _PLAYABLE)
    for entry, name in texts_of(cursor):
        if playable is not None and name not in playable:
            near = entry.report.hint(name, playable, or_list="there are")
            entry.error(f"{quoted(name)} is neither a verb nor a panel{near}")
    return () if isinstance(names, Invalid) else tuple(names)


def _check_perception(perception: PerceptionLimits, cursor: Cursor | None) -> None:
    blur = dict(cursor.entries()).get("blur") if cursor is not None else None
    for entry, word in texts_of(blur):
        if word in perception.hide:
            entry.warning("is hidden already and cannot be blurred as well")
