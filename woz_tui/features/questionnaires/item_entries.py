"""Items of questionnaires as files give them: kinds, scales, conditions, languages."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

from woz_tui.config.annotated_decoder import read_partly
from woz_tui.config.problems import quoted
from woz_tui.config.yaml_cursor import Cursor, check_different, missing, read_filled, read_text
from woz_tui.config.yaml_nodes import MappingNode, ScalarNode
from woz_tui.drivers.fields import Doc, Entry, NotBlank, OneOf, OneOrMore, Range, ReadApart
from woz_tui.features.questionnaires.items import NUMBERS
from woz_tui.protocol.sentence import Sentence
from woz_tui.protocol.welcome import ItemCondition, ItemLabel, QuestionnaireItem

#: What names in logs and tables look like.
NAME_PATTERN = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,39}")
#: Points of the widest scale: a percentage has 101.
MOST_POINTS = 1001
#: Choices of an item at most: each has a key.
MOST_CHOICES = 30
#: A text, or one for each language by its code.
Text = str | dict[str, str]
_Words = Annotated[Text, NotBlank()]
REQUIRED = ("required", "soft", "optional")
_LANGUAGE = re.compile(r"[a-z]{2,3}(-[A-Za-z0-9]{1,8})*")


@dataclass(frozen=True, slots=True)
class StoredEntry(Entry):
    """How the points of a scale are stored."""

    what = Sentence("questionnaires.stored_scale", "how a scale is stored")
    example = "{low: -3}"
    low: Annotated[
        int, Range(-1000, 1000), Doc("the number that is stored for the lowest point")
    ] = 1


@dataclass(frozen=True, slots=True)
class ScaleEntry(Entry):
    """A scale as a file gives it; what it leaves out is as in the questionnaire's scale."""

    what = Sentence("questionnaires.a_scale", "a scale")
    example = "{low: 1, high: 7}"
    low: Annotated[int | None, Range(-1000, 1000), Doc("the lowest number")] = None
    high: Annotated[int | None, Range(-1000, 1000), Doc("the highest number")] = None
    ends: Annotated[
        tuple[Text, Text] | None, Doc("labels of the lowest and the highest number")
    ] = None
    points: Annotated[
        tuple[Text, ...] | None, Doc("instead: a label for each point; stored from 1 on")
    ] = None
    labels: Annotated[dict[str, Text] | None, Doc("labels of some points, by their numbers")] = None
    show: Annotated[
        str | None, OneOf(("numbers", "none")), Doc("whether the numbers of the points are shown")
    ] = None
    stored: Annotated[StoredEntry | None, Doc("other numbers for the log than those shown")] = None


@dataclass(frozen=True, slots=True)
class SliderEntry(Entry):
    """A line from end to end, without a mark until one is set."""

    what = Sentence("questionnaires.a_slider", "a slider")
    example = "{low: 0, high: 100, step: 5}"
    low: Annotated[int, Range(-1000, 1000), Doc("the lowest number")] = 0
    high: Annotated[int, Range(-1000, 1000), Doc("the highest number")] = 100
    step: Annotated[int, Range(1, 1000), Doc("from one mark to the next")] = 1
    ends: Annotated[tuple[Text, Text] | None, Doc("what both ends are called")] = None


@dataclass(frozen=True, slots=True)
class NumberEntry(Entry):
    """A whole number that is typed."""

    what = Sentence("check.a_number", "a number")
    example = "{low: 18, high: 99, unit: years}"
    low: Annotated[int, Range(-1_000_000, 1_000_000), Doc("the lowest one")] = 0
    high: Annotated[int, Range(-1_000_000, 1_000_000), Doc("the highest one")] = 1_000_000
    unit: Annotated[_Words, Doc("of what")] = ""


@dataclass(frozen=True, slots=True)
class ConditionEntry(Entry):
    """An answer of before on which it depends whether an item is asked."""

    what = Sentence("questionnaires.a_condition", "a condition on an earlier answer")
    example = "{item: NAME, is: [3, 4]}"
    item: Annotated[str, NotBlank(), Doc("name of an earlier item")]
    is_: Annotated[
        tuple[str, ...],
        OneOrMore(Sentence("questionnaires.number_or_choice", "a number or a choice")),
        Doc("one of these"),
    ] = ()
    at_least: Annotated[float | None, Doc("this number or a higher one")] = None
    at_most: Annotated[float | None, Doc("this number or a lower one")] = None


NameOfEntry = Annotated[
    str, ReadApart("name"), Doc("name in logs and tables (default: made from the words)")
]
ScaleOfEntry = Annotated[
    ScaleEntry | None, Doc("whole numbers from low to high, with labels for both ends")
]
RequiredOfEntry = Annotated[
    str | None,
    OneOf(REQUIRED),
    Doc("whether there must be an answer; `soft` asks once more, then lets it go"),
]


@dataclass(frozen=True, slots=True)
class ItemEntry(Entry):
    """An item of a questionnaire as a file gives it."""

    what = Sentence("questionnaires.an_item", "an item")
    example = "a question, or {name: ..., question: ...}"
    question: Annotated[_Words, Doc("as the participant reads it")] = ""
    name: NameOfEntry = ""
    stem: Annotated[
        _Words, Doc("how it begins, of whatever kind it is, instead of the questionnaire's stem")
    ] = ""
    scale: ScaleOfEntry = None
    between: Annotated[
        tuple[Text, Text] | None, Doc("two opposites, which are the ends of the scale")
    ] = None
    slider: Annotated[SliderEntry | None, Doc("a line from end to end")] = None
    choices: Annotated[
        Any, ReadApart(tuple[Text, ...] | dict[str, Text]), Doc("one of these, or by their codes")
    ] = ()
    several: Annotated[bool, Doc("several choices at once")] = False
    other: Annotated[bool | Text, Doc("one more choice, with a text: true, or its words")] = False
    number: Annotated[NumberEntry | None, Doc("a whole number")] = None
    month: Annotated[bool, Doc("a year and a month, such as 2026-11")] = False
    text: Annotated[bool, Doc("a free text instead of a scale")] = False
    lines: Annotated[int | None, Range(1, 20), Doc("lines of the field for a text")] = None
    page: Annotated[_Words, Doc("an instruction on a page of its own, without an answer")] = ""
    private: Annotated[bool, Doc("the answer is in no export unless you ask for it")] = False
    optional: Annotated[bool, Doc("can be skipped")] = False
    required: RequiredOfEntry = None
    reverse: Annotated[bool, Doc("scores count it from the other end")] = False
    flip: Annotated[
        str, OneOf(("given", "shuffled")), Doc("whether chance decides which end is on the left")
    ] = "given"
    group: Annotated[str, NotBlank(), Doc("items of one group stay together when shuffled")] = ""
    does_not_apply: Annotated[_Words, Doc("a way to say that it does not fit, in these words")] = ""
    prefer_not: Annotated[_Words, Doc("a way to say nothing, in these words")] = ""
    if_: Annotated[ConditionEntry | None, Doc("asked only after such an answer")] = None


@dataclass(frozen=True, slots=True)
class Scale:
    """A scale that is complete. `low`, `high` and labels are what is shown; `shift` is what that
    has more than what is stored.
    """

    low: int = 1
    high: int = 7
    ends: tuple[Text, Text] = ("", "")
    labels: Mapping[int, Text] = field(default_factory=dict)
    numbers: bool = True
    shift: int = 0


@dataclass(frozen=True, slots=True)
class ItemDefaults:
    """What a questionnaire says of all of its items."""

    scale: Scale = Scale()
    stem: Text = ""
    required: str = "required"
    shuffled: bool = False


@dataclass(frozen=True, slots=True)
class ReadItem:
    """An item that was read, in all its languages."""

    cursor: Cursor
    entry: ItemEntry
    name: str
    kind: str
    scale: Scale
    choices: Mapping[int, Text]
    defaults: ItemDefaults
    only_if: ItemCondition | None = None

    def within(self, language: str, code: str) -> QuestionnaireItem:
        """It in one language; `code` is that of the experiment."""

        def told(text: Text) -> str:
            return in_words(text, language, code)

        entry, scale, shift = self.entry, self.scale, self.scale.shift
        required = entry.required or ("optional" if entry.optional else self.defaults.required)
        other = (max(self.choices, default=0) + 1) if entry.other else None
        choices = [ItemLabel(value, told(text)) for value, text in self.choices.items()]
        if other is not None:
            word = entry.other if isinstance(entry.other, str | dict) else _OTHER
            choices.append(ItemLabel(other, told(word)))
        page = self.kind == "page"
        return QuestionnaireItem(
            name=self.name,
            question=told(entry.page or entry.question),
            low=scale.low - shift,
            high=scale.high - shift,
            ends=(told(scale.ends[0]), told(scale.ends[1])),
            text=self.kind == "text",
            optional=required == "optional" and not page,
            kind="scale" if self.kind == "text" else self.kind,
            stem=told(entry.stem or (self.defaults.stem if self.kind == "scale" else "")),
            labels=tuple(
                ItemLabel(value - shift, told(text)) for value, text in scale.labels.items()
            ),
            choices=tuple(choices),
            other=other,
            numbers=scale.numbers,
            shift=shift,
            step=entry.slider.step if entry.slider is not None else 1,
            unit=told(entry.number.unit) if entry.number is not None else "",
            lines=entry.lines or 0,
            private=entry.private,
            soft=required == "soft" and not page,
            reverse=entry.reverse,
            flip=entry.flip == "shuffled",
            group=entry.group,
            does_not_apply=told(entry.does_not_apply),
            prefer_not=told(entry.prefer_not),
            only_if=self.only_if,
        )


#: What one more choice is called where a file says only that there is one.
_OTHER: Text = {"en": "other", "de": "anderes", "fr": "autre", "es": "otro", "nl": "anders"} | {
    **{"it": "altro", "sv": "annat", "ja": "その他"}
}


# -- languages -------------------------------------------------------------------------------------


def in_words(text: Text, language: str, code: str) -> str:
    """A text in a language; where it is not in it, in that of the experiment."""
    if isinstance(text, str):
        return text
    return text.get(language) or text.get(code) or next(iter(text.values()), "")


#: Where texts stand that can be in several languages, below a questionnaire and below an item; a
#: star: each entry.
QUESTIONNAIRE_TEXTS = (
    *("title", "introduction", "stem", "scale.ends.*", "scale.points.*", "scale.labels.*"),
)
_ITEM_TEXTS = (
    *(
        "question",
        "stem",
        "page",
        "other",
        "does_not_apply",
        "prefer_not",
        "between.*",
        "choices.*",
    ),
    *("scale.ends.*", "scale.points.*", "scale.labels.*", "slider.ends.*", "number.unit"),
)


def languages_of(cursor: Cursor, items: Iterable[Cursor], code: str) -> list[str]:
    """The languages in which the texts of a questionnaire are, each text in all of them: that of
    the experiment first. Those that are missing are reported.
    """
    places = [one for path in QUESTIONNAIRE_TEXTS for one in _below(cursor, path.split("."))]
    places += [
        one for item in items for path in _ITEM_TEXTS for one in _below(item, path.split("."))
    ]
    found: dict[str, None] = {code: None}
    several = [one for one in places if isinstance(one.node, MappingNode)]
    for place in several:
        for language, entry in place.entries():
            if not _LANGUAGE.fullmatch(language):
                entry.error(
                    Sentence("questionnaires.language_expected", "expected a language, such as de")
                )
            else:
                found[language] = None
    for place in several:
        lacking = [each for each in found if each not in dict(place.entries())]
        if lacking:
            place.error(
                Sentence(
                    "questionnaires.missing_in_languages",
                    "is missing in {names}; each text is in all languages of its"
                    " questionnaire, that of the experiment included",
                    names=", ".join(lacking),
                )
            )
    return [*found]


def _below(cursor: Cursor, path: Sequence[str]) -> Iterator[Cursor]:
    if not path:
        yield cursor
        return
    inner = [*cursor.entries(), *((str(n), one) for n, one in enumerate(cursor.items()))]
    for name, one in inner:
        if path[0] in ("*", name):
            yield from _below(one, path[1:])


# -- names -----------------------------------------------------------------------------------------


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


def read_name(entry: Cursor, made_of: str, sentence: str) -> str:
    """The name that is given, or else one made of the sentence; empty if it is wrong."""
    cursor = dict(entry.entries()).get("name")
    near = name_from_text(sentence)
    if cursor is None:
        if sentence and not near:
            missing(
                {},
                "name",
                entry,
                Sentence("questionnaires.no_name_of_title", "no name can be made from the title")
                if made_of == "title"
                else Sentence(
                    "questionnaires.no_name_of_question", "no name can be made from the question"
                ),
            )
        return near
    text = read_text(cursor, Sentence("check.a_name", "a name"))
    if text is None or NAME_PATTERN.fullmatch(text):
        return text or ""
    near = name_from_text(text)
    hint = Sentence("questionnaires.such_as", ", such as {name!r}", name=near) if near else ""
    cursor.error(
        Sentence(
            "questionnaires.name_rule",
            "a name in logs and tables begins with a letter (a to z), and goes"
            " on with letters, digits, - and _; 40 characters at most{near}",
            near=hint,
        )
    )
    return ""


# -- items -----------------------------------------------------------------------------------------


def read_items(cursor: Cursor | None, defaults: ItemDefaults, code: str) -> list[ReadItem]:
    """All items of a questionnaire; what is wrong with them has been reported."""
    entries = (
        cursor.list(Sentence("questionnaires.item_list", "a list of items"))
        if cursor is not None
        else None
    )
    if cursor is not None and entries == []:
        cursor.error(Sentence("questionnaires.item_missing", "an item is missing here"))
    found: list[ReadItem] = []
    for number, entry in enumerate(entries or (), start=1):
        read = _item(entry, defaults, code, number)
        found.append(_with_condition(read, found, code))
    check_different(
        [(read.cursor, read.name) for read in found],
        Sentence("questionnaires.an_item", "an item"),
        ("name", "question"),
    )
    return found


def _item(cursor: Cursor, defaults: ItemDefaults, code: str, number: int) -> ReadItem:
    if isinstance(cursor.node, ScalarNode):
        question = read_filled(cursor) or ""
        name = name_from_text(question)
        if question and not name:
            cursor.error(
                Sentence(
                    "questionnaires.no_name_of_this",
                    "no name can be made from this; write {{name: ..., question: ...}}",
                )
            )
        entry = ItemEntry(question)
        return ReadItem(cursor, entry, name, "scale", defaults.scale, {}, defaults)
    found = read_partly(cursor, ItemEntry)
    if found is None:
        return ReadItem(cursor, ItemEntry(), "", "scale", defaults.scale, {}, defaults)
    entry, table = found, dict(cursor.entries())
    kind = _kind(table, entry)
    if kind != "page" and not entry.question and not entry.between and "question" not in table:
        missing(
            {},
            "question",
            cursor,
            Sentence("questionnaires.as_read", "as the participant reads it"),
        )
    told = " ".join(in_words(each, code, code) for each in entry.between or (entry.question,))
    name = read_name(cursor, "question", told if kind != "page" else f"page {number}")
    _check_fitting(table, entry, kind)
    scale = _points(table, entry, kind, defaults.scale)
    return ReadItem(cursor, entry, name, kind, scale, _choices(table.get("choices")), defaults)


#: The kind of an item, by the key that makes it one, and what messages call it.
_KINDS = {
    "text": Sentence("questionnaires.a_free_text", "a free text"),
    "slider": Sentence("questionnaires.a_slider", "a slider"),
    "choices": Sentence("questionnaires.a_choice", "a choice"),
    "number": Sentence("check.a_number", "a number"),
    "month": Sentence("questionnaires.a_month", "a month"),
    "page": Sentence("questionnaires.an_instruction", "an instruction"),
}
#: Keys of which an item has some meaning only in these kinds.
_ONLY_IN: Mapping[str, Collection[str]] = {
    "scale": ("scale",),
    "between": ("scale", "slider"),
    "several": ("choice", "choices"),
    "other": ("choice", "choices"),
    "lines": ("text",),
    "reverse": ("scale", "slider"),
    "flip": ("scale", "slider"),
}
#: Keys of questions, which an instruction has not.
_OF_QUESTIONS = (
    "question",
    "stem",
    "optional",
    "required",
    "private",
    "does_not_apply",
    "prefer_not",
)


def _kind(table: Mapping[str, Cursor], entry: ItemEntry) -> str:
    absent = {"text": not entry.text, "month": not entry.month}
    given = [key for key in _KINDS if key in table and not absent.get(key)]
    for other in given[1:]:
        table[other].error(
            Sentence(
                "questionnaires.two_kinds",
                "an item that is {kind} cannot be {other}, too",
                kind=_KINDS[given[0]],
                other=_KINDS[other],
            )
        )
    kind = given[0] if given else "scale"
    return ("choices" if entry.several else "choice") if kind == "choices" else kind


def _check_fitting(table: Mapping[str, Cursor], entry: ItemEntry, kind: str) -> None:
    called = _KINDS.get(
        "choices" if kind == "choice" else kind, Sentence("questionnaires.a_scale", "a scale")
    )
    unset = {"several": not entry.several, "other": not entry.other, "reverse": not entry.reverse}
    for key, kinds in _ONLY_IN.items():
        if key in table and kind not in kinds and not unset.get(key):
            table[key].error(
                Sentence(
                    "questionnaires.kind_lacks",
                    "{called} has no {key}",
                    called=called,
                    key=quoted(key),
                )
            )
    for key in _OF_QUESTIONS if kind == "page" else ():
        if key in table:
            table[key].error(
                Sentence(
                    "questionnaires.kind_lacks",
                    "{called} has no {key}",
                    called=called,
                    key=quoted(key),
                )
            )
    if entry.optional and entry.required in ("required", "soft"):
        table["required"].error(
            Sentence(
                "questionnaires.optional_already", "is optional already; leave out one of both"
            )
        )


def _points(table: Mapping[str, Cursor], entry: ItemEntry, kind: str, outer: Scale) -> Scale:
    """The scale of an item, or the numbers between which its answer is."""
    if kind == "slider" and entry.slider is not None:
        slider, cursor = entry.slider, table["slider"]
        if not _goes_up(cursor, slider.low, slider.high, MOST_POINTS):
            return outer
        if (slider.high - slider.low) % slider.step:
            dict(cursor.entries()).get("step", cursor).error(
                Sentence(
                    "questionnaires.no_steps",
                    "from {low} to {high} there are no steps of {step}",
                    low=slider.low,
                    high=slider.high,
                    step=slider.step,
                )
            )
        return Scale(slider.low, slider.high, slider.ends or entry.between or ("", ""))
    if kind == "number" and entry.number is not None:
        _goes_up(table["number"], entry.number.low, entry.number.high)
        return Scale(entry.number.low, entry.number.high)
    scale = outer
    if kind == "scale":
        scale = read_scale(table.get("scale"), entry.scale, outer)
        if entry.between is not None:
            scale = replace(scale, ends=entry.between)
    elif kind == "text":
        scale = Scale(outer.low, outer.high, outer.ends)
    else:
        scale = Scale()
    return scale


def _choices(cursor: Cursor | None) -> dict[int, Text]:
    """Choices by their codes."""
    if cursor is None:
        return {}
    coded = isinstance(cursor.node, MappingNode)
    entries = (
        [*cursor.entries()]
        if coded
        else cursor.list(Sentence("questionnaires.choices", "a list of choices"))
    )
    found: dict[int, Text] = {}
    for number, one in enumerate(entries or (), start=1):
        name, entry = one if isinstance(one, tuple) else (str(number), one)
        if not re.fullmatch(r"-?\d{1,4}", name):
            entry.error(
                Sentence(
                    "questionnaires.choice_code",
                    "the code of a choice is a whole number; write a list to have them from 1",
                )
            )
            continue
        text = _words(entry)
        if text is not None and text in found.values():
            entry.error(Sentence("questionnaires.appears_twice", "appears twice"))
        elif text is not None:
            found[int(name)] = text
    if entries is not None and not 2 <= len(entries) <= MOST_CHOICES:
        cursor.error(
            Sentence(
                "questionnaires.choices_possible",
                "2 to {most} choices are possible, not {number}",
                most=MOST_CHOICES,
                number=len(entries),
            )
        )
    return found


def _words(cursor: Cursor) -> Text | None:
    """A text, or one for each language."""
    if not isinstance(cursor.node, MappingNode):
        return read_filled(cursor) or None
    texts = {name: read_filled(entry) for name, entry in cursor.entries()}
    return {name: text for name, text in texts.items() if text}


# -- scales ----------------------------------------------------------------------------------------


def read_scale(cursor: Cursor | None, own: ScaleEntry | None, outer: Scale) -> Scale:
    """A scale; what it does not say is as in the `outer` one."""
    if cursor is None or own is None:
        return outer
    table = dict(cursor.entries())
    numbers = outer.numbers if own.show is None else own.show == "numbers"
    if own.points is not None:
        for key in ("low", "high", "ends", "labels"):
            if key in table:
                table[key].error(
                    Sentence(
                        "questionnaires.points_have_labels",
                        "points have their labels, and numbers from 1 on; leave this out",
                    )
                )
        if len(own.points) < 2:
            table["points"].error(
                Sentence("questionnaires.two_points", "a scale needs at least two points")
            )
            return outer
        labels = dict(enumerate(own.points, start=1))
        ends = (own.points[0], own.points[-1])
        return _stored(Scale(1, len(labels), ends, labels, numbers), own)
    low = outer.low if own.low is None else own.low
    high = outer.high if own.high is None else own.high
    if not _goes_up(cursor, low, high, MOST_POINTS):
        return outer
    same = (low, high) == (outer.low, outer.high)
    labels = dict(outer.labels) if same and own.ends is None else {}
    labels = _labels(table.get("labels"), own, low, high) or labels
    ends = own.ends or outer.ends
    if own.ends is None and labels:
        ends = (labels.get(low, ends[0]), labels.get(high, ends[1]))
    shift = outer.shift if own.low is None else 0
    return _stored(Scale(low, high, ends, labels, numbers, shift), own)


def _stored(scale: Scale, own: ScaleEntry) -> Scale:
    return scale if own.stored is None else replace(scale, shift=scale.low - own.stored.low)


def _labels(cursor: Cursor | None, own: ScaleEntry, low: int, high: int) -> dict[int, Text]:
    known = {str(value): value for value in range(low, high + 1)}
    for name, entry in cursor.entries() if cursor is not None else ():
        if name not in known:
            entry.error(
                Sentence(
                    "questionnaires.no_point",
                    "is no point of this scale, which goes from {low} to {high}",
                    low=low,
                    high=high,
                )
            )
    texts = own.labels or {}
    return {value: texts[name] for name, value in known.items() if name in texts}


def _goes_up(cursor: Cursor, low: int, high: int, most: int | None = None) -> bool:
    table = dict(cursor.entries())
    last = table.get("high", table.get("low", cursor))
    if low >= high:
        last.error(
            Sentence(
                "questionnaires.scale_too_short",
                "the scale goes from {low} to {high}; it needs at least two points",
                low=low,
                high=high,
            )
        )
    elif most is not None and high - low >= most:
        last.error(
            Sentence(
                "questionnaires.too_many_points",
                "a scale can have at most {most} points",
                most=most,
            )
        )
    else:
        return True
    return False


# -- conditions ------------------------------------------------------------------------------------


def _with_condition(read: ReadItem, earlier: Sequence[ReadItem], code: str) -> ReadItem:
    """With the earlier answer on which it depends."""
    rule = read.entry.if_
    if rule is None or not rule.item:
        return read
    cursor = dict(read.cursor.entries())["if"]
    table = dict(cursor.entries())
    about = next((one for one in earlier if one.name == rule.item), None)
    if about is None:
        names = [one.name for one in earlier]
        near = (
            cursor.report.hint(
                rule.item,
                names,
                or_list=Sentence("questionnaires.before_it", "before it there are"),
            )
            if names
            else ""
        )
        table["item"].error(
            Sentence(
                "questionnaires.no_item_before",
                "no item before this one is called {item}{near}",
                item=quoted(rule.item),
                near=near,
            )
        )
        return read
    if about.kind not in (*NUMBERS, "choice", "choices"):
        table["item"].error(
            Sentence(
                "questionnaires.no_number_to_go_by",
                "{item} has no number and no choices to go by",
                item=quoted(rule.item),
            )
        )
        return read
    if not rule.is_ and rule.at_least is None and rule.at_most is None:
        cursor.error(
            Sentence(
                "questionnaires.says_nothing",
                "says nothing of the answer; add is: [...], at_least: ... or at_most: ...",
            )
        )
    together = read.entry.group and read.entry.group == about.entry.group
    if read.defaults.shuffled and not together:
        cursor.error(
            Sentence(
                "questionnaires.shuffled",
                "the order is shuffled, so {item} could come later; give both the same group: ...",
                item=quoted(rule.item),
            )
        )
    values = tuple(_value(table["is"], about, word) for word in rule.is_)
    condition = ItemCondition(
        rule.item,
        tuple(value for value in values if value is not None),
        rule.at_least if rule.at_least is None else rule.at_least - about.scale.shift,
        rule.at_most if rule.at_most is None else rule.at_most - about.scale.shift,
    )
    return replace(read, only_if=condition)


def _value(cursor: Cursor, about: ReadItem, word: str) -> int | None:
    """What is stored for an answer that the file names as it is shown, or by a choice's words."""
    if about.kind in NUMBERS:
        low, high, shift = about.scale.low, about.scale.high, about.scale.shift
        if re.fullmatch(r"-?\d{1,7}", word) and low <= int(word) <= high:
            return int(word) - shift
        cursor.error(
            Sentence(
                "questionnaires.no_answer_of_it",
                "{word} is no answer to {name}: {low} to {high}",
                word=quoted(word),
                name=quoted(about.name),
                low=low,
                high=high,
            )
        )
        return None
    codes = {str(code): code for code in about.choices}
    for code, text in about.choices.items():
        for each in [text] if isinstance(text, str) else text.values():
            codes.setdefault(each, code)
    if about.entry.other:
        codes.setdefault("other", max(about.choices, default=0) + 1)
    if word not in codes:
        near = cursor.report.hint(word, [*codes], or_list=Sentence("check.there_are", "there are"))
        cursor.error(
            Sentence(
                "questionnaires.no_choice_of_it",
                "{word} is no choice of {name}{near}",
                word=quoted(word),
                name=quoted(about.name),
                near=near,
            )
        )
    return codes.get(word)
