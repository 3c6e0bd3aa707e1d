"""The key `script` of an experiment file."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.reading import errors, panel, read_experiment
from woz_tui.config.reload_changes import compare
from woz_tui.config.robot_fit import fitted
from woz_tui.features.scripts.section import SCRIPT

TEXT = panel("{label: A, say: Hi}", "{label: B, say: Ho}", "{label: C, say: Ha, locked: on}")


def test_its_lines_are_names_of_actions(tmp_path: Path) -> None:
    assert SCRIPT.of(read_experiment(tmp_path, TEXT)) == ()
    assert SCRIPT.of(read_experiment(tmp_path, f"{TEXT}script: [B, A, B]\n")) == ("B", "A", "B")
    (wrong,) = errors(tmp_path, f"{TEXT}script: [A, D]\n")
    assert wrong.endswith("script[1]: there is no action 'D'; actions are: A, B, C")
    warned = read_experiment(tmp_path, f"{TEXT}script: [C]\n").warnings
    assert [each.message for each in warned] == ["'C' is locked and cannot be played"]


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("[B, A]", ("script changed",)),
        ("[A]", ("script has 1 lines, it had 2",)),
        ("[A, B]", ()),
    ],
)
def test_what_a_reading_changed(tmp_path: Path, lines: str, said: tuple[str, ...]) -> None:
    old = read_experiment(tmp_path, f"{TEXT}script: [A, B]\n")
    new = read_experiment(tmp_path, f"{TEXT}script: {lines}\n")
    assert compare(old, new).changes == said


def test_a_demo_leaves_out_lines_that_its_robot_cannot_play(tmp_path: Path) -> None:
    text = panel("{label: A, say: Hi}", "{label: B, drive: 1}", head="title: T\nrobot: simulated\n")
    made = read_experiment(tmp_path, f"{text}script: [A, B, A]\n")
    assert SCRIPT.of(fitted(made)) == ("A", "B", "A")
    assert SCRIPT.fitted(("A", "B", "A"), {"A"}) == ("A", "A")
