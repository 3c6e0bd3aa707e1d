"""The sections about the study: what can be said, and what becomes of it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.catalogue import CATALOGUE
from tests.config.reading import HEAD, HELLO, errors, panel, read_experiment
from woz_tui.config.experiment import Experiment
from woz_tui.config.loading import load
from woz_tui.config.study import (
    PerceptionLimits,
    Study,
)

GOOD = Path(__file__).parent / "good"


@pytest.fixture(scope="module")
def whole() -> Experiment:
    return load(GOOD / "study.yaml", CATALOGUE)


def warnings(folder: Path, section: str, head: str = HEAD) -> list[str]:
    text = panel(HELLO, "{key: l, label: Locked, say: Hi, locked: on}", head=f"{head}{section}\n")
    return [f"{one.path}: {one.message}" for one in read_experiment(folder, text).warnings]


def test_a_file_without_these_sections_has_an_empty_study(tmp_path: Path) -> None:
    assert read_experiment(tmp_path, panel(HELLO)).study == Study()


def test_preflight_and_perception(whole: Experiment) -> None:
    assert whole.study.preflight == ("The camera sees the whole table", "No")
    assert whole.study.perception == PerceptionLimits(("distance", "face"), ("transcript",))


def test_variables_by_condition(whole: Experiment) -> None:
    assert whole.variables == {"place": "museum"}
    assert whole.by_condition == {
        "greeting": {"warm": "Hello {participant}, in the {place}!", "cold": "Hello.", "none": "No"}
    }


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ("perception: {hide: [distance], blur: [distance]}", "perception.blur[0]: is hidden"),
    ],
)
def test_what_is_odd_is_said(tmp_path: Path, section: str, said: str) -> None:
    (warning,) = warnings(tmp_path, section)
    assert warning.startswith(said)


def test_what_answers_a_cue_is_verbs_and_panels(tmp_path: Path) -> None:
    def answers(section: str) -> object:
        return read_experiment(
            tmp_path, panel(HELLO, head=f"{HEAD}answers: {section}\n")
        ).study.answers

    some = {"speech": ("say",), "marker": ("emotion", "P")}
    assert answers("{speech: say, marker: [emotion, P]}") == some
    assert answers("[say, P]") == dict.fromkeys(("speech", "engagement", "marker"), ("say", "P"))


def test_what_cannot_answer_is_named_with_its_place(tmp_path: Path) -> None:
    found = errors(tmp_path, panel(HELLO, head=f"{HEAD}answers: {{speach: say, marker: [sya]}}\n"))
    assert [each.split(": ", 1)[1].split(";")[0] for each in found] == [
        "answers.speach: unknown",
        "answers.marker[0]: 'sya' is neither a verb nor a panel",
    ]
    assert "say" in found[1]
