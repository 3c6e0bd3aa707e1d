"""The tables as CSV files (RFC 4180) with a data dictionary, a Frictionless data package.

UTF-8, commas, one head line, CR LF; an empty cell is a value that does not exist; truth values are
`true` and `false`. No text is a formula to a spreadsheet. Files are for their owner only, as logs
are.
"""

from __future__ import annotations

import csv
import json
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import msgspec

from woz_tui import __version__
from woz_tui.analysis.feature_report import FeatureReport, figure_tables
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.spreadsheets import PLAIN, CsvFormat
from woz_tui.analysis.tables import TableDefinition
from woz_tui.feature import pieces
from woz_tui.system.text_cleaning import cell

if TYPE_CHECKING:
    from _csv import Writer

#: How texts are kept from being formulas, for the reader of the tables.
GUARDED = (
    "Texts that begin with = + - @ ' (or a tab, a line end, a full-width = + - @) have one ' more "
    "before them, so that spreadsheets do not read them as formulas. Numbers have none. Control "
    "characters are shown as their pictures (U+2400 and on)."
)
DICTIONARY = "datapackage.json"
#: Of the data package.
_NAME = "woz-sessions"


#: Texts that Excel takes for numbers, dates or truth values, and changes when it opens them.
_CHANGED = re.compile(
    r"0\d+|\d{16,}|\d+[eE]\d+|true|false"
    r"|(?:jan|feb|mar|mrz|apr|may|mai|jun|jul|aug|sep|oct|okt|nov|dec|dez)[a-z]{0,6}\d{1,4}"
    r"|\d{1,4}(?:jan|feb|mar|mrz|apr|may|mai|jun|jul|aug|sep|oct|okt|nov|dec|dez)",
    re.IGNORECASE,
)


class TableFiles:
    """Writes the tables of one session after the other; `finish` completes the files.

    Args:
        opened: Opens a new text file by its name, line ends as they are given.
        more: Tables besides `figure_tables`, whose rows are written with `write`.
        csv_format: How cells and numbers are written.
    """

    def __init__(
        self,
        opened: Callable[[str], TextIO],
        more: Sequence[TableDefinition[Any]] = (),
        csv_format: CsvFormat = PLAIN,
    ) -> None:
        self._opened = opened
        self._format = csv_format
        #: Codes that a spreadsheet changes, as far as they were told.
        self._changed: set[str] = set()
        self._tables = (*more, *figure_tables())
        self._files = ExitStack()
        made = (report.gathered() for report in pieces("report", FeatureReport).values())
        self._gathered = [each for each in made if each is not None]
        #: What is wrong with logs, by name.
        self._damage: dict[str, Sequence[str]] = {}
        self._writers = {table.name: self._begun(table) for table in self._tables}

    def _begun(self, table: TableDefinition[Any]) -> Writer:
        file = self._files.enter_context(self._opened(f"{table.name}.csv"))
        file.write(self._format.mark)
        writer = csv.writer(file, delimiter=self._format.delimiter, lineterminator="\r\n")
        writer.writerow([cell(column.name) for column in table.columns])
        return writer

    def add(self, figures: SessionFigures) -> list[str]:
        """Write all figures of one session; returns, in sentences, what a spreadsheet would change
        in them.
        """
        for table in figure_tables():
            self.write(table, figures, table.rows(figures))
        for each in self._gathered:
            each.add(figures)
        if figures.wholeness.sentences:
            self._damage[figures.stem] = figures.wholeness.sentences
        codes = {figures.session, figures.wizard, *figures.participants, *figures.conditions}
        changed = {code for code in codes if _CHANGED.fullmatch(code)} - self._changed
        self._changed |= changed
        if not changed:
            return []
        names = ", ".join(sorted(changed))
        return [f"a spreadsheet changes {names} when it opens a table: import the columns as text"]

    def write(
        self, table: TableDefinition[Any], figures: SessionFigures, rows: Iterable[object]
    ) -> None:
        """Write rows of one session to a table."""
        columns = [(column.cell, column.type) for column in table.columns]
        self._writers[table.name].writerows(
            [self._format.cell(of(figures, row), type_) for of, type_ in columns] for row in rows
        )

    def finish(self) -> None:
        """Write the tables of all sessions and the data dictionary, then close the files."""
        gathered = [found for each in self._gathered for found in each.tables()]
        for table, rows in gathered:
            writer = self._begun(table)
            for row in rows:
                writer.writerow(
                    self._format.cell(of.cell(_NONE, row), of.type) for of in table.columns
                )
        tables = (*self._tables, *(table for table, _ in gathered))
        package = _package(tables, self._damage, self._format)
        with self._opened(DICTIONARY) as file:
            file.write(json.dumps(package, indent=2, ensure_ascii=False) + "\n")
        self.close()

    def close(self) -> None:
        """Close the files; also after an error."""
        self._files.close()


#: Rows of tables of all sessions hold the codes of theirs themselves.
_NONE: Any = None


@contextmanager
def table_files(folder: Path, csv_format: CsvFormat = PLAIN) -> Iterator[TableFiles]:
    """Opens the tables in a folder that may exist already; files of these names are replaced.

    Raises:
        OSError: The folder cannot be made or a file not be written.
    """
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)

    def opened(name: str) -> TextIO:
        flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC
        taken = os.open(folder / name, flags, 0o600)
        os.fchmod(taken, 0o600)  # also where it was there
        return os.fdopen(taken, "w", encoding="utf-8", newline="")

    files = TableFiles(opened, csv_format=csv_format)
    try:
        yield files
        files.finish()
    finally:
        files.close()


def tables_listed(dictionary: str) -> list[str]:
    """The files that a data dictionary describes, itself included; none if it is another's."""
    try:
        package = msgspec.json.decode(dictionary, type=_Package)
    except msgspec.MsgspecError:
        return []
    if package.name != _NAME:
        return []
    return [DICTIONARY, *(resource.path for resource in package.resources)]


class _Resource(msgspec.Struct):
    path: str


class _Package(msgspec.Struct):
    name: str
    resources: list[_Resource]


def _package(
    tables: Iterable[TableDefinition[Any]],
    damage: Mapping[str, Sequence[str]],
    csv_format: CsvFormat,
) -> dict[str, Any]:
    """A Frictionless data package, https://specs.frictionlessdata.io/tabular-data-package/."""
    return {
        "name": _NAME,
        "profile": "tabular-data-package",
        "title": "Sessions of wizard-of-Oz experiments",
        "description": f"Written by woz-tui {__version__}. {GUARDED}",
        "resources": [_resource(table, csv_format) for table in tables],
        **({"damage": damage} if damage else {}),
    }


def _resource(table: TableDefinition[Any], csv_format: CsvFormat) -> dict[str, Any]:
    schema: dict[str, Any] = {
        "fields": [
            {
                "name": column.name,
                "type": column.type,
                "description": column.meaning,
                **({"unit": column.unit} if column.unit else {}),
                **column.more,
                **(
                    {"decimalChar": csv_format.decimal}
                    if column.type == "number" and csv_format.decimal != "."
                    else {}
                ),
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
        "encoding": "utf-8-sig" if csv_format.mark else "utf-8",
        "dialect": {
            "delimiter": csv_format.delimiter,
            "quoteChar": '"',
            "doubleQuote": True,
            "header": True,
        },
        "schema": schema,
    }
