"""The section `questionnaires` of an experiment file."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.catalogue import CATALOGUE
from tests.config.reading import HEAD, HELLO, panel, read_experiment
from woz_tui.config.loading import load
from woz_tui.features.questionnaires.section import NAME_PATTERN, QUESTIONNAIRES, name_from_text
from woz_tui.protocol.welcome import Questionnaire, QuestionnaireItem

GOOD = Path(__file__).parents[2] / "config" / "good"


def test_questionnaires_and_their_items() -> None:
    ends = ("not at all", "very much")
    first, again, short = QUESTIONNAIRES.of(load(GOOD / "study.yaml", CATALOGUE)).questionnaires
    assert first == Questionnaire(
        "robot-ux",
        "How was the robot?",
        items=(
            QuestionnaireItem("pleasant", "How pleasant was it?", 0, 4, ends),
            QuestionnaireItem("the-robot-understood-me", "The robot understood me.", 0, 4, ends),
            QuestionnaireItem("off-or-on", "Off or on?", -3, 3, ("No", "On"), optional=True),
            QuestionnaireItem("else", "Anything else?", 0, 4, ends, text=True, optional=True),
        ),
        when="condition",
        introduction="Please answer quickly.",
    )
    assert (again.name, again.when, again.items) == (
        "again",
        "hand",
        (QuestionnaireItem("well", "Well"),),
    )
    assert (short.name, short.title, short.when) == ("short", "short", "end")


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("How was it?", "how-was-it"),
        ("Was it good - or bad", "was-it-good-or-bad"),
        ("2 robots", "robots"),
        ("???", ""),
        ("Żółć", ""),
        ("x" * 41, ""),
        ("one two three four five six seven eight nine", "one-two-three-four-five-six-seven-eight"),
    ],
)
def test_a_name_made_of_a_question(text: str, code: str) -> None:
    assert name_from_text(text) == code
    assert not code or NAME_PATTERN.fullmatch(code)


def test_the_end_of_a_condition_needs_a_design(tmp_path: Path) -> None:
    head = f"{HEAD}questionnaires: [{{name: a, when: condition, items: [b]}}]\n"
    (warning,) = read_experiment(tmp_path, panel(HELLO, head=head)).warnings
    assert (warning.path, warning.message.split(";")[0]) == (
        "questionnaires[0].when",
        "without a design, the last trial of a condition is unknown",
    )
