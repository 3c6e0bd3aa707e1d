"""The sections of an experiment file that are about the study, read into one `Study`.

`design`, `questionnaires`, `preflight`, `perception`:

design: {order: latin-square, trials: 3, blind: {warm: Lemon, cold: Orange}}
questionnaires:
  - title: How was the robot?
    when: end                               # end, trial, condition or hand
    scale: {low: 1, high: 7, ends: [not at all, very much]}
    items:
      - {name: pleasant, question: "How pleasant was it?"}
      - The robot understood me             # its name: the-robot-understood-me
      - {question: "Anything else?", text: true, optional: true}
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from woz_tui.config.annotated_decoder import (
    INVALID,
    Invalid,
    read_entries,
    read_partly,
    read_settings,
    read_value,
)
from woz_tui.config.condition_texts import texts
from woz_tui.config.counterbalancing import letters
from woz_tui.config.problems import quoted
from woz_tui.config.study import (
    Design,
    ItemEntry,
    PerceptionLimits,
    QuestionnaireEntry,
    ScaleEntry,
    Study,
)
from woz_tui.config.study_words import CUES
from woz_tui.config.yaml_cursor import (
    Cursor,
    check_different,
    missing,
    read_filled,
    read_flag,
    read_text,
    texts_of,
)
from woz_tui.config.yaml_nodes import MappingNode, ScalarNode
from woz_tui.drivers.fields import NotEmpty, OneOrMore
from woz_tui.protocol.welcome import Questionnaire, QuestionnaireItem

# -- questionnaires --------------------------------------------------------------------------------


#: What names in logs and tables look like.
NAME_PATTERN = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,39}")
#: Points of the widest scale: a percentage has 101.
MOST_POINTS = 1001
_DEFAULT_SCALE = ScaleEntry(1, 7, ("", ""))


def read_questionnaires(cursor: Cursor | None) -> tuple[Questionnaire, ...]:
    """All questionnaires; what is wrong with them has been reported."""
    found = [
        (entry, _questionnaire(entry, read))
        for entry, read in read_entries(cursor, "a list of questionnaires", QuestionnaireEntry)
    ]
    named = [(entry, each.name) for entry, each in found]
    check_different(named, "a questionnaire", ("name", "title"))
    return tuple(each for _, each in found)


def name_from_text(text: str) -> str:
    """A name made of a sentence: `How was it?` becomes `how-was-it`; empty if it has no letters."""
    words = re.findall(r"[a-z0-9]+", text.lower())
    while words and words[0][0].isdigit():
        words.pop(0)
    code = ""
    for word in words:
        if len(code) + len(word) + 1 > 40:
            break
        code = f"{code}-{word}" if code else word
    return code


def _questionnaire(cursor: Cursor, entry: QuestionnaireEntry) -> Questionnaire:
    table = dict(cursor.entries())
    name = _name(cursor, "title", entry.title)
    scale = _scale(table.get("scale"), entry.scale, _DEFAULT_SCALE)
    return Questionnaire(
        name=name,
        title=entry.title or name,
        introduction=entry.introduction,
        when=entry.when,
        items=_items(table.get("items"), scale),
    )


def _items(cursor: Cursor | None, scale: ScaleEntry) -> tuple[QuestionnaireItem, ...]:
    entries = cursor.list("a list of items") if cursor is not None else None
    if cursor is not None and entries == []:
        cursor.error("an item is missing here")
    found = [(entry, _item(entry, scale)) for entry in entries or ()]
    check_different([(entry, item.name) for entry, item in found], "an item", ("name", "question"))
    return tuple(item for _, item in found)


def _item(cursor: Cursor, scale: ScaleEntry) -> QuestionnaireItem:
    if isinstance(cursor.node, ScalarNode):
        entry = ItemEntry(read_filled(cursor) or "")
        name = name_from_text(entry.question)
        if entry.question and not name:
            cursor.error("no name can be made from this; write {name: ..., question: ...}")
    else:
        entry = read_partly(cursor, ItemEntry) or ItemEntry("")
        name = _name(cursor, "question", entry.question)
        own = dict(cursor.entries()).get("scale")
        if entry.text and own is not None:
            own.error("a free text has no scale")
        else:
            scale = _scale(own, entry.scale, scale)
    return QuestionnaireItem(
        name=name,
        question=entry.question,
        low=scale.low or 0,
        high=scale.high or 0,
        ends=scale.ends or ("", ""),
        text=entry.text,
        optional=entry.optional,
    )


def _scale(cursor: Cursor | None, own: ScaleEntry | None, outer: ScaleEntry) -> ScaleEntry:
    """A scale; what it does not say is as in the `outer` one."""
    if cursor is None or own is None or outer.low is None or outer.high is None:
        return outer
    low = outer.low if own.low is None else own.low
    high = outer.high if own.high is None else own.high
    table = dict(cursor.entries())
    last = table.get("high", table.get("low", cursor))
    if low >= high:
        last.error(f"the scale goes from {low} to {high}; it needs at least two points")
    elif high - low >= MOST_POINTS:
        last.error(f"a scale can have at most {MOST_POINTS} points")
    else:
        return ScaleEntry(low, high, own.ends or outer.ends)
    return outer


def _name(entry: Cursor, made_of: str, sentence: str) -> str:
    """The name that is given, or else one made of the sentence; empty if it is wrong."""
    cursor = dict(entry.entries()).get("name")
    near = name_from_text(sentence)
    if cursor is None:
        if sentence and not near:
            missing({}, "name", entry, f"no name can be made from the {made_of}")
        return near
    text = read_text(cursor, "a name")
    if text is None or NAME_PATTERN.fullmatch(text):
        return text or ""
    near = name_from_text(text)
    hint = f", such as {near!r}" if near else ""
    cursor.error(
        "a name in logs and tables begins with a letter (a to z), and goes on with letters, digits,"
        f" - and _; 40 characters at most{hint}"
    )
    return ""


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
    questionnaires = read_questionnaires(table.get("questionnaires"))
    if design is None and "design" not in table:
        _without_a_design(table.get("questionnaires"))
    _check_perception(file.perception, table.get("perception"))
    return Study(
        design=design,
        questionnaires=questionnaires,
        preflight=file.preflight,
        answers=_answering(table.get("answers"), around.playable),
        perception=file.perception,
    )


def _without_a_design(cursor: Cursor | None) -> None:
    """Nobody knows when a condition's last trial is over if nobody says how many there are."""
    for entry in cursor.items() if cursor is not None else ():
        when = dict(entry.entries()).get("when")
        if when is not None and getattr(when.node, "text", "") == "condition":
            when.warning(
                "without a design, the last trial of a condition is unknown;"
                " add design: {trials: ...}, or start it by hand: when: hand"
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
