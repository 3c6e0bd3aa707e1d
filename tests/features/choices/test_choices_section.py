"""Choices in an experiment file."""

from __future__ import annotations

from pathlib import Path

from tests.config.reading import errors, panel, read_experiment
from woz_tui.config.reload_changes import compare
from woz_tui.features.choices.section import CHOICES, Option

ASK = "{label: Ask, choice: colour}"
RED = "{label: Red it is, say: Red!}"
COLOUR = """choices:
  - name: colour
    question: Which colour?
    options: [{text: Red, plays: Red it is}, {text: Blue}]
"""


def test_choices_of_a_file(tmp_path: Path) -> None:
    made = read_experiment(tmp_path, panel(ASK, RED) + COLOUR)
    [choice] = CHOICES.of(made)
    assert (choice.name, choice.question) == ("colour", "Which colour?")
    assert choice.options == (Option("Red", plays="Red it is"), Option("Blue"))
    assert [*CHOICES.summary(made)] == [("choice colour", "'Red' (plays 'Red it is'), 'Blue'")]
    other = read_experiment(tmp_path, panel(ASK, RED) + COLOUR.replace("Blue", "Green"))
    assert compare(made, other).changes == ("choice 'colour' changed",)


def test_what_is_wrong_is_told_with_its_place(tmp_path: Path) -> None:
    (tmp_path / "film.mp4").write_bytes(b"\0" * 64)
    for old, new, told in (
        ("plays: Red it is", "plays: Red it was", "there is no action 'Red it was'"),
        ("text: Blue", "text: Red", "'Red'"),
        ("text: Blue", "text: ''", "is empty"),
        ("{text: Blue}", "{text: Blue, picture: film.mp4}", "film.mp4 is no picture for a browser"),
        ("name: colour", "name: 'off'", "off takes a choice away"),
        ("name: colour", "name: color", "there is no choice 'colour'; did you mean 'color'?"),
        ("[{text: Red, plays: Red it is}, {text: Blue}]", "[]", "options"),
    ):
        text = panel(ASK, RED) + COLOUR.replace(old, new)
        assert any(told in each for each in errors(tmp_path, text)), (told, errors(tmp_path, text))
    [wrong] = errors(tmp_path, panel(ASK))
    assert "there is no choice 'colour'" in wrong
    many = ", ".join(f"{{text: o{number}}}" for number in range(13))
    text = panel(ASK) + f"choices: [{{name: colour, options: [{many}]}}]\n"
    assert any("has 13; 12 are the most" in each for each in errors(tmp_path, text))
