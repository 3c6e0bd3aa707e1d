"""The joint filter taken up while somebody is engaged: they are not taken for a phantom."""

from __future__ import annotations

import random

import pytest

from tests.sensing.visitor_samples import GONE, WITH, Visit
from woz_tui.config.engagement_words import SIGNS
from woz_tui.sensing import engagement_commands
from woz_tui.sensing.joint_filter import RECENT, JointFilter
from woz_tui.sensing.state_machine import State

ALL = {"sign": "all", "kind": "joint"}


@pytest.mark.parametrize(
    "gaze", ["11111111", "11011111", "10110111", "00001111", "11111110", "11111100", "11111000"]
)
def test_a_visitor_who_is_engaged_stays_so(gaze: str) -> None:
    """E2: no sign falls, not even between one sign and the next."""
    visit = Visit(quick=False)
    visit.see(20, **WITH, identity="Anna")
    for looks in gaze:
        visit.see(**{**WITH, "gaze": int(looks)}, identity="Anna")
    assert visit.model.state is State.KNOWN
    for sign in SIGNS:
        visit.model.configure(sign, kind="joint")
        assert visit.model.engaged, f"{sign} has come over"
        assert visit.model.verdicts["identity"] == "Anna"
    assert engagement_commands.apply_command(visit.model, "filter", ALL) is None
    assert visit.see(9, **WITH, identity="Anna") == []


def test_whoever_is_not_there_is_not_made_up() -> None:
    visit = Visit(quick=False)
    visit.see(20, **WITH, identity="Anna")
    visit.see(12, **GONE, identity="Unknown")
    assert visit.model.state is State.WAIT
    assert engagement_commands.apply_command(visit.model, "filter", ALL) is None
    assert visit.model.verdicts == {**dict.fromkeys(GONE, 0), "identity": "Unknown"}


def test_signs_that_come_over_know_what_they_would_have_known() -> None:
    """As if they had been filtered jointly all the while, but for what is too long ago."""
    chance = random.Random(1)
    early, late = Visit(quick=False, filter="joint"), Visit(quick=False)
    for _ in range(RECENT):
        row = {sign: chance.choice((WITH, GONE))[sign] for sign in WITH}
        for visit in (early, late):
            visit.see(**row, identity="Anna")
    engagement_commands.apply_command(late.model, "filter", ALL)
    assert late.model.shown().signs == early.model.shown().signs


def test_a_sign_that_leaves_has_no_part_any_more() -> None:
    joint = JointFilter(1.3)
    for t in range(0, 3_000_000, 333_333):
        for sign, value in WITH.items():
            joint.add(sign, float(value), t)
    for sign in WITH:
        assert joint.view(sign).verdict == 1
        joint.view(sign).leave()
        assert joint.view(sign).verdict == 0
    assert joint.probability("presence") < 0.5
    joint.view("gaze").catch_up()
    assert (joint.view("gaze").verdict, joint.view("presence").verdict) == (1, 0)


def test_what_is_stale_is_not_caught_up_with() -> None:
    visit = Visit(quick=False)
    visit.see(20, **WITH, identity="Anna")
    visit.see(6)
    assert visit.model.signs.stale == list(SIGNS)
    engagement_commands.apply_command(visit.model, "filter", ALL)
    assert visit.model.verdicts == {**dict.fromkeys(GONE, 0), "identity": "Unknown"}
    visit.see(2, **WITH, identity="Bert")
    assert visit.model.verdicts["identity"] == "Bert"
