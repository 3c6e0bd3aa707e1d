"""docs/reference/tables.md: figures and columns, out of the code that computes them.

    python -m tools.tables_reference docs/reference/tables.md

writes them anew; a test keeps them fresh.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tools import replaced
from woz_tui.analysis.measures import MEASURES
from woz_tui.analysis.tables import CONDITIONS, EVENTS, FIGURES, SAMPLES, Table, answers_wide

BEGIN = "<!-- tables: begin (python -m tools.tables_reference docs/reference/tables.md) -->"
END = "<!-- tables: end -->"
#: All of them, in the order of the page.
TABLES: tuple[Table[Any], ...] = (
    *FIGURES,
    answers_wide(["<questionnaire>.<item>"]),
    EVENTS,
    SAMPLES,
)


def tables() -> str:
    """All figures and all columns as Markdown."""
    return "\n".join([*_figures(), *(line for table in TABLES for line in _table(table))])


def _figures() -> Iterator[str]:
    yield "## Main figures"
    yield ""
    yield "| figure | unit | definition |"
    yield "|---|---|---|"
    for measure in MEASURES:
        yield f"| `{measure.name}` | {measure.unit} | {measure.meaning} |"


def _table(table: Table[Any]) -> Iterator[str]:
    yield ""
    yield f"## `{table.name}.csv`"
    yield ""
    yield table.meaning
    yield ""
    yield "| column | type | unit | meaning |"
    yield "|---|---|---|---|"
    figures = {measure.name for measure in MEASURES} if table is CONDITIONS else set()
    for column in table.columns:
        if column.name not in figures:
            yield f"| `{column.name}` | {column.type} | {column.unit} | {column.meaning} |"
    if figures:
        yield "| *all main figures* | | | one column each, see above |"


def refreshed(page: str) -> str:
    """`page` with the tables between its two marks as they are today."""
    return replaced(page, BEGIN, END, tables())


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.write_text(refreshed(target.read_text(encoding="utf-8")), encoding="utf-8")
