"""Brackets in a file that do not belong together."""

from __future__ import annotations

import pytest
import yaml

from woz_tui.config.yaml_nodes import explain_yaml_error


@pytest.mark.parametrize(
    ("text", "place", "word"),
    [
        ("a:\n  - {b: 1}\n  - {c: 2}}\n", (3, 11), "one } too many"),
        ("a: [1]]\nb: 2\n", (1, 7), "one ] too many"),
        ("a: [1}\n", (1, 6), "closing ] is missing"),
    ],
)
def test_a_bracket_too_many_is_called_so(text: str, place: tuple[int, int], word: str) -> None:
    with pytest.raises(yaml.YAMLError) as raised:
        yaml.load(text, Loader=yaml.CSafeLoader)
    line, column, why = explain_yaml_error(raised.value, text)
    assert (line, column) == place
    assert word in why
    assert "indentation" not in why
