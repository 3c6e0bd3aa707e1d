"""The reference page of the experiment file says what the code says, in full."""

from __future__ import annotations

import pytest

from tools.experiment_reference import page
from woz_tui.config.experiment_file import TOP_LEVEL

ROWS = [
    line[2:-2].split(" | ")
    for line in page().splitlines()
    if line.startswith("| `") and line.count(" | ") == 4
]


@pytest.mark.parametrize("key", TOP_LEVEL)
def test_every_key_of_a_file_has_its_row(key: str) -> None:
    assert [row for row in ROWS if row[0] == f"`{key}`"]


def test_every_row_has_a_type_an_example_and_a_sentence() -> None:
    assert not [row[0] for row in ROWS if not (row[1] and row[3].strip("` ") and row[4])]
