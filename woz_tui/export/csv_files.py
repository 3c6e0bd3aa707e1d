"""Tidy tables as CSV (RFC 4180), with a data dictionary as a Frictionless data package."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable
from contextlib import ExitStack
from functools import lru_cache
from typing import Any, TextIO

import msgspec

from woz_tui import __version__
from woz_tui.core.cleaning import cell
from woz_tui.core.messages import Reading
from woz_tui.export.course import Session
from woz_tui.export.exporter import Exporter, Options, Told
from woz_tui.export.folder import Folder
from woz_tui.export.redaction import PLACEHOLDER
from woz_tui.export.sources import Source, nameless
from woz_tui.export.tables import (
    ANSWERS,
    ENGAGEMENT,
    EVENTS,
    SAMPLES,
    SESSIONS,
    SETTINGS,
    Table,
)
from woz_tui.record.log import Damage

_GUARDED = (
    "Texts that begin with = + - @ ' (or a tab, a line end, a full-width = + - @) have one ' more "
    "before them, so that no spreadsheet takes them for a formula. Numbers never have. Control "
    "characters are shown as their pictures (U+2400 and on)."
)
_ABOUT = f"""## Files

- `events.csv`: everything that happened, one row each; the table to begin with
- `engagement.csv`: episodes of the engagement machine
- `questionnaires.csv`: answers
- `settings.csv`: what robots had set, and where it was other than asked for
- `sessions.csv`: the sessions, and what is wrong with their logs
- `samples.csv`: values of the sensors (only with `--samples`)
- `datapackage.json`: what each column means, its type and unit

The column `log` ties them together. CSV as in RFC 4180: UTF-8, commas, a dot in decimals, CR LF at
the end of a row. An empty cell: there is no such value. {_GUARDED}"""


class CsvExporter(Exporter):
    """All sessions in the same tables."""

    about = _ABOUT

    def __init__(self, folder: Folder, options: Options) -> None:
        super().__init__(folder, options)
        self._files = ExitStack()
        self._tables: list[Table[Any]] = [EVENTS, ENGAGEMENT, ANSWERS, SETTINGS, SESSIONS]
        if options.samples:
            self._tables.append(SAMPLES)
        self._writers = {table.name: self._begun(table) for table in self._tables}

    def _begun(self, table: Table[Any]) -> _Rows:
        file = self._files.enter_context(self._folder.text(f"{table.name}.csv"))
        return _Rows(file, table)

    def add(self, session: Session, source: Source) -> list[str]:
        """One session."""
        self._writers["events"].write(session, session.events)
        self._writers["engagement"].write(session, session.engagement)
        self._writers["questionnaires"].write(session, session.answers)
        self._writers["settings"].write(session, session.settings)
        self._writers["sessions"].write(session, [session])
        if not self._options.samples:
            return []
        damage = Damage()
        self._writers["samples"].write(session, self._samples(source, damage))
        return (nameless(damage) if self._options.redact else damage).sentences()

    def _samples(self, source: Source, damage: Damage) -> Iterable[Reading]:
        for reading in source.samples(damage):
            private = reading.text and self._options.redact
            yield msgspec.structs.replace(reading, text=PLACEHOLDER) if private else reading

    def finish(self, told: list[Told]) -> None:
        """The data dictionary and the README."""
        self._files.close()
        package = json.dumps(_package(self._tables, told), indent=2, ensure_ascii=False)
        self._folder.write("datapackage.json", package + "\n")
        super().finish(told)

    def close(self) -> None:
        """Whatever happened: close the files."""
        self._files.close()


#: The same few texts come again and again.
_cell = lru_cache(maxsize=4096, typed=True)(cell)


class _Rows:
    def __init__(self, file: TextIO, table: Table[Any]) -> None:
        self._table = table
        self._writer = csv.writer(file, lineterminator="\r\n")
        self._writer.writerow([column.name for column in table.columns])

    def write(self, session: Session, rows: Iterable[object]) -> None:
        columns = [(column.cell, column.type == "string") for column in self._table.columns]
        self._writer.writerows(
            [_cell(of(session, row), text=text) for of, text in columns] for row in rows
        )


def _package(tables: Iterable[Table[Any]], told: list[Told]) -> dict[str, Any]:
    """A Frictionless data package, https://specs.frictionlessdata.io/tabular-data-package/."""
    return {
        "name": "woz-sessions",
        "profile": "tabular-data-package",
        "title": "Sessions of wizard-of-Oz experiments",
        "description": f"Exported by woz-tui {__version__}. {_GUARDED}",
        "resources": [_resource(table) for table in tables],
        "damage": {each.session.name: each.session.damage for each in told if each.session.damage},
    }


def _resource(table: Table[Any]) -> dict[str, Any]:
    schema: dict[str, Any] = {
        "fields": [
            {
                "name": column.name,
                "type": column.type,
                "description": column.meaning,
                **({"unit": column.unit} if column.unit else {}),
            }
            for column in table.columns
        ],
        "missingValues": [""],
    }
    if table.key:
        schema["primaryKey"] = list(table.key)
    return {
        "name": table.name,
        "path": f"{table.name}.csv",
        "description": table.meaning,
        "profile": "tabular-data-resource",
        "format": "csv",
        "mediatype": "text/csv",
        "encoding": "utf-8",
        "dialect": {"delimiter": ",", "quoteChar": '"', "doubleQuote": True, "header": True},
        "schema": schema,
    }
