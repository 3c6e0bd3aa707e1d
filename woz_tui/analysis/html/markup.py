"""HTML that is safe by the way it is made: whatever is not `Markup` is escaped.

Text out of a log may hold anything: `<script>`, quotes, NUL bytes, halves of surrogate pairs.
"""

from __future__ import annotations

import html
import json
import re
from collections.abc import Iterable, Iterator
from functools import cache
from typing import TypeAlias

#: What HTML has no place for: control characters but tab and newline, halves of pairs.
_UNPRINTABLE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
_HALVES = re.compile("[\ud800-\udfff]")
_SEPARATORS = re.compile("[\u2028\u2029]")
#: All that is not written as it stands.
_SPECIAL = re.compile(f"[&<>\"'{_UNPRINTABLE.pattern[1:-1]}{_SEPARATORS.pattern[1:-1]}]")
#: Elements without content or end.
_VOID = frozenset({"br", "col", "hr", "input", "link", "meta"})


class Markup(str):
    """Text that is HTML (or SVG) already."""

    __slots__ = ()


#: What an element holds; what is nested in lists and generators comes one after the other.
Child: TypeAlias = "Markup | str | Iterable[Child] | None"
Attribute = str | int | float | bool | None


def clean(text: str) -> str:
    """`text` with U+FFFD for every character that a page cannot hold.

    Line and paragraph separators become blanks: a paragraph's end would also end the isolation of
    `isolated`, and let a right-to-left mark after it loose on the page.
    """
    return _UNPRINTABLE.sub("\ufffd", _SEPARATORS.sub(" ", text))


def escaped(text: str) -> Markup:
    """`text` as the content of an element, or of a quoted attribute."""
    return text if isinstance(text, Markup) else Markup(_safe(text))


def _safe(text: str) -> str:
    """The same as a plain text, for what is joined at once."""
    # Most texts of a page are words and numbers: one look at each is enough.
    if isinstance(text, Markup) or not _SPECIAL.search(text):
        return text
    return html.escape(clean(text))


def tag(name: str, /, *children: Child, **attributes: Attribute) -> Markup:
    """An element. None and False leave an attribute out, True gives it no value; `class_` is
    `class`, and `data_number` is `data-number`.
    """
    parts = [f"<{name}"]
    for key, value in attributes.items():
        if value is not None and value is not False:
            parts.append(_attribute(key, value))
    parts.append(">")
    if name not in _VOID:
        _gather(children, parts)
        parts.append(f"</{name}>")
    return Markup("".join(parts))


def joined(*children: Child) -> Markup:
    """All children, one after the other."""
    parts: list[str] = []
    _gather(children, parts)
    return Markup("".join(parts))


def _gather(children: Iterable[Child], parts: list[str]) -> None:
    """As `pieces`, into a list: a page has so many elements that this is worth it."""
    for child in children:
        if isinstance(child, str):
            parts.append(_safe(child))
        elif child is not None:
            _gather(child, parts)


def pieces(children: Iterable[Child]) -> Iterator[str]:
    """The same, one at a time: for what is too large to be held at once."""
    for child in children:
        if isinstance(child, str):
            yield _safe(child)
        elif child is not None:
            yield from pieces(child)


def _attribute(key: str, value: str | float | bool) -> str:
    name = _attribute_name(key)
    if value is True:
        return f" {name}"
    return f' {name}="{_safe(value) if isinstance(value, str) else short(value)}"'


@cache
def _attribute_name(key: str) -> str:
    return key.rstrip("_").replace("_", "-")


def short(number: float) -> str:
    """A number in a picture, to a tenth: `12.5`, `12`."""
    return f"{number:.1f}".removesuffix(".0")


def isolated(text: str) -> Markup:
    """Text out of a log, apart from its surroundings: a right-to-left mark in it turns nothing
    around that stands beside it.
    """
    return tag("bdi", text, dir="auto")


def json_block(content: object, name: str) -> Markup:
    """Data for the page's script, in an element that no browser executes.

    In a `script` element only `</script` and `<!--` mean anything; without `<` neither can occur.
    """
    text = json.dumps(content, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return tag("script", Markup(_HALVES.sub("\ufffd", text)), type="application/json", id=name)
