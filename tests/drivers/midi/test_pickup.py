"""Soft take-over."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.midi.panel_maps import ControlMapping, PanelMap
from woz_drivers.midi.resolved_map import mapped_controls
from woz_drivers.midi.settings import MidiSettings
from woz_drivers.panels.control_requests import NEAR, SETTLED_US, PanelKnob, Pickup

from woz_tui.drivers.contract import Ask
from woz_tui.motion.body_feeds import BodyState

PLACE = st.floats(0, 1)


@pytest.mark.toolkit("G7")
@given(PLACE)
def test_the_first_touch_moves_nothing_unless_it_is_where_the_robot_is(present: float) -> None:
    pickup = Pickup()
    assert pickup.turn(1.0, present) is (1.0 - present <= NEAR)


@pytest.mark.toolkit("G7")
@pytest.mark.parametrize("way", [(0.1, 0.3, 0.6), (0.9, 0.7, 0.4), (0.2, 0.51), (0.0, 1.0)])
def test_it_counts_once_it_has_passed_the_robots_value(way: tuple[float, ...]) -> None:
    pickup = Pickup()
    assert [pickup.turn(to, 0.5) for to in way] == [*[False] * (len(way) - 1), True]
    assert pickup.turn(0.99, 0.5), "held: from here on it counts wherever it goes"


@pytest.mark.toolkit("G7")
def test_a_value_changed_by_somebody_else_must_be_picked_up_again() -> None:
    pickup = Pickup()
    pickup.turn(0.5, 0.5)
    pickup.turn(0.6, 0.5)
    pickup.compare(0.6 + NEAR / 2)
    assert pickup.held
    pickup.compare(0.2)
    assert not pickup.turn(0.61, 0.2)
    assert pickup.turn(0.15, 0.2)


def test_refused_and_unplugged_it_must_be_picked_up_again() -> None:
    pickup = Pickup()
    pickup.turn(0.5, 0.5)
    pickup.turn(0.7, 0.5)
    pickup.drop()
    assert not pickup.turn(0.8, 0.5)
    assert pickup.turn(0.5, 0.5)
    pickup.forget()
    assert (pickup.hand, pickup.held) == (None, False)
    assert not pickup.turn(0.9, 0.5)


def test_without_the_robots_value_nothing_counts_and_jump_always_does() -> None:
    assert not Pickup().turn(0.5, None)
    pickup = Pickup(jump=True)
    assert pickup.turn(1.0, None)
    pickup.compare(0.1)
    pickup.drop()
    assert pickup.held


@pytest.mark.toolkit("G7", "K3")
def test_a_hand_keeps_hold_until_the_robot_can_show_what_was_sent() -> None:
    """The robot's state comes a moment after the answer: till then it still shows the value before,
    which is nobody else's.
    """
    now, asked = [0], []

    def answer(ask: Ask, done: Callable[[bool, str], None]) -> None:
        asked.append(ask.args["value"])
        done(True, "")

    panel = MidiSettings(map=PanelMap(controls={"k": ControlMapping(cc=1, control="zoom")}))
    knob = PanelKnob(mapped_controls(panel)[0], answer, lambda: now[0])
    old = BodyState(
        controls={"zoom": 0.5}, mode="normal", emotion="neutral", move="", personality=""
    )
    for value in (64, 80, 100):
        now[0] += 20_000
        knob.moved(value, old)
    assert len(asked) == 3
    now[0] += SETTLED_US
    knob.compare(old)
    assert knob.waiting, "by now it is somebody else's"


def test_a_value_out_of_the_hands_range_is_picked_up_at_its_nearer_end() -> None:
    pickup = Pickup(low=0.4, high=0.6)
    assert not pickup.turn(0.5, 0.9)
    assert pickup.turn(0.6, 0.9)


@given(st.lists(st.tuples(PLACE, PLACE), min_size=1))
def test_what_counts_was_near_the_value_or_passed_it(turns: list[tuple[float, float]]) -> None:
    pickup = Pickup()
    before: float | None = None
    for to, present in turns:
        held = pickup.held
        if pickup.turn(to, present) and not held:
            near = abs(to - present) <= NEAR
            passed = before is not None and min(before, to) <= present <= max(before, to)
            assert near or passed
        before = to
