"""The guide says what the code does."""

from __future__ import annotations

from pathlib import Path

from tools.redaction_lists import renewed

GUIDE = Path(__file__).parents[2] / "docs" / "how-to" / "export.md"


def test_the_tables_of_the_guide_are_fresh() -> None:
    page = GUIDE.read_text(encoding="utf-8")
    assert renewed(page) == page, "python -m tools.redaction_lists docs/how-to/export.md"
