"""What a robot feels, in words."""

from __future__ import annotations

import pytest

from woz_tui.sensing.sample_values import state_word


@pytest.mark.parametrize(
    ("sensor", "value", "word"),
    [
        ("bumper.left", 1.0, "pressed"),
        ("left.bumper.back", 0.0, "free"),
        ("touch.head.front", 1.0, "touched"),
        ("fallen", 1.0, "yes"),
        ("touch.x", 0.0, ""),
        ("touch.y", 1.0, ""),
        ("bumper.left", 0.5, ""),
        ("distance", 1.0, ""),
    ],
)
def test_two_states_have_words_and_places_have_none(sensor: str, value: float, word: str) -> None:
    assert state_word(sensor, value) == word
