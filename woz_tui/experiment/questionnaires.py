"""The section `questionnaires`: what the participant is asked.

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
from collections.abc import Sequence
from dataclasses import dataclass

from woz_tui.core.fields import Range
from woz_tui.experiment.nodes import Scalar
from woz_tui.experiment.report import quoted
from woz_tui.experiment.spot import Spot, missing, read_flag, read_text, read_whole, read_word
from woz_tui.experiment.study import Item, Questionnaire

#: When a questionnaire is due.
WHENS = ("end", "trial", "condition", "hand")
FIELDS = ("name", "title", "when", "introduction", "scale", "items")
ITEM_FIELDS = ("name", "question", "scale", "text", "optional")
SCALE_FIELDS = ("low", "high", "ends")
#: What names in logs and tables look like.
CODE = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,39}")
_POINTS = Range(-1000, 1000)
#: Points of the widest scale: a percentage has 101.
MOST_POINTS = 1001


@dataclass(frozen=True, slots=True)
class _Scale:
    low: int = 1
    high: int = 7
    ends: tuple[str, str] = ("", "")


def read_questionnaires(spot: Spot | None) -> tuple[Questionnaire, ...]:
    """All that are right; what is wrong with the others has been reported."""
    entries = spot.list("a list of questionnaires") if spot is not None else None
    read = [(entry, _questionnaire(entry)) for entry in entries or ()]
    found = [(entry, each) for entry, each in read if each is not None]
    _different([(entry, each.name) for entry, each in found], "a questionnaire", "title")
    return tuple(each for _, each in found)


def code_of(text: str) -> str:
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


def _questionnaire(spot: Spot) -> Questionnaire | None:
    table = spot.table("a questionnaire, such as {title: ..., items: [...]}")
    if table is None:
        return None
    for name, entry in table.items():
        if name not in FIELDS:
            entry.unknown(FIELDS, "a questionnaire has")
    title = _text(table.get("title"))
    name = _name(table.get("name"), title)
    if title is None and not name and not {"title", "name"} & table.keys():
        missing({}, "title", spot, "what stands above it")
    elif not name and "name" not in table:
        missing({}, "name", spot, "none can be made from the title")
    when = table.get("when")
    scale = _scale(table.get("scale"), _Scale())
    items_spot = missing(table, "items", spot)
    items = _items(items_spot, scale) if items_spot is not None else ()
    return Questionnaire(
        name=name,
        title=title or name,
        items=items,
        when=(when and read_word(when, WHENS)) or WHENS[0],
        introduction=_text(table.get("introduction")) or "",
    )


def _items(spot: Spot, scale: _Scale) -> tuple[Item, ...]:
    entries = spot.list("a list of items")
    if entries is not None and not entries:
        spot.error("no item stands here")
    found = [(entry, _item(entry, scale)) for entry in entries or ()]
    _different([(entry, item.name) for entry, item in found], "an item", "question")
    return tuple(item for _, item in found)


def _item(spot: Spot, scale: _Scale) -> Item:
    if isinstance(spot.node, Scalar):
        question = _text(spot) or ""
        name = code_of(question)
        if question and not name:
            spot.error("no name can be made of this; write {name: ..., question: ...}")
        return Item(name, question, scale.low, scale.high, scale.ends)
    table = spot.table("a question, or {name: ..., question: ...}") or {}
    for field, entry in table.items():
        if field not in ITEM_FIELDS:
            entry.unknown(ITEM_FIELDS, "an item has")
    asked = missing(table, "question", spot) if table else None
    question = _text(asked) or ""
    name = _name(table.get("name"), question)
    if question and not name and "name" not in table:
        missing({}, "name", spot, "none can be made from the question")
    text = _flag(table.get("text"))
    own = table.get("scale")
    if text and own is not None:
        own.error("a free text has no scale")
        own = None
    scale = _scale(own, scale)
    return Item(
        name=name,
        question=question,
        low=scale.low,
        high=scale.high,
        ends=scale.ends,
        text=text,
        optional=_flag(table.get("optional")),
    )


def _scale(spot: Spot | None, outer: _Scale) -> _Scale:
    """A scale; what it does not say is as in the `outer` one."""
    table = spot.table("a mapping, such as {low: 1, high: 7}") if spot is not None else None
    if spot is None or table is None:
        return outer
    for name, entry in table.items():
        if name not in SCALE_FIELDS:
            entry.unknown(SCALE_FIELDS, "a scale has")
    given = {name: read_whole(table[name], _POINTS) for name in ("low", "high") if name in table}
    ends = _ends(table.get("ends")) or outer.ends
    low, high = given.get("low", outer.low), given.get("high", outer.high)
    if low is None or high is None:
        return outer
    last = table.get("high", table.get("low", spot))
    if low >= high:
        last.error(f"the scale goes from {low} to {high}; it wants two points at least")
        return outer
    if high - low >= MOST_POINTS:
        last.error(f"a scale has {MOST_POINTS} points at most")
        return outer
    return _Scale(low, high, ends)


def _ends(spot: Spot | None) -> tuple[str, str] | None:
    entries = spot.list("what the ends are called: [not at all, very much]") if spot else None
    if spot is None or entries is None:
        return None
    names = [read_text(entry) for entry in entries]
    if len(names) != 2:
        spot.error(f"a scale has two ends, here are {len(names)}")
        return None
    return (names[0] or "", names[1] or "")


def _name(spot: Spot | None, sentence: str | None) -> str:
    """The name that is given, or else one made of the sentence; empty if it is wrong."""
    if spot is None:
        return code_of(sentence or "")
    text = read_text(spot, "a name")
    if text is None:
        return ""
    if CODE.fullmatch(text):
        return text
    near = code_of(text)
    hint = f", such as {near!r}" if near else ""
    spot.error(f"a name in logs and tables has letters, digits, - and _, 40 at most{hint}")
    return ""


def _different(named: Sequence[tuple[Spot, str]], what: str, made_of: str) -> None:
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


def _text(spot: Spot | None) -> str | None:
    text = read_text(spot) if spot is not None else None
    if spot is not None and text is not None and not text.strip():
        spot.error("nothing but blanks")
    return text


def _flag(spot: Spot | None) -> bool:
    return bool(spot is not None and read_flag(spot))
