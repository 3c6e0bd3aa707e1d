"""The guide says what the code does."""

from __future__ import annotations

from pathlib import Path

from woz_tui.export.guide import renewed

GUIDE = Path(__file__).parents[2] / "docs" / "export.md"


def test_the_tables_of_the_guide_are_fresh() -> None:
    page = GUIDE.read_text(encoding="utf-8")
    assert renewed(page) == page, "python -m woz_tui.export.guide docs/export.md"
