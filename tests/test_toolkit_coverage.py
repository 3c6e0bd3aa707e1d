"""Every acceptance statement of the body has a test, and the page that says so is fresh."""

from __future__ import annotations

from pathlib import Path

import pytest

from tools import marked_tests as marked
from tools import toolkit_coverage as coverage


def test_every_statement_is_shown_by_a_test() -> None:
    assert coverage.uncovered() == []


def test_marks_name_statements_that_there_are() -> None:
    named = {shown.statement for shown in marked.found("toolkit")}
    assert named <= set(coverage.STATEMENTS)
    assert len(named) > 50


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('@pytest.mark.toolkit("R1", "R2")\ndef test_a() -> None: ...', {"R1", "R2"}),
        ('pytestmark = [pytest.mark.toolkit("V1")]\nasync def test_a() -> None: ...', {"V1"}),
        (
            '@pytest.mark.parametrize("x", [pytest.param(1, marks=pytest.mark.toolkit("K1"))])\n'
            "def test_a(x) -> None: ...",
            {"K1"},
        ),
        (
            '@pytest.mark.toolkit("U1")\nclass TestIt:\n    def test_a(self) -> None: ...',
            {"U1"},
        ),
        ('@pytest.mark.toolkit("R1")\ndef helper() -> None: ...', set()),
        ("def test_a() -> None: ...", set()),
    ],
)
def test_marks_are_found_wherever_they_stand(tmp_path: Path, text: str, expected: set[str]) -> None:
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_it.py").write_text(f"import pytest\n\n{text}\n", encoding="utf-8")
    assert {shown.statement for shown in marked.found("toolkit", tmp_path)} == expected
