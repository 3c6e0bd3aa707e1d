"""How cells and numbers are written, so that a spreadsheet in some language opens a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from woz_tui.system.text_cleaning import cell

if TYPE_CHECKING:
    from woz_tui.analysis.tables import Cell

#: The same few texts come again and again.
_cell = lru_cache(maxsize=4096, typed=True)(cell)


@dataclass(frozen=True, slots=True)
class CsvFormat:
    """What stands between cells and in numbers; `mark`: before the first byte, by which a
    spreadsheet knows UTF-8.
    """

    delimiter: str = ","
    decimal: str = "."
    mark: str = ""

    def cell(self, value: Cell, type_: str) -> str:
        """A value as it stands in a column of this type: only numbers have a decimal comma, a time
        of day has none.
        """
        written = _cell(value, text=type_ == "string")
        if self.decimal == "." or not (type_ == "number" or isinstance(value, float)):
            return written
        return written.replace(".", self.decimal)


PLAIN = CsvFormat()
_POINT, _COMMA = CsvFormat(mark="\ufeff"), CsvFormat(";", ",", "\ufeff")
#: The language of a spreadsheet -> what it opens by a double click.
SPREADSHEETS: Mapping[str, CsvFormat] = {
    **dict.fromkeys(("de", "es", "fr", "it", "nl", "sv"), _COMMA),
    **dict.fromkeys(("en", "ja"), _POINT),
}
