"""docs/reference/tables.md: figures and columns, out of the code that computes them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any

from tools import replaced
from woz_tui.analysis.feature_report import figure_tables
from woz_tui.analysis.measures import MEASURES
from woz_tui.analysis.tables import (
    CONDITIONS,
    EVENTS,
    SAMPLES,
    Column,
    TableDefinition,
)
from woz_tui.features.questionnaires.codebook import CODEBOOK, answer_column, variables, wide_table
from woz_tui.features.questionnaires.report import ROUND_COLUMNS
from woz_tui.features.questionnaires.score_codebook import SCORE_CODEBOOK
from woz_tui.protocol.welcome import Questionnaire, QuestionnaireItem

_ANY = Questionnaire("<questionnaire>", items=(QuestionnaireItem("<item>", "what was asked"),))

#: All of them, in the order of the page.
TABLES: tuple[TableDefinition[Any], ...] = (
    *figure_tables(),
    wide_table(ROUND_COLUMNS, [answer_column([*variables(_ANY)])]),
    CODEBOOK,
    SCORE_CODEBOOK,
    EVENTS,
    SAMPLES,
)

#: In so many tables a column is explained once, above them.
_MANY = 10
_HEAD = ("| column | type | unit | meaning |", "|---|---|---|---|")


def tables() -> str:
    """All figures and all columns as Markdown."""
    rows = Counter(_row(column) for table in TABLES for column in table.columns)
    shared = [row for row, times in rows.items() if times >= _MANY]
    below = (line for table in TABLES for line in _table(table, shared))
    return "\n".join([*_figures(), "", "## Columns of many tables", "", *_HEAD, *shared, *below])


def _figures() -> Iterator[str]:
    yield "## Main figures"
    yield ""
    yield "| figure | unit | definition |"
    yield "|---|---|---|"
    for measure in MEASURES:
        yield f"| `{measure.name}` | {measure.unit} | {measure.meaning} |"


def _table(table: TableDefinition[Any], shared: list[str]) -> Iterator[str]:
    above = [column.name for column in table.columns if _row(column) in shared]
    figures = {measure.name for measure in MEASURES} if table is CONDITIONS else set()
    yield ""
    yield f"## `{table.name}.csv`"
    yield ""
    yield table.meaning
    yield ""
    if above:
        yield f"With [{', '.join(f'`{name}`' for name in above)}](#columns-of-many-tables)."
        yield ""
    yield from _HEAD
    for column in table.columns:
        if column.name not in {*figures, *above}:
            yield _row(column)
    if figures:
        yield "| *all main figures* | | | one column each, see above |"


def _row(column: Column[Any]) -> str:
    return f"| `{column.name}` | {column.type} | {column.unit} | {column.meaning} |"


def refreshed(page: str) -> str:
    """`page` with the tables as they are today."""
    return replaced(page, "tables", tables())
