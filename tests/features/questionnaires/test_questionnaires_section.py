"""The section `questionnaires` of an experiment file."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.catalogue import CATALOGUE
from tests.config.reading import HEAD, HELLO, panel, read_experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.features.questionnaires.item_entries import NAME_PATTERN, name_from_text
from woz_tui.features.questionnaires.items import in_language, value_labels, wording
from woz_tui.features.questionnaires.section import QUESTIONNAIRES
from woz_tui.protocol.welcome import ItemCondition, Questionnaire, QuestionnaireItem

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


def test_every_kind_of_item() -> None:
    (asked,) = QUESTIONNAIRES.of(load(GOOD / "questionnaire-items.yaml", CATALOGUE)).questionnaires
    assert (asked.when, asked.shuffled, asked.language) == ("start", True, "en")
    items = {item.name: item for item in asked.items}
    assert {name: item.asks for name, item in items.items()} == {
        **{"page-1": "page", "natural": "scale", "effort": "slider", "often": "scale"},
        **{"marked": "scale", "known": "choice", "which": "choices", "age": "number"},
        **{"since": "month", "words": "text", "hard": "slider", "why": "text"},
    }
    natural = items["natural"]
    assert (natural.low, natural.high, natural.shift, natural.ends) == (
        -3,
        3,
        4,
        ("fake", "natural"),
    )
    assert wording(natural) == "The robot was fake - natural"
    assert (natural.numbers, natural.soft, natural.flip, natural.reverse) == (
        True,
        True,
        True,
        True,
    )
    assert (items["effort"].step, items["effort"].soft) == (5, False)
    assert value_labels(items["often"]) == {1: "never", 2: "seldom", 3: "often"}
    assert not items["often"].numbers
    assert value_labels(items["marked"]) == {0: "not at all", 2: "half", 4: "quite"}
    assert value_labels(items["which"]) == {1: "a vacuum cleaner", 5: "a toy", 6: "other"}
    assert items["which"].only_if == ItemCondition("known", (1, 3))
    assert items["why"].only_if == ItemCondition("hard", at_least=60)
    assert (items["words"].private, items["words"].lines) == (True, 3)


def test_a_questionnaire_in_two_languages() -> None:
    (asked,) = QUESTIONNAIRES.of(load(GOOD / "questionnaire-items.yaml", CATALOGUE)).questionnaires
    german = in_language(asked, "de")
    assert (asked.title, german.title) == ("How was the robot?", "Wie war der Roboter?")
    assert wording(german.items[1]) == "Der Roboter war fake - natürlich"
    assert german.items[8] == asked.items[8]  # a text without languages is the same in all
    assert in_language(asked, "fr") is asked


def test_a_slip_in_one_key_is_one_error_that_names_all_keys(tmp_path: Path) -> None:
    """The last of them is `if`, which people look for; and no weights are wrong for a `how` that
    means nothing.
    """
    head = f"""{HEAD}questionnaires:
  - name: a
    items:
      - {{name: x, question: X?, wenn: 3}}
      - {{name: y, question: Y?, choices: {{1: x, 2: y}}}}
      - {{name: z, question: Z?}}
    scores: {{all: {{items: [x, z], how: wieghted, pairs: [y]}}}}
"""
    with pytest.raises(ExperimentError) as raised:
        read_experiment(tmp_path, panel(HELLO, head=head))
    keys, how = [problem.message for problem in raised.value.problems]
    assert keys.startswith("unknown; an item has: question, ")
    assert keys.endswith(", prefer_not, if")
    assert how == "'wieghted' is not known; did you mean 'weighted'?"


def test_a_stem_of_its_own_begins_an_item_of_any_kind(tmp_path: Path) -> None:
    """That of the questionnaire begins scales alone: others are questions by themselves."""
    head = f"""{HEAD}questionnaires:
  - name: a
    stem: The robot was
    items:
      - {{name: kind, question: kind}}
      - {{name: hard, question: How hard was it?, slider: {{}}}}
      - {{name: warm, stem: I felt, between: [cold, warm], slider: {{}}}}
      - {{name: mood, stem: I was, question: "...", choices: [glad, sad]}}
"""
    [asked] = QUESTIONNAIRES.of(read_experiment(tmp_path, panel(HELLO, head=head))).questionnaires
    assert [wording(item) for item in asked.items] == [
        *("The robot was kind", "How hard was it?", "I felt cold - warm", "I was ..."),
    ]
    page = head.replace("{name: kind, question: kind}", "{page: Read on., stem: Please}")
    with pytest.raises(ExperimentError, match="an instruction has no 'stem'"):
        read_experiment(tmp_path, panel(HELLO, head=page))
