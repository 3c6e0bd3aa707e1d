"""Whose face it is, as the joint filter sees it."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.sensing.test_joint_filter import ENGAGED, NOBODY, Robot
from woz_tui.sensing.joint_filter import MOST, NameBelief
from woz_tui.sensing.sample_values import UNKNOWN

PERIOD = 333_333


def named(story: list[str], threshold: float = 0.5) -> list[str]:
    """What is believed after each recognition."""
    names = NameBelief()
    found = []
    for seen in story:
        names.passed(PERIOD)
        names.add(seen)
        names.judge(threshold)
        found.append(names.accepted)
    return found


def test_two_recognitions_name_a_visitor_and_one_does_not() -> None:
    assert named(["Ada", "Ada", "Ada"]) == [UNKNOWN, "Ada", "Ada"]
    assert named([UNKNOWN] * 9) == [UNKNOWN] * 9


def test_lapses_and_mistakes_leave_the_name() -> None:
    known = ["Ada"] * 6
    assert set(named([*known, *[UNKNOWN] * 6])[6:]) == {"Ada"}
    assert set(named([*known, "Bea", "Ada", "Bea", "Bea", "Ada"])[6:]) == {"Ada"}


def test_somebody_else_is_believed_in_the_end() -> None:
    found = named([*["Ada"] * 6, *["Bea"] * 9])
    assert found[-1] == "Bea"
    turned = found.index("Bea")
    assert turned - 6 < 9
    assert set(found[turned:]) == {"Bea"}
    assert named(["Ada"] * 6 + [UNKNOWN] * 60)[-1] == UNKNOWN


def test_alternating_names_do_not_flicker() -> None:
    found = named([*["Ada"] * 3, *["Bea", "Ada"] * 20])
    assert "Bea" not in found
    assert sum(one != other for one, other in itertools.pairwise(found[3:])) <= 1


@given(st.lists(st.sampled_from(["Ada", "Bea", "Cyd", UNKNOWN]), max_size=40))
def test_names_are_only_labels(story: list[str]) -> None:
    """With the names swapped, the verdicts are swapped."""
    swap = {"Ada": "Cyd", "Cyd": "Bea", "Bea": "Ada", UNKNOWN: UNKNOWN}
    assert named([swap[seen] for seen in story], 0.6) == [swap[name] for name in named(story, 0.6)]


@given(st.lists(st.text(max_size=3), max_size=80), st.integers(0, 10**10))
def test_only_so_many_names_are_held(story: list[str], pause: int) -> None:
    names = NameBelief()
    for seen in story:
        names.add(seen)
        names.passed(pause)
        names.judge(0.5)
        assert 0.0 <= names.share <= 1.0
        assert len(names) <= MOST


def test_whoever_is_lost_takes_the_name_along() -> None:
    robot = Robot().see(ENGAGED, 9)
    view = robot.joint.view("identity")
    assert (view.verdict, view.name) == (1, "Ada")
    robot.see(NOBODY, 2)
    assert (view.verdict, view.name) == (0, UNKNOWN)
    robot.see((1.0, 1.0, 0.9, "Bea"), 2)
    assert (view.verdict, view.name) == (1, "Bea")


@pytest.mark.parametrize("threshold", [0.0, 0.5])
def test_nobody_becomes_a_name(threshold: float) -> None:
    robot = Robot(threshold=threshold).see((1.0, 1.0, 0.9, UNKNOWN), 9)
    assert robot.joint.view("identity").verdict == 0
