"""The section `design`: what can be said, and what becomes of it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.catalogue import CATALOGUE
from tests.config.reading import HEAD, HELLO, panel, read_experiment
from woz_tui.config.experiment import Experiment
from woz_tui.config.loading import load
from woz_tui.features.study.design import Design
from woz_tui.features.study.section import DESIGN

GOOD = Path(__file__).parents[2] / "config" / "good"


@pytest.fixture(scope="module")
def whole() -> Experiment:
    return load(GOOD / "study.yaml", CATALOGUE)


def test_the_design(whole: Experiment) -> None:
    assert DESIGN.of(whole) == Design(
        order="latin-square",
        within=True,
        trials=2,
        seed=7,
        blind={"warm": "Lemon", "cold": "Orange", "none": "No"},
    )
    assert whole.warnings == ()


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
    design = DESIGN.of(read_experiment(tmp_path, text))
    assert design is not None
    assert (design.order, design.within) == (order, within)


def test_a_design_of_trials_alone_needs_no_condition(tmp_path: Path) -> None:
    text = panel(HELLO, head=f"{HEAD}design: {{order: fixed, trials: 3}}\n")
    assert DESIGN.of(read_experiment(tmp_path, text)) == Design(order="fixed", trials=3)


def labels(folder: Path, design: str) -> dict[str, str]:
    head = f"{HEAD}conditions: [warm, cold, none, both]\ndesign: {design}\n"
    found = DESIGN.of(read_experiment(folder, panel(HELLO, head=head)))
    assert found is not None
    return dict(found.blind)


def test_blind_makes_letters_that_do_not_tell_the_order(tmp_path: Path) -> None:
    given = [labels(tmp_path, f"{{blind: true, seed: {seed}}}") for seed in range(12)]
    assert all(sorted(each.values()) == ["A", "B", "C", "D"] for each in given)
    assert all(list(each) == ["warm", "cold", "none", "both"] for each in given)
    assert len({tuple(each.values()) for each in given}) > 6
    assert labels(tmp_path, "{blind: true, seed: 3}") == given[3]
    assert labels(tmp_path, "{blind: no}") == {}
