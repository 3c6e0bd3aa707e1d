"""What is shown to a person of the pattern that codes must match."""

from __future__ import annotations

import pytest

from woz_tui.config.participant_pattern import describe_pattern, example, matches


@pytest.mark.parametrize(
    "pattern", [r"P\d\d", r"P\d{3}", r"VP-?\d{2,3}", r"\d+", "[A-Za-z0-9]{1,16}", r"S[0-9]{2}[mf]"]
)
def test_a_pattern_is_shown_as_a_code_that_matches(pattern: str) -> None:
    assert matches(pattern, example(pattern))
    assert describe_pattern(pattern).endswith(f" {example(pattern)}")


@pytest.mark.parametrize("pattern", [r"(?:A|B)\d\d", r"(?!P)[^0-9]{2}"])
def test_a_pattern_without_a_simple_example_is_shown_itself(pattern: str) -> None:
    assert example(pattern) == ""
    assert pattern in describe_pattern(pattern)
