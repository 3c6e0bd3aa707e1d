"""Variables and braces in utterances."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.config.utterance_template import fill, names


@pytest.mark.parametrize(
    ("text", "filled"),
    [
        ("Hello {name}!", "Hello <name>!"),
        ("{{name}} is {name}", "{name} is <name>"),
        ("{{{name}}}", "{<name>}"),
        ("a } and a {", "a } and a {"),
        ("{not a name} {}", "{not a name} {}"),
    ],
)
def test_variables_are_filled_in_and_doubled_braces_are_braces(text: str, filled: str) -> None:
    assert fill(text, lambda name: f"<{name}>") == filled


@given(st.text())
def test_any_text_doubled_is_itself(text: str) -> None:
    doubled = text.replace("{", "{{").replace("}", "}}")
    assert fill(doubled, lambda name: f"<{name}>") == text


@given(st.text("{}ab\n 1"))
def test_it_asks_for_the_names_that_the_check_knows(text: str) -> None:
    asked: list[str] = []

    def value_of(name: str) -> str:
        asked.append(name)
        return ""

    fill(text, value_of)
    assert asked == names(text)
