"""Annotations that say what a setting or an argument may be.

They stand in the types (`Annotated[float, Range(0, 5, "m")]`), where one decoder checks them, one
schema generator publishes them and one reader finds them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from woz_tui.protocol.sentence import Sentence


class Section:
    """Base of a settings dataclass with rules beyond what the type of each setting says."""

    __slots__ = ()

    def problems(self) -> Sequence[tuple[str, str]]:
        """What does not fit together: pairs of a setting's path (`joints.pan.low`; empty: all of
        them) and a sentence. Each is shown at its place in the file.
        """
        return ()

    def warnings(self) -> Sequence[tuple[str, str]]:
        """What can be used but is not as it is written, in the same pairs."""
        return ()

    def included(self) -> Any:
        """Files that the settings name and that belong to the experiment
        (`config.annotated_decoder.IncludedFiles`); None if there are none.
        """
        return None


class Entry:
    """Base of a shape that is no driver's settings but an entry of a file, as messages name it.

    `what`: the entry; `example`: how it is written; `either`: one of these must be there.
    """

    __slots__ = ()
    what: ClassVar[str] = Sentence("check.a_section", "a section")
    example: ClassVar[str] = ""
    either: ClassVar[tuple[str, ...]] = ()


@dataclass(frozen=True, slots=True)
class Range:
    """A number from `low` to `high`, both included, in `unit`; None means unbounded."""

    low: float | None = None
    high: float | None = None
    unit: str = ""

    def contains(self, value: float) -> bool:
        """Whether `value` lies inside; NaN never does."""
        return (
            not math.isnan(value)
            and (self.low is None or value >= self.low)
            and (self.high is None or value <= self.high)
        )

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        if self.low is not None and self.high is not None:
            return f"{self.low:g} to {self.high:g}{unit}"
        if self.low is not None:
            return f"{self.low:g}{unit} or more"
        if self.high is not None:
            return f"{self.high:g}{unit} or less"
        return f"any number{unit}"


@dataclass(frozen=True, slots=True)
class OneOf:
    """A word out of a list."""

    choices: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Unique:
    """A list in which nothing stands twice."""


@dataclass(frozen=True, slots=True)
class NotEmpty:
    """A list with at least one entry; `message` reports one without."""

    message: str = Sentence("check.value_missing", "a value is missing here")


@dataclass(frozen=True, slots=True)
class OneOrMore:
    """A list of texts, where a single one can stand without brackets; `of` says what each is."""

    of: str = Sentence("check.a_text", "text")


@dataclass(frozen=True, slots=True)
class NotBlank:
    """A text with more than blanks in it."""


@dataclass(frozen=True, slots=True)
class ReadApart:
    """A value that a reader of its own reads. `written`: its type as a file gives it, or the name
    of its JSON Schema; None: as annotated.
    """

    written: Any = None


@dataclass(frozen=True, slots=True)
class Pattern:
    """A text that matches `regex` as a whole; `meaning` says so in words."""

    regex: str
    meaning: str


@dataclass(frozen=True, slots=True)
class Doc:
    """What a setting is for: one sentence for tables and editors."""

    text: str


@dataclass(frozen=True, slots=True)
class Path:
    """A path, relative to the file it stands in. `must_exist` is checked by `woz check`."""

    must_exist: bool = False


@dataclass(frozen=True, slots=True)
class Port:
    """A device that one driver has for itself: a second one of a file that names it is an error."""


@dataclass(frozen=True, slots=True)
class Sibling:
    """The name of another driver of the same robot; empty: of none. `uses`: what that one must
    have, as its `Offer.lacks` calls it.
    """

    uses: str = ""


@dataclass(frozen=True, slots=True)
class Included:
    """A mapping that may also stand in a YAML file of its own: then the file's path is given,
    relative to the file it stands in. It stands at a type united with text. `words` are texts that
    are meant as they are, and no paths.
    """

    words: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Seconds:
    """A duration: a number of seconds, or text such as `250 ms`, `2 s`, `10 min`."""

    low: float = 0.0
    high: float = 86_400.0
