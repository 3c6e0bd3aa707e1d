"""The tables of docs/export.md, written from the code.

    python -m woz_tui.export.guide docs/export.md

writes them anew; a test keeps them fresh.
"""

from __future__ import annotations

import sys
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

from woz_tui.export import redaction
from woz_tui.export.tables import (
    ANSWERS,
    ENGAGEMENT,
    EVENTS,
    SAMPLES,
    SESSIONS,
    SETTINGS,
    Table,
)


def columns() -> str:
    """All columns of all CSV tables."""
    tables: list[Table[Any]] = [EVENTS, ENGAGEMENT, ANSWERS, SETTINGS, SESSIONS, SAMPLES]
    return "\n\n".join("\n".join(_table(table)) for table in tables)


def _table(table: Table[Any]) -> Iterator[str]:
    yield f"### `{table.name}.csv`"
    yield ""
    yield table.meaning
    yield ""
    yield "| column | type | unit | meaning |"
    yield "|---|---|---|---|"
    for column in table.columns:
        yield f"| `{column.name}` | {column.type} | {column.unit} | {column.meaning} |"


def kept() -> str:
    """What redaction leaves of the texts."""
    fields = sorted({"experiment", *redaction.KEPT, *redaction.VOCABULARY})
    inside = [
        f"`{field}.{name}`"
        for field, names in sorted(redaction.KEPT_INSIDE.items())
        for name in sorted(names)
    ]
    return "\n".join(
        [
            "Everywhere: " + ", ".join(f"`{field}`" for field in fields) + ".",
            "",
            "Within objects: " + ", ".join(inside) + ".",
            "",
            "`was` in " + ", ".join(sorted(redaction.KEPT_IN)) + ".",
            "",
            *(_words(kind, fields) for kind, fields in sorted(redaction.WORDS_INSIDE.items())),
        ]
    )


def _words(kind: str, fields: Mapping[str, Collection[str]]) -> str:
    names = [f"`{field}.{name}`" for field, inside in fields.items() for name in sorted(inside)]
    return f"A lone word or a colour, in {kind}: " + ", ".join(names) + "."


PARTS = {"columns": columns, "kept": kept}


def renewed(page: str) -> str:
    """The page with the tables as they are now."""
    for name, part in PARTS.items():
        begin, end = f"<!-- {name}: begin", f"<!-- {name}: end -->"
        head, _, rest = page.partition(begin)
        comment, _, rest = rest.partition("-->")
        _, _, tail = rest.partition(end)
        page = f"{head}{begin}{comment}-->\n\n{part()}\n\n{end}{tail}"
    return page


if __name__ == "__main__":
    path = Path(sys.argv[1])
    path.write_text(renewed(path.read_text(encoding="utf-8")), encoding="utf-8")
