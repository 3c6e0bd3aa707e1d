r"""Completes names of moves, and tags in utterances like `\rspd=80\`, `^run(NAME)`."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from woz_tui.protocol.robot_outline import RobotOutline


def names_beginning(typed: str, names: Iterable[str]) -> list[str]:
    """Names that begin with exactly what was typed, and go on."""
    return [name for name in names if name.startswith(typed) and name != typed]


def names_containing(typed: str, names: Iterable[str]) -> list[str]:
    """Names that hold what was typed, in whatever case: those first that have it where the name or
    its last part begins; all names if nothing was typed.
    """
    folded = typed.casefold()
    found = [name for name in names if folded in name.casefold()]
    return sorted(found, key=lambda name: _rank(name.casefold(), folded))


def best_match(typed: str, names: Iterable[str]) -> str:
    """What is played for `typed`: a path and a name's whole last part as they are, which the robot
    completes; of anything else the first name that holds it, or itself.
    """
    names = list(names)
    if "/" in typed or any(name.rpartition("/")[2] == typed for name in names):
        return typed
    return next(iter(names_containing(typed, names)), typed)


def _rank(name: str, typed: str) -> int:
    if name.startswith(typed) or name.rpartition("/")[2] == typed:
        return 0
    return 1 if name.rpartition("/")[2].startswith(typed) else 2


_SLASH = "\\"
#: A tag in the making, before the caret; and what belongs to it behind the caret.
_VOICE = re.compile(r"\\[A-Za-z]*(?:=[^\s\\]*)?")
_MOVE = re.compile(r"\^[A-Za-z]*(?:\([^\s()]*)?")
_NUMBER = re.compile(r"\\[A-Za-z]+=([0-9]+)\\")
_REST = re.compile(r"[A-Za-z0-9_=/.\-]*[\\)]?")


@dataclass(frozen=True, slots=True)
class PartialTag:
    """A tag that is being typed: its place in the text, and what stands there before the caret."""

    start: int
    end: int
    typed: str


@dataclass(frozen=True, slots=True)
class TagOffer:
    """What a tag may become: `text` in its place, and a few words on it."""

    text: str
    help: str


@dataclass(frozen=True, slots=True)
class NumberEntry:
    r"""A tag with a number that tab has just put in, `\pau=500\`: digits typed right behind it are
    meant for the number, and one more `\` behind them for its end.

    `text` has its end at `caret`, the number begins at `start`; `typed` is what of it was typed,
    and it is `over` behind its end.
    """

    text: str
    start: int
    caret: int
    typed: str = ""
    over: bool = False

    @classmethod
    def put_in(cls, text: str, begun: PartialTag, caret: int) -> NumberEntry | None:
        """The tag between where it was begun and the caret, if it has a number."""
        found = _NUMBER.fullmatch(text[begun.start : caret])
        return cls(text, begun.start + found.start(1), caret) if found is not None else None

    def goes_on(self, text: str) -> NumberEntry | None:
        """What becomes of it with the text as it is now; None: it was left."""
        front, behind = self.text[: self.caret], self.text[self.caret :]
        if text == self.text:
            return self
        more = text[self.caret : len(text) - len(behind)]
        digits = more.removesuffix(_SLASH)
        known = digits.isascii() and (digits.isdigit() or bool(not digits and self.typed))
        if self.over or not known or text != front + more + behind:
            return None
        number = self.typed + digits
        front = f"{self.text[: self.start]}{number}{_SLASH}"
        return NumberEntry(front + behind, self.start, len(front), number, over=digits != more)


def partial_tag(text: str, caret: int) -> PartialTag | None:
    r"""The tag in which, or right behind whose `\` or `^`, the caret stands."""
    before = text[:caret]
    slash = before.rfind(_SLASH) if before.count(_SLASH) % 2 else -1
    start = max(slash, before.rfind("^"))
    if start < 0:
        return None
    typed = before[start:]
    pattern = _VOICE if typed.startswith(_SLASH) else _MOVE
    if not pattern.fullmatch(typed):
        return None
    # Characters behind the caret belong to it, if it is closed there.
    found = _REST.match(text[caret:])
    rest = found.group() if found is not None else ""
    closes = ")" if typed.startswith("^") else _SLASH
    return PartialTag(start, caret + (len(rest) if rest.endswith(closes) else 0), typed)


def tag_offers(begun: PartialTag, outline: RobotOutline) -> list[TagOffer]:
    """Tags, or names for a tag that takes one, that go with what was typed."""
    head, bracket, name = begun.typed.partition("(")
    if bracket:
        return [TagOffer(f"{head}({move})", "") for move in names_containing(name, outline.moves)]
    name, equals, value = begun.typed.partition("=")
    typed = name.casefold()
    offers = []
    for tag in outline.tags:
        known = re.split(r"[=(]|(?<=.)\\", tag.text, maxsplit=1)[0].casefold()
        if known != typed if equals else not known.startswith(typed):
            continue
        front, bracket, _ = tag.text.partition("(")
        if equals and value:
            text = f"{name}={value}{_SLASH}"
        elif tag.text.startswith("^") and bracket:
            text = f"{front}("  # the name in it is typed next
        else:
            text = tag.text
        offers.append(TagOffer(text, tag.help))
    return offers


def completed(text: str, begun: PartialTag, offer: TagOffer) -> tuple[str, int]:
    """The text with the offer in the tag's place, and where the caret is then."""
    front = text[: begun.start] + offer.text
    return front + text[begun.end :], len(front)
