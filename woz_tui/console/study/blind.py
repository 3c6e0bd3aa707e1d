"""Condition-blind: the wizard is told a label in place of each condition.

Messages are changed before the picture takes them, so no part of the screen ever has a true name to
show. Names of actions, panels and files stay: they are the same in every condition.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache
from typing import TypeVar

import msgspec

from woz_tui.core import messages as m
from woz_tui.core import requests as r
from woz_tui.core.messages import Json
from woz_tui.core.settings import StudySettings
from woz_tui.experiment.template import fill

Told = TypeVar("Told", bound=msgspec.Struct)

#: Names by which things are looked up, and what is too frequent and has no words in it.
_NAMES = frozenset(
    {
        *("run", "action", "command", "driver", "sensor", "panel", "profile", "session", "ts"),
        *("participant", "experiment", "path", "console", "questionnaire", "item", "check"),
        *("role", "files"),
    }
)
_WORDLESS = (m.Reading, m.EngagementShown, m.FaceShown, m.BodyChanged, m.ControlsMoved, m.Shown)


class Blind:
    """Labels by condition; without any, everything passes as it is.

    Args:
        labels: Condition -> what the wizard is told. Labels that stand for several conditions get
            a number each, so that the wizard can still choose among them.
        texts: Variable -> its text in each condition, for those that depend on it.
    """

    def __init__(
        self,
        labels: Mapping[str, str] | None = None,
        texts: Mapping[str, Iterable[str]] | None = None,
    ) -> None:
        self._labels = _told_apart(labels or {})
        self._names = {label: name for name, label in self._labels.items()}
        self._variables = frozenset(("condition", *(texts or {})))
        instead = {
            text.casefold(): f"{{{name}}}"
            for name, found in (texts or {}).items()
            for text in found
        }
        instead |= {name.casefold(): label for name, label in self._labels.items()}
        longest_first = sorted(filter(_has_words, instead), key=len, reverse=True)
        self._instead = [instead[words] for words in longest_first]
        words = "|".join(f"(?P<w{at}>{_as_said(each)})" for at, each in enumerate(longest_first))
        self._pattern = re.compile(rf"(?<!\w)(?:{words})(?!\w)", re.IGNORECASE)

    def __bool__(self) -> bool:
        """Whether anything is kept from the wizard."""
        return bool(self._labels)

    def label(self, condition: str) -> str:
        """What the wizard is told; a condition that the file does not name is `?`."""
        return self._labels.get(condition, "?") if self and condition else condition

    def labels(self, conditions: Iterable[str]) -> tuple[str, ...]:
        """The same of several."""
        return tuple(map(self.label, conditions))

    def conditions(self, told: Json) -> Json:
        """The same of an order of conditions; anything else stays as it is."""
        return [self.label(str(one)) for one in told] if isinstance(told, list) else told

    def name(self, label: str) -> str:
        """The condition behind a label, for the robot process alone."""
        return self._names.get(label, label)

    def text(self, text: str) -> str:
        """Words with every condition in them replaced."""
        if not self:
            return text
        return self._pattern.sub(
            lambda found: self._instead[int((found.lastgroup or "w0")[1:])], text
        )

    def keeps(self, variable: str, value: object) -> bool:
        """Whether an utterance is shown with this variable's name instead of its value."""
        return bool(self) and (variable in self._variables or self.text(str(value)) != str(value))

    def plain(self, told: Json) -> Json:
        """The same of all texts in lists and mappings."""
        if isinstance(told, str):
            return self.text(told)
        if isinstance(told, list):
            return [self.plain(one) for one in told]
        if isinstance(told, dict):
            return {name: self.plain(one) for name, one in told.items()}
        return told

    def message(self, told: Told) -> Told:
        """A message of the session as the wizard may know it."""
        return told if not self or isinstance(told, _WORDLESS) else self._struct(told)

    def reply(self, told: r.Reply) -> r.Reply:
        """An answer of the robot process as the wizard may know it."""
        return self._struct(told) if self else told

    def _struct(self, told: Told) -> Told:
        changed = {}
        for name in _worded(type(told)):
            value = getattr(told, name)
            shown = self._condition(name, value) or self.plain(value)
            if shown != value:
                changed[name] = shown
        return msgspec.structs.replace(told, **changed) if changed else told

    def _condition(self, name: str, value: Json) -> Json:
        """A field that is a condition or an order of them; else nothing."""
        if name == "condition" and isinstance(value, str):
            return self.label(value)
        return self.conditions(value) if name == "order" else None


def blind_of(study: StudySettings) -> Blind:
    """As a welcome's settings tell it."""
    return Blind(study.blind, {name: texts.values() for name, texts in study.by_condition.items()})


def _has_words(text: str) -> bool:
    """Whether there is anything beside variables, by which the text can be known."""
    return bool(fill(text, lambda name: "").strip())


def _as_said(text: str) -> str:
    """A pattern of a variable's text, which may hold other variables, as it is said."""
    return re.escape(fill(text, lambda name: "\0")).replace("\0", ".+?")


@cache
def _worded(kind: type[msgspec.Struct]) -> tuple[str, ...]:
    """Fields that may hold words."""
    return tuple(name for name in kind.__struct_fields__ if name not in _NAMES)


def _told_apart(labels: Mapping[str, str]) -> dict[str, str]:
    found: dict[str, str] = {}
    for name, label in labels.items():
        count = 1
        unique = label or "?"
        while unique in found.values():
            count += 1
            unique = f"{label} ({count})"
        found[name] = unique
    return found
