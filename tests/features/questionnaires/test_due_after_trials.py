"""What is due behind a trial."""

from __future__ import annotations

import pytest

from woz_tui.features.questionnaires.due import due_after_trial

#: Two trials in each of two conditions.
CASES = [
    (1, "done", ("trial",)),
    (1, "aborted", ()),
    (1, "excluded", ()),
    (2, "done", ("trial", "condition")),
    (2, "aborted", ()),
    (2, "excluded", ("condition",)),
    (4, "done", ("trial", "condition", "end")),
    (4, "aborted", ()),
    (4, "excluded", ("condition", "end")),
    (0, "done", ("trial",)),
    (0, "excluded", ()),
]


@pytest.mark.parametrize(("trial", "outcome", "due"), CASES)
def test_behind_a_trial_of_four(trial: int, outcome: str, due: tuple[str, ...]) -> None:
    assert due_after_trial(trial, outcome, trials=2, planned=4) == due


def test_without_a_design_only_what_belongs_to_each_trial_is_due() -> None:
    assert due_after_trial(4, "done", trials=0, planned=0) == ("trial",)


def test_without_an_order_nobody_knows_which_trial_is_the_last() -> None:
    assert due_after_trial(4, "done", trials=2, planned=0) == ("trial", "condition")
