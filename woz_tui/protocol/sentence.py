"""Sentences that can be worded in another language: English, with a code and what is filled in."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import msgspec


class Wording(msgspec.Struct, frozen=True, omit_defaults=True):
    """Of which sentence a text is, for whoever words it in another language.

    `code`: SECTION.NAME, as the files of `woz_tui/languages/screen` have it; `values`: what fills
    its braces, by name, where another sentence is a mapping of the same form. `text`: the English
    of such an inner sentence, which has no field of its own.
    """

    code: str
    values: dict[str, str | int | float | dict[str, Any]] = {}
    text: str = ""


def wording_of(texts: Mapping[str, object]) -> dict[str, Wording]:
    """Code and values of those of the texts that are sentences, by the names of their fields."""
    return {name: text.wording() for name, text in texts.items() if isinstance(text, Sentence)}


class Sentence(str):
    """An English text that knows its `code` and `values`; whoever does not, has a plain text.

    Glued to another text it is one more plain text: put it into a value of a longer sentence.
    """

    __slots__ = ("code", "values")
    code: str
    values: Mapping[str, str | int | float | Sentence]

    def __new__(cls, code: str, english: str, /, *, one: str = "", **values: object) -> Sentence:
        """`english` with its braces filled as by `str.format`; `one` instead if `count` is 1. What
        is neither number nor text (an error, a path) is filled in as its text.
        """
        text = (one if one and values.get("count") == 1 else english).format_map(values)
        sentence = super().__new__(cls, text)
        sentence.code = code
        sentence.values = {
            name: value if isinstance(value, str | int | float) else str(value)
            for name, value in values.items()
        }
        return sentence

    def __reduce__(self) -> tuple[type[str], tuple[str]]:
        """In another process it is a plain text."""
        return str, (str(self),)

    def spelt(self, english: str) -> Sentence:
        """The same sentence with this English, in which nothing is to be filled."""
        sentence = super().__new__(type(self), english)
        sentence.code, sentence.values = self.code, self.values
        return sentence

    def filled(self, **values: object) -> Sentence:
        """One whose values are open (`Sentence("why.lost", "lost: {reason}", reason="{reason}")`)
        with what is to stand there; those of `values` that it does not have are passed over.
        """
        mine: dict[str, Any] = {name: values[name] for name in self.values}
        return Sentence(self.code, self, **mine)

    def cleaned(self, clean: Callable[[str], str]) -> Sentence:
        """The same, its text and the texts among its values as `clean` has them."""
        sentence = super().__new__(type(self), clean(str(self)))
        sentence.code = self.code
        sentence.values = {
            name: value.cleaned(clean)
            if isinstance(value, Sentence)
            else clean(value)
            if isinstance(value, str)
            else value
            for name, value in self.values.items()
        }
        return sentence

    def wording(self, *, inner: bool = False) -> Wording:
        """What is sent beside the text, or with it where it is `inner`."""
        values = {
            name: msgspec.to_builtins(value.wording(inner=True))
            if isinstance(value, Sentence)
            else value
            for name, value in self.values.items()
        }
        return Wording(self.code, values, str(self) if inner else "")


def said_by(error: Exception) -> str:
    """The text of an error, which knows its code if it was raised with a sentence."""
    match error.args:
        case (Sentence() as sentence, *_):
            return sentence
    return str(error)
