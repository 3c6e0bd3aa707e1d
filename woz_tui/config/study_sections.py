"""The sections of an experiment file that are about the study, read into one `Study`.

`design`, `questionnaires`, `preflight`, `shaping`, `perception`, `training`:

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

from woz_tui.config.annotated_decoder import INVALID, read_section, read_settings, read_value
from woz_tui.config.condition_texts import texts
from woz_tui.config.counterbalancing import letters
from woz_tui.config.experiment import Action
from woz_tui.config.problems import quoted
from woz_tui.config.study import (
    CUES,
    TRAINING_CUES,
    Design,
    PerceptionLimits,
    Questionnaire,
    QuestionnaireItem,
    ResponseShaping,
    Study,
    Training,
    TrainingCue,
)
from woz_tui.config.yaml_cursor import (
    Cursor,
    is_set,
    missing,
    one_or_more,
    read_filled,
    read_flag,
    read_text,
    read_texts,
    read_whole,
    read_word,
)
from woz_tui.config.yaml_nodes import ListNode, MappingNode, ScalarNode
from woz_tui.drivers.contract import SPEECH
from woz_tui.drivers.fields import Range, Seconds

# -- questionnaires --------------------------------------------------------------------------------


#: When a questionnaire is due.
WHENS = ("end", "trial", "condition", "hand")
FIELDS = ("name", "title", "when", "introduction", "scale", "items")
ITEM_FIELDS = ("name", "question", "scale", "text", "optional")
SCALE_FIELDS = ("low", "high", "ends")
#: What names in logs and tables look like.
NAME_PATTERN = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,39}")
_POINTS = Range(-1000, 1000)
#: Points of the widest scale: a percentage has 101.
MOST_POINTS = 1001


@dataclass(frozen=True, slots=True)
class _Scale:
    low: int = 1
    high: int = 7
    ends: tuple[str, str] = ("", "")


def read_questionnaires(cursor: Cursor | None) -> tuple[Questionnaire, ...]:
    """All that are right; what is wrong with the others has been reported."""
    entries = cursor.list("a list of questionnaires") if cursor is not None else None
    read = [(entry, _questionnaire(entry)) for entry in entries or ()]
    found = [(entry, each) for entry, each in read if each is not None]
    _different([(entry, each.name) for entry, each in found], "a questionnaire", "title")
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


def _questionnaire(cursor: Cursor) -> Questionnaire | None:
    example = "a questionnaire, such as {title: ..., items: [...]}"
    table = cursor.fields(FIELDS, "a questionnaire has", example)
    if table is None:
        return None
    title = read_filled(table.get("title"))
    name = _name(table.get("name"), title)
    if title is None and not name and not {"title", "name"} & table.keys():
        missing({}, "title", cursor, "title")
    elif not name and "name" not in table:
        missing({}, "name", cursor, "no name can be made from the title")
    when = table.get("when")
    scale = _scale(table.get("scale"), _Scale())
    items_cursor = missing(table, "items", cursor)
    items = _items(items_cursor, scale) if items_cursor is not None else ()
    return Questionnaire(
        name=name,
        title=title or name,
        items=items,
        when=(when and read_word(when, WHENS)) or WHENS[0],
        introduction=read_filled(table.get("introduction")) or "",
    )


def _items(cursor: Cursor, scale: _Scale) -> tuple[QuestionnaireItem, ...]:
    entries = cursor.list("a list of items")
    if entries is not None and not entries:
        cursor.error("an item is missing here")
    found = [(entry, _item(entry, scale)) for entry in entries or ()]
    _different([(entry, item.name) for entry, item in found], "an item", "question")
    return tuple(item for _, item in found)


def _item(cursor: Cursor, scale: _Scale) -> QuestionnaireItem:
    if isinstance(cursor.node, ScalarNode):
        question = read_filled(cursor) or ""
        name = name_from_text(question)
        if question and not name:
            cursor.error("no name can be made from this; write {name: ..., question: ...}")
        return QuestionnaireItem(name, question, scale.low, scale.high, scale.ends)
    example = "a question, or {name: ..., question: ...}"
    table = cursor.fields(ITEM_FIELDS, "an item has", example) or {}
    asked = missing(table, "question", cursor) if table else None
    question = read_filled(asked) or ""
    name = _name(table.get("name"), question)
    if question and not name and "name" not in table:
        missing({}, "name", cursor, "no name can be made from the question")
    text = is_set(table.get("text"))
    own = table.get("scale")
    if text and own is not None:
        own.error("a free text has no scale")
        own = None
    scale = _scale(own, scale)
    return QuestionnaireItem(
        name=name,
        question=question,
        low=scale.low,
        high=scale.high,
        ends=scale.ends,
        text=text,
        optional=is_set(table.get("optional")),
    )


def _scale(cursor: Cursor | None, outer: _Scale) -> _Scale:
    """A scale; what it does not say is as in the `outer` one."""
    example = "a mapping, such as {low: 1, high: 7}"
    table = cursor.fields(SCALE_FIELDS, "a scale has", example) if cursor is not None else None
    if cursor is None or table is None:
        return outer
    given = {name: read_whole(table[name], _POINTS) for name in ("low", "high") if name in table}
    ends = _ends(table.get("ends")) or outer.ends
    low, high = given.get("low", outer.low), given.get("high", outer.high)
    if low is None or high is None:
        return outer
    last = table.get("high", table.get("low", cursor))
    if low >= high:
        last.error(f"the scale goes from {low} to {high}; it needs at least two points")
        return outer
    if high - low >= MOST_POINTS:
        last.error(f"a scale can have at most {MOST_POINTS} points")
        return outer
    return _Scale(low, high, ends)


def _ends(cursor: Cursor | None) -> tuple[str, str] | None:
    entries = cursor.list("labels of both ends: [not at all, very much]") if cursor else None
    if cursor is None or entries is None:
        return None
    names = [read_text(entry) for entry in entries]
    if len(names) != 2:
        cursor.error(f"a scale has two labels, one for each end; this has {len(names)}")
        return None
    return (names[0] or "", names[1] or "")


def _name(cursor: Cursor | None, sentence: str | None) -> str:
    """The name that is given, or else one made of the sentence; empty if it is wrong."""
    if cursor is None:
        return name_from_text(sentence or "")
    text = read_text(cursor, "a name")
    if text is None:
        return ""
    if NAME_PATTERN.fullmatch(text):
        return text
    near = name_from_text(text)
    hint = f", such as {near!r}" if near else ""
    cursor.error(f"a name in logs and tables has letters, digits, - and _, 40 at most{hint}")
    return ""


def _different(named: Sequence[tuple[Cursor, str]], what: str, made_of: str) -> None:
    """Report names that stand twice, where they stand; `made_of`: what unnamed ones come from."""
    first: dict[str, int] = {}
    for entry, name in named:
        if name and name in first:
            table = dict(entry.entries())
            table.get("name", table.get(made_of, entry)).error(
                f"{quoted(name)} is already the name of {what}"
                f" (line {first[name]}); give one of them another name: ..."
            )
        first.setdefault(name, entry.place.line)


# -- design ----------------------------------------------------------------------------------------


BLIND = "blind"


def read_design(cursor: Cursor | None, conditions: Sequence[str]) -> Design | None:
    """The section, or None if there is none or it is wrong, which has been reported then."""
    if cursor is None:
        return None
    if cursor.table("a mapping, such as {order: latin-square, trials: 3}") is None:
        return None
    entries = dict(cursor.entries())
    settings: Any = read_settings(cursor, Design, others=(BLIND,))
    labels = _labels(
        entries.get(BLIND), conditions, settings.seed if settings is not INVALID else 0
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
        listed = "the file lists one" if count else "the file lists none"
        yield "order", f"needs at least two conditions,  {listed}; without them: order: fixed"
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


#: The names of these sections.
SECTIONS = ("design", "questionnaires", "preflight", "shaping", "answers", "perception", "training")
CUE_FIELDS = ("cue", "says", "answers", "window")
#: How long an answer may take at most, in the section and in one cue.
WINDOW = Seconds(0.5, 60)


@dataclass(frozen=True, slots=True)
class StudyReferences:
    """What the sections refer to. `sensors` and `playable` (verbs and titles of panels): None where
    the robot files are not right.
    """

    conditions: Sequence[str]
    actions: Mapping[str, Action]
    sensors: Collection[str] | None
    playable: Collection[str] | None
    engaged: bool


def read_study(table: Mapping[str, Cursor], around: StudyReferences) -> Study:
    """All sections that `table`, the file's top level, has. What is wrong has been reported."""
    design = read_design(table.get("design"), around.conditions)
    questionnaires = read_questionnaires(table.get("questionnaires"))
    if design is None and "design" not in table:
        _without_a_design(table.get("questionnaires"))
    return Study(
        design=design,
        questionnaires=questionnaires,
        preflight=_preflight(table.get("preflight")),
        shaping=_shaping(table.get("shaping"), around),
        answers=_answering(table.get("answers"), around.playable),
        perception=_perception(table.get("perception")),
        training=_training(table.get("training"), around.actions),
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


def _preflight(cursor: Cursor | None) -> tuple[str, ...]:
    found = read_texts(cursor, "a list of sentences", "a sentence", once=True)
    for entry, text in found:
        if not text.strip():
            entry.error("is empty")
    return tuple(text for _, text in found)


def _shaping(cursor: Cursor | None, around: StudyReferences) -> ResponseShaping | None:
    shaping = read_section(cursor, ResponseShaping)
    if cursor is None or shaping is None:
        return None
    entries = dict(cursor.entries())
    cues = entries.get("cues", cursor)
    if not shaping.cues:
        cues.error("the list has no cue; add one, or remove the section")
    if not shaping.floor and not shaping.jitter:
        cursor.warning("delays nothing; add a floor, such as floor: 0.8 s")
    if "engagement" in shaping.cues and not around.engaged:
        cues.warning("the cue engagement never occurs: the file has no section engagement")
    if "speech" in shaping.cues and around.sensors is not None and not _heard(around.sensors):
        cues.warning("the cue speech never occurs: no driver detects the end of speech")
    return shaping


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


def _playable(cursor: Cursor, playable: Collection[str] | None) -> tuple[str, ...]:
    given = [*one_or_more(cursor, "a verb or a panel's title, or a list of them")]
    if not given and isinstance(cursor.node, ListNode):
        cursor.error("nothing stands here; leave it out, and speech answers")
    for entry, name in given:
        if playable is not None and name not in playable:
            near = cursor.report.hint(name, playable, or_list="there are")
            entry.error(f"{quoted(name)} is neither a verb nor a panel{near}")
    return tuple(name for _, name in given)


def _heard(sensors: Collection[str]) -> bool:
    return SPEECH in {name.rpartition(".")[2] for name in sensors}


def _perception(cursor: Cursor | None) -> PerceptionLimits:
    perception = read_section(cursor, PerceptionLimits)
    if cursor is None or perception is None:
        return PerceptionLimits()
    blur = dict(cursor.entries()).get("blur")
    for each, word in zip(blur.items() if blur is not None else (), perception.blur, strict=True):
        if word in perception.hide:
            each.warning("is hidden already and cannot be blurred as well")
    return perception


# -- training -------------------------------------------------------------------------------


def _training(cursor: Cursor | None, actions: Mapping[str, Action]) -> Training:
    if cursor is None:
        return Training()
    settings = read_section(cursor, Training, others=("cues",)) or Training()
    section = dict(cursor.entries()).get("cues")
    entries = section.list("a list of cues") if section is not None else None
    if section is not None and entries == []:
        section.error(
            "the list has no cue; add one, or remove cues: they are then made from the actions"
        )
    cues = tuple(cue for entry in entries or () if (cue := _cue(entry, actions)) is not None)
    return Training(cues, settings.count, settings.window, settings.pause)


def _cue(cursor: Cursor, actions: Mapping[str, Action]) -> TrainingCue | None:
    example = "a cue, such as {cue: question, answers: [...]}"
    table = cursor.fields(CUE_FIELDS, "a cue has", example)
    if table is None:
        return None
    sort_cursor = missing(table, "cue", cursor, "what the visitor does")
    sort = read_word(sort_cursor, TRAINING_CUES) if sort_cursor is not None else None
    answers = missing(table, "answers", cursor, "names of actions")
    window = read_value(table["window"], float, (WINDOW,)) if "window" in table else None
    says = [text for _, text in one_or_more(table.get("says"), "what the visitor says")]
    if sort is None or answers is None:
        return None
    return TrainingCue(
        sort=sort,
        answers=tuple(_answers(answers, actions)),
        says=tuple(says),
        window=None if window is INVALID else window,
    )


def _answers(cursor: Cursor, actions: Mapping[str, Action]) -> Iterator[str]:
    given = [*one_or_more(cursor, "the name of an action, or a list of them")]
    if not given and isinstance(cursor.node, ListNode) and not cursor.node.nodes:
        cursor.error("an action is missing here")
    for entry, name in given:
        action = actions.get(name)
        if action is None:
            near = cursor.report.hint(name, actions, or_list="actions are")
            entry.error(f"there is no action {quoted(name)}{near}")
        elif action.locked:
            entry.warning(f"{quoted(name)} is locked and cannot be an answer")
        yield name
