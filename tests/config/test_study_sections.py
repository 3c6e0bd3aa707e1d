"""The sections about the study: what can be said, and what becomes of it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.catalogue import CATALOGUE
from tests.config.reading import HEAD, HELLO, errors, panel, read_experiment
from woz_tui.config.experiment import Experiment
from woz_tui.config.loading import load
from woz_tui.config.study import (
    Design,
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


def test_the_design(whole: Experiment) -> None:
    assert whole.study.design == Design(
        order="latin-square",
        within=True,
        trials=2,
        seed=7,
        blind={"warm": "Lemon", "cold": "Orange", "none": "No"},
    )
    assert whole.warnings == ()


def test_preflight_and_perception(whole: Experiment) -> None:
    assert whole.study.preflight == ("The camera sees the whole table", "No")
    assert whole.study.perception == PerceptionLimits(("distance", "face"), ("transcript",))


def test_variables_by_condition(whole: Experiment) -> None:
    assert whole.variables == {"place": "museum"}
    assert whole.by_condition == {
        "greeting": {"warm": "Hello {participant}, in the {place}!", "cold": "Hello.", "none": "No"}
    }


@pytest.mark.parametrize(
    ("section", "order", "within"),
    [
        ("{}", "latin-square", True),
        ("{within: no}", "blocks", False),
        ("{within: no, order: fixed}", "fixed", False),
        ("{order: blocks, block: 4}", "blocks", True),
    ],
)
def test_who_gets_one_condition_gets_it_from_a_block(
    tmp_path: Path, section: str, order: str, within: bool
) -> None:
    text = panel(HELLO, head=f"{HEAD}conditions: [warm, cold]\ndesign: {section}\n")
    design = read_experiment(tmp_path, text).study.design
    assert design is not None
    assert (design.order, design.within) == (order, within)


def test_a_design_of_trials_alone_needs_no_condition(tmp_path: Path) -> None:
    text = panel(HELLO, head=f"{HEAD}design: {{order: fixed, trials: 3}}\n")
    assert read_experiment(tmp_path, text).study.design == Design(order="fixed", trials=3)


def labels(folder: Path, design: str) -> dict[str, str]:
    head = f"{HEAD}conditions: [warm, cold, none, both]\ndesign: {design}\n"
    found = read_experiment(folder, panel(HELLO, head=head)).study.design
    assert found is not None
    return dict(found.blind)


def test_blind_makes_letters_that_do_not_tell_the_order(tmp_path: Path) -> None:
    given = [labels(tmp_path, f"{{blind: true, seed: {seed}}}") for seed in range(12)]
    assert all(sorted(each.values()) == ["A", "B", "C", "D"] for each in given)
    assert all(list(each) == ["warm", "cold", "none", "both"] for each in given)
    assert len({tuple(each.values()) for each in given}) > 6
    assert labels(tmp_path, "{blind: true, seed: 3}") == given[3]
    assert labels(tmp_path, "{blind: no}") == {}


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
