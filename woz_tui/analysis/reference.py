"""The tables of docs/report.md, out of the code that computes the figures.

    python -m woz_tui.analysis.reference docs/report.md

writes them anew; a test keeps them fresh.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from woz_tui.analysis.measures import MEASURES
from woz_tui.analysis.sheets import SESSIONS, SHEETS, Sheet
from woz_tui.analysis.tidy import DICTIONARY, WIDE, dictionary
from woz_tui.record.reference import replaced

BEGIN = "<!-- tables: begin (python -m woz_tui.analysis.reference docs/report.md) -->"
END = "<!-- tables: end -->"


def tables() -> str:
    """All figures and all columns as Markdown."""
    return "\n".join([*_figures(), *_files()])


def _figures() -> Iterator[str]:
    yield "### Main figures"
    yield ""
    yield "| figure | unit | definition |"
    yield "|---|---|---|"
    for measure in MEASURES:
        yield f"| `{measure.name}` | {measure.unit} | {measure.meaning} |"


def _files() -> Iterator[str]:
    for sheet in SHEETS:
        yield ""
        yield f"### `{sheet.name}.csv`"
        yield ""
        yield f"{sheet.meaning[:1].upper()}{sheet.meaning[1:]}."
        yield ""
        yield "| column | unit | meaning |"
        yield "|---|---|---|"
        yield from _columns(sheet)
    yield ""
    yield f"### `{WIDE}.csv`"
    yield ""
    yield "The answers once more: one row for each round of a questionnaire, with a column for each"
    yield "item."
    yield ""
    yield "| column | unit | meaning |"
    yield "|---|---|---|"
    for file, column, unit, meaning in dictionary():
        if file == f"{WIDE}.csv":
            yield f"| `{column}` | {unit} | {meaning} |"
    yield ""
    yield f"`{DICTIONARY}.csv` has these tables for programs: `file`, `column`, `unit`, `meaning`."


def _columns(sheet: Sheet) -> Iterator[str]:
    figures = {measure.name for measure in MEASURES} if sheet is SESSIONS else set()
    for column in sheet.columns:
        if column.name not in figures:
            yield f"| `{column.name}` | {column.unit} | {column.meaning} |"
    if figures:
        yield "| *all main figures* | | one column each, see above |"


def refreshed(page: str) -> str:
    """`page` with the tables between its two marks as they are today."""
    return replaced(page, BEGIN, END, tables())


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.write_text(refreshed(target.read_text(encoding="utf-8")), encoding="utf-8")
