"""Every call and every key of the parity tables has a test, and the page that says so is fresh."""

from __future__ import annotations

import pytest

from tools import pepper_coverage as coverage

BOTH = pytest.mark.parametrize("table", coverage.TABLES)


@BOTH
def test_every_row_is_shown_by_a_test(table: str) -> None:
    assert coverage.uncovered(table) == []


@BOTH
def test_marks_name_rows_that_there_are(table: str) -> None:
    assert coverage.unknown(table) == []
