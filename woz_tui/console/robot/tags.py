r"""Tags in an utterance while it is typed: `\rspd=80\` for the voice, `^run(NAME)` for the body."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from woz_tui.console.robot.names import holding
from woz_tui.core.robots import RobotOutline, Tag

_SLASH = "\\"
#: A tag in the making, before the caret; and what belongs to it behind the caret.
_VOICE = re.compile(r"\\[A-Za-z]*(?:=[^\s\\]*)?")
_MOVE = re.compile(r"\^[A-Za-z]*(?:\([^\s()]*)?")
_REST = re.compile(r"[A-Za-z0-9_=/.\-]*[\\)]?")


@dataclass(frozen=True, slots=True)
class Begun:
    """A tag that is being typed: its place in the text, and what stands there before the caret."""

    start: int
    end: int
    typed: str


@dataclass(frozen=True, slots=True)
class Offer:
    """What a tag may become: `text` in its place, and a few words on it."""

    text: str
    help: str


def begun_tag(text: str, caret: int) -> Begun | None:
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
    return Begun(start, caret + _rest(typed, text[caret:]), typed)


def offers(begun: Begun, outline: RobotOutline) -> list[Offer]:
    """Tags, or names for a tag that takes one, that go with what was typed."""
    head, bracket, name = begun.typed.partition("(")
    if bracket:
        return [Offer(f"{head}({move})", "") for move in holding(name, outline.moves)]
    name, equals, value = begun.typed.partition("=")
    return [
        Offer(f"{name}={value}{_SLASH}" if equals and value else _short(tag), tag.help)
        for tag in _matching(name, bool(equals), outline.tags)
    ]


def completed(text: str, begun: Begun, offer: Offer) -> tuple[str, int]:
    """The text with the offer in the tag's place, and where the caret is then."""
    front = text[: begun.start] + offer.text
    return front + text[begun.end :], len(front)


def _matching(name: str, whole: bool, tags: Iterable[Tag]) -> list[Tag]:
    """Tags whose name is this one, or begins so."""
    folded = name.casefold()
    return [
        tag for tag in tags if (_name(tag) == folded if whole else _name(tag).startswith(folded))
    ]


def _name(tag: Tag) -> str:
    return re.split(r"[=(]|(?<=.)\\", tag.text, maxsplit=1)[0].casefold()


def _short(tag: Tag) -> str:
    """A tag as it is put in: one that takes a name without the name, which is typed next."""
    front, bracket, _ = tag.text.partition("(")
    return front + bracket if tag.text.startswith("^") and bracket else tag.text


def _rest(typed: str, behind: str) -> int:
    """Characters behind the caret that belong to the tag, if it is closed there."""
    found = _REST.match(behind)
    rest = found.group() if found is not None else ""
    closes = ")" if typed.startswith("^") else _SLASH
    return len(rest) if rest.endswith(closes) else 0
