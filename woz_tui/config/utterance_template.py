"""Variables in utterances: `Hello {participant}`, where `{{` and `}}` stand for braces.

A file is checked for them when it is read; the values are filled in when an action is played.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from typing import TYPE_CHECKING

from woz_tui.protocol.sentence import Sentence

if TYPE_CHECKING:  # consoles fill in what the robot process has checked
    from woz_tui.config.yaml_cursor import Cursor

#: Variables that the session itself fills in.
BUILT_IN = ("participant", "condition", "session", "trial", "wizard")
#: More where there is an engagement model: who stands there, and what is known of them.
VISITOR = "visitor"
AGE_GROUP, ADDRESS = f"{VISITOR}.age_group", f"{VISITOR}.address"
OF_VISITOR = (VISITOR, AGE_GROUP, ADDRESS)
#: Begins the variables of what is known of the participant: `{participant.group}`.
PARTICIPANT = "participant"

#: Stands for a text that depends on the condition, where that is kept.
HIDDEN_TEXT = "..."
#: How a sentence begins that `woz new` leaves to the author.
TO_WRITE = "TO WRITE"
#: Of each of those `woz check` says so.
UNWRITTEN = Sentence("check.unwritten", "not written yet: the robot would say it as it stands")
#: What a variable may be called.
NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
#: What stands in braces: such a name, or something known of a person.
_VARIABLE = re.compile(rf"(?:(?:{VISITOR}|{PARTICIPANT})\.)?{NAME.pattern}")

_PART = re.compile(r"\{\{|\}\}|\{(?P<name>[^{}\n]*)\}|(?P<brace>[{}])")


def names(text: str) -> list[str]:
    """The variables that `text` holds, in order, repeated as often as they stand there."""
    return [
        match["name"]
        for match in _PART.finditer(text)
        if match["name"] is not None and _VARIABLE.fullmatch(match["name"])
    ]


def fill(text: str, value_of: Callable[[str], str]) -> str:
    """`text` with every variable replaced by `value_of` its name, which may raise.

    Braces without a partner, and those around something that is no name, stay as they are.
    """

    def part(match: re.Match[str]) -> str:
        name = match["name"]
        if name is None:
            return match[0][0]
        return value_of(name) if _VARIABLE.fullmatch(name) else match[0]

    return _PART.sub(part, text)


def put_in_place(text: str, texts: Mapping[str, str]) -> str:
    """`text` with these variables replaced by their own texts, which may hold others; all else
    stays as it is written.
    """

    def part(match: re.Match[str]) -> str:
        return texts.get(match["name"] or "", match[0])

    return _PART.sub(part, text)


def to_write(condition: str, like: str) -> str:
    """What stands in a new file where a sentence is to be written for a condition; `like` is what
    others say there.
    """
    return f"{TO_WRITE} for {condition}, such as: {like}"


def check(cursor: Cursor, text: str, known: Collection[str]) -> None:
    """Report every variable in `text` that is not `known`, braces that do not match, and a sentence
    that is still to be written.
    """
    if text.startswith(TO_WRITE):
        cursor.warning(UNWRITTEN)
    for match in _PART.finditer(text):
        name = match["name"]
        if match["brace"]:
            brace = match["brace"]
            cursor.error(
                Sentence(
                    "check.brace",
                    "a {brace!r} without its counterpart; write {twice} for a brace",
                    brace=brace,
                    twice=brace * 2,
                )
            )
        elif name is not None and name not in known:
            nearest = cursor.report.hint(
                name, known, or_list=Sentence("check.known_are", "known are")
            )
            cursor.error(
                Sentence(
                    "check.no_variable",
                    "there is no variable {{{name}}}{near}",
                    name=name,
                    near=nearest,
                )
            )
