"""`until: arrived` in a file: what it means, and where it means nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.reading import ROBOT, errors, only, panel, read_experiment
from woz_tui.config.experiment import ParallelCalls
from woz_tui.config.reload_changes import compare

POSE = "pose: {joints: {pan: 20}, seconds: 2}"


def untils(folder: Path, action: str) -> list[list[str]]:
    """What each call of each step waits for."""
    steps = only(folder, action, head=ROBOT).steps
    return [
        [call.until for call in step.calls] for step in steps if isinstance(step, ParallelCalls)
    ]


@pytest.mark.parametrize(
    ("action", "found"),
    [
        (f"{{key: a, label: A, {POSE}, until: arrived}}", [["arrived"]]),
        (f"{{key: a, label: A, {POSE}}}", [[""]]),
        (f"{{key: a, label: A, say: Hi, {POSE}, until: arrived}}", [["", "arrived"]]),
        (
            f"{{key: a, label: A, steps: [{{{POSE}, until: arrived}}, {{say: Hi}}]}}",
            [["arrived"], [""]],
        ),
    ],
)
def test_a_step_waits_for_its_motions(tmp_path: Path, action: str, found: list[list[str]]) -> None:
    assert untils(tmp_path, action) == found


def test_a_reload_finds_an_until_that_came_or_went(tmp_path: Path) -> None:
    plain, waits = (
        read_experiment(tmp_path, panel(f"{{key: a, label: A, {POSE}{until}}}", head=ROBOT))
        for until in ("", ", until: arrived")
    )
    changed = ("action 'A': does something else",)
    assert compare(plain, waits).changes == compare(waits, plain).changes == changed


@pytest.mark.parametrize(
    ("action", "problem"),
    [
        ("{key: a, label: A, say: Hi, until: arrived}", "voice's say does not tell"),
        (f"{{key: a, label: A, {POSE}, until: there}}", "arrived"),
        (f"{{key: a, label: A, steps: [{{{POSE}, until: there}}]}}", "arrived"),
        (f"{{key: a, label: A, until: arrived, steps: [{{{POSE}}}]}}", "next to steps"),
    ],
)
def test_an_until_that_means_nothing_is_an_error(tmp_path: Path, action: str, problem: str) -> None:
    [error] = errors(tmp_path, panel(action, head=ROBOT))
    assert problem in error
    assert "until" in error
