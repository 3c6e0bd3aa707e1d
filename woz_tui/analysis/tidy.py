"""The figures as tidy CSV files: one fact a row, one variable a column, with a dictionary of them.

UTF-8, comma, one head line; an empty cell is a value that does not exist; truth values are `true`
and `false`; times in seconds unless the column's name ends in `_ms`. No text is a formula to a
spreadsheet. Files are for their owner only, as logs are.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Iterable, Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Self

from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.sheets import SHEETS, Value
from woz_tui.core.cleaning import cell

if TYPE_CHECKING:
    from _csv import Writer

#: Answers once more, one row for each round and a column for each item.
WIDE = "questionnaires_wide"
DICTIONARY = "columns"
_WIDE_HEAD = {
    "log": "name of the log, without `.jsonl`",
    "session": "session's code",
    "participant": "participant's code",
    "condition": "condition at that moment",
    "trial": "number of the trial; empty outside of trials",
    "questionnaire": "its name",
    "round": "how often it was put in this session so far, from 1",
}
_ITEMS = "(item)"


class Folder:
    """A folder of CSV files that takes one session after the other and keeps none of them.

    Raises:
        OSError: The folder cannot be made or a file not be written.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._files = ExitStack()
        self._writers: dict[str, Writer] = {}
        self._wide: list[dict[str, Value]] = []
        self._items: dict[str, None] = {}

    def __enter__(self) -> Self:
        self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        for sheet in SHEETS:
            self._open(sheet.name, [column.name for column in sheet.columns])
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with self._files:
            if error is None:
                self._close()

    def add(self, figures: SessionFigures) -> None:
        """All rows of one session."""
        for sheet in SHEETS:
            write = self._writers[sheet.name].writerow
            for entry in sheet.rows(figures):
                write([cell(rounded(column.of(entry))) for column in sheet.columns])
        self._wide += self._rounds(figures)

    def _open(self, name: str, head: Sequence[str]) -> Writer:
        path = self._folder / f"{name}.csv"
        taken = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC, 0o600)
        file = self._files.enter_context(os.fdopen(taken, "w", encoding="utf-8", newline=""))
        os.fchmod(taken, 0o600)  # also where it was there
        writer = self._writers[name] = csv.writer(file, lineterminator="\n")
        writer.writerow(map(cell, head))
        return writer

    def _rounds(self, figures: SessionFigures) -> Iterable[dict[str, Value]]:
        rounds: dict[tuple[str, int], dict[str, Value]] = {}
        for answer in figures.answers:
            row = rounds.setdefault(
                (answer.questionnaire, answer.round),
                {
                    "log": figures.stem,
                    "session": figures.session,
                    "participant": answer.participant,
                    "condition": answer.condition,
                    "trial": None if answer.trial < 0 else answer.trial,
                    "questionnaire": answer.questionnaire,
                    "round": answer.round,
                },
            )
            name = f"{answer.questionnaire}.{answer.item}"
            self._items[name] = None
            row[name] = answer.text if answer.value is None else answer.value
        return rounds.values()

    def _close(self) -> None:
        head = [*_WIDE_HEAD, *self._items]
        writer = self._open(WIDE, head)
        for row in self._wide:
            writer.writerow([cell(rounded(row.get(name))) for name in head])
        writer = self._open(DICTIONARY, ["file", "column", "unit", "meaning"])
        writer.writerows(dictionary())


def dictionary() -> list[tuple[str, str, str, str]]:
    """File, column, unit and meaning of all columns of all files."""
    rows = [
        (f"{sheet.name}.csv", column.name, column.unit, column.meaning)
        for sheet in SHEETS
        for column in sheet.columns
    ]
    rows += [(f"{WIDE}.csv", name, "", meaning) for name, meaning in _WIDE_HEAD.items()]
    told = "`<questionnaire>.<item>`: the number that was chosen, or the text that was typed"
    return [*rows, (f"{WIDE}.csv", _ITEMS, "", told)]


def rounded(value: Value) -> Value:
    """A figure with the digits that count, a whole one without a dot; all else as it is."""
    if not isinstance(value, float):
        return value
    return int(value) if value.is_integer() and abs(value) < 1e15 else round(value, 9)
