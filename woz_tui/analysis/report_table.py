"""A table of the report, and what its cells are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field


class LogText(str):
    """Words of a person or of an experiment file: they may hold any character."""

    __slots__ = ()


class AlarmText(LogText):
    """Something that went wrong: the page shows it in red."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class ReportTable:
    """A table of the report; it is not shown if it has no rows.

    Attributes:
        words: So many of the first columns hold words; the others hold figures.
        on_terminal: So many of the first columns have room on a terminal; None: all of them.
        definitions: Titles of columns and rows, and which measure says what each is.
        total: The last row sums up the others.
    """

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    words: int = 1
    on_terminal: int | None = None
    definitions: Mapping[str, str] = field(default_factory=dict)
    total: bool = False
