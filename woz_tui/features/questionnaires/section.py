"""The section `questionnaires`: what is asked, and when.

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
import string
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import msgspec

from woz_tui.config.annotated_decoder import read_entries, read_partly
from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import FeatureSection, FileContents
from woz_tui.config.languages import Language
from woz_tui.config.reload_changes import changed_entries
from woz_tui.config.yaml_cursor import Cursor, check_different, missing, read_filled, read_text
from woz_tui.config.yaml_nodes import ScalarNode
from woz_tui.drivers.fields import Doc, Entry, NotBlank, NotEmpty, OneOf, Range, ReadApart
from woz_tui.features.questionnaires.due import WHENS
from woz_tui.protocol.welcome import ENGLISH, Questionnaire, QuestionnaireItem, QuestionnaireWords

#: What names in logs and tables look like.
NAME_PATTERN = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,39}")
#: Points of the widest scale: a percentage has 101.
MOST_POINTS = 1001


@dataclass(frozen=True, slots=True)
class ScaleEntry(Entry):
    """A scale as a file gives it; what it leaves out is as in the questionnaire's scale."""

    what = "a scale"
    example = "{low: 1, high: 7}"
    low: Annotated[int | None, Range(-1000, 1000), Doc("the lowest number")] = None
    high: Annotated[int | None, Range(-1000, 1000), Doc("the highest number")] = None
    ends: Annotated[tuple[str, str] | None, Doc("labels of the lowest and the highest number")] = (
        None
    )


_Name = Annotated[
    str, ReadApart("name"), Doc("name in logs and tables (default: made from the words)")
]
_Scale = Annotated[
    ScaleEntry | None, Doc("whole numbers from low to high, with labels for both ends")
]


@dataclass(frozen=True, slots=True)
class ItemEntry(Entry):
    """An item of a questionnaire as a file gives it."""

    what = "an item"
    example = "a question, or {name: ..., question: ...}"
    question: Annotated[str, NotBlank(), Doc("as the participant reads it")]
    name: _Name = ""
    scale: _Scale = None
    text: Annotated[bool, Doc("a free text instead of a scale")] = False
    optional: Annotated[bool, Doc("can be skipped")] = False


@dataclass(frozen=True, slots=True)
class QuestionnaireEntry(Entry):
    """A questionnaire as a file gives it."""

    what = "a questionnaire"
    example = "{title: ..., items: [...]}"
    either = ("title", "name")
    items: Annotated[
        Any, ReadApart(tuple[ItemEntry | str, ...]), NotEmpty(), Doc("questions, in this order")
    ]
    name: _Name = ""
    title: Annotated[str, NotBlank(), Doc("title")] = ""
    when: Annotated[
        str,
        OneOf(WHENS),
        Doc("at the end, after each trial or condition, or only when the wizard starts it"),
    ] = "end"
    introduction: Annotated[str, NotBlank(), Doc("introduction before the first item")] = ""
    scale: _Scale = None


_DEFAULT_SCALE = ScaleEntry(1, 7, ("", ""))


@dataclass(frozen=True, kw_only=True)
class QuestionnaireKeys:
    """The key `questionnaires`."""

    questionnaires: Annotated[
        tuple[Questionnaire, ...],
        ReadApart(tuple[QuestionnaireEntry, ...]),
        Doc("what the participant is asked"),
    ] = ()


@dataclass(frozen=True, slots=True)
class Asked:
    """What participants are asked, and the words in which the console speaks to them."""

    questionnaires: tuple[Questionnaire, ...] = ()
    words: QuestionnaireWords = ENGLISH


# -- the section -----------------------------------------------------------------------------------

_WHENS = {
    "end": "at the end",
    "trial": "after each trial",
    "condition": "after each condition",
    "hand": "when the wizard starts it",
}


class QuestionnaireSection(FeatureSection[Asked]):
    """What the file asks of participants, and in which words."""

    def read(self, table: Mapping[str, Cursor], file: Any, contents: FileContents) -> Asked:
        cursor = table.get("questionnaires")
        if "design" not in table:
            _without_a_design(cursor)
        return Asked(read_questionnaires(cursor), read_words(contents.language))

    def trained(self, section: Asked) -> Asked:
        """Nobody is there to be asked."""
        return Asked(words=section.words)

    def changes(self, old: Asked, new: Asked) -> Iterable[str]:
        if old.words != new.words:
            yield "words changed"
        before, after = ({one.name: one for one in each.questionnaires} for each in (old, new))
        yield from changed_entries("questionnaire", before, after)

    def study(self, section: Asked) -> Mapping[str, Any]:
        return {"questionnaires": [*section.questionnaires], "words": section.words}

    def schemas(self) -> Mapping[str, Any]:
        return {"name": {"type": "string", "pattern": f"^{NAME_PATTERN.pattern}$"}}

    def summary(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        return ((each.name, _in_words(each)) for each in self.of(experiment).questionnaires)


QUESTIONNAIRES = QuestionnaireSection(QuestionnaireKeys, Asked())


def _in_words(questionnaire: Questionnaire) -> str:
    scales = dict.fromkeys(f"{i.low} to {i.high}" for i in questionnaire.items if not i.text)
    texts = sum(item.text for item in questionnaire.items)
    count = len(questionnaire.items)
    parts = [f"{_WHENS[questionnaire.when]}: {count} item{'' if count == 1 else 's'}"]
    parts += [f"scales {' and '.join(scales)}"] if scales else []
    parts += [f"{texts} in words"] if texts else []
    return ", ".join(parts)


# -- reading ---------------------------------------------------------------------------------------


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


def _without_a_design(cursor: Cursor | None) -> None:
    """Nobody knows when a condition's last trial is over if nobody says how many there are."""
    for entry in cursor.items() if cursor is not None else ():
        when = dict(entry.entries()).get("when")
        if when is not None and getattr(when.node, "text", "") == "condition":
            when.warning(
                "without a design, the last trial of a condition is unknown;"
                " add design: {trials: ...}, or start it by hand: when: hand"
            )


# -- words -----------------------------------------------------------------------------------------


def read_words(language: Language) -> QuestionnaireWords:
    """What participants read of the console, in this language."""
    words: dict[str, str] = {}
    fields = QuestionnaireWords.__struct_fields__
    for section in language.section("questionnaire"):
        table = section.fields(fields, "words are", "words by their names") or {}
        for name in (name for name in table if name in fields):
            text = read_filled(table[name])
            if text is not None and _fits(table[name], text, getattr(ENGLISH, name)):
                words.setdefault(name, text)
    return msgspec.structs.replace(ENGLISH, **words)


def _fits(cursor: Cursor, text: str, english: str) -> bool:
    """Whether all that stands between braces can be filled in."""
    known = {name for _, name, _, _ in string.Formatter().parse(english) if name}
    try:
        wanted = {name for _, name, _, _ in string.Formatter().parse(text) if name is not None}
    except ValueError:
        wanted = {""}
    if wanted <= known:
        return True
    allowed = ", ".join(f"{{{name}}}" for name in sorted(known)) or "nothing"
    cursor.error(f"between braces may stand here: {allowed}")
    return False
