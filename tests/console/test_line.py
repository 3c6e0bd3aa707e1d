from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.console.still_feed import StillFeed
from woz_tui.console.terminal_monitor import DEAD_S, EVERY_S, PAUSE_S, STALE_S, TerminalMonitor
from woz_tui.system.clock import ManualClock


class Rig:
    """A line with a clock that a test moves."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.feed = StillFeed()
        self.line = TerminalMonitor(self.feed, self.clock)

    def wait(self, seconds: float) -> None:
        """Time passes while the reading thread runs."""
        while seconds > 0:
            step = min(0.5, seconds)
            self.clock.advance(step)
            seconds -= step
            self.line.awake()

    def round_trip(self, seconds: float = 0.02) -> None:
        self.line.question_sent()
        self.wait(seconds)
        self.line.arrived([])
        self.line.answered()


@pytest.fixture
def rig() -> Rig:
    return Rig()


def test_the_round_trip_is_measured_and_told_to_the_feed(rig: Rig) -> None:
    assert rig.line.rtt_ms is None
    rig.round_trip(0.08)

    assert rig.line.rtt_ms == pytest.approx(80)
    assert rig.feed.round_trip_us == 80_000
    assert rig.feed.line_ok


def test_the_question_is_asked_every_two_seconds(rig: Rig) -> None:
    assert rig.line.question_in_s <= 0
    rig.round_trip(0.5)

    assert rig.line.question_in_s == pytest.approx(EVERY_S - 0.5)


def test_a_terminal_that_never_answers_counts_as_well(rig: Rig) -> None:
    rig.line.question_sent()
    rig.wait(60)

    assert rig.line.ok
    assert rig.line.rtt_ms is None
    assert not rig.line.arrived(["a"])


def test_a_line_that_falls_silent_is_dead_until_it_answers(rig: Rig) -> None:
    rig.round_trip()
    rig.line.question_sent()
    rig.wait(DEAD_S - 0.1)
    assert rig.line.ok
    rig.wait(0.2)
    dead = not rig.feed.line_ok

    rig.line.arrived([])
    rig.line.answered()

    assert (dead, rig.feed.line_ok) == (True, True)


def test_a_key_after_a_stall_is_stale_until_the_answer(rig: Rig) -> None:
    rig.round_trip()
    rig.line.question_sent()
    rig.wait(STALE_S + 0.5)

    assert rig.line.arrived(["a"])
    assert rig.line.arrived(["b", "c"])
    rig.line.answered()
    assert not rig.line.arrived(["d"])


def test_a_pause_ends_a_burst_even_without_an_answer(rig: Rig) -> None:
    rig.round_trip()
    rig.line.question_sent()
    rig.wait(STALE_S + 0.5)
    assert rig.line.arrived(["a"])
    rig.wait(PAUSE_S + 0.1)

    assert not rig.line.arrived(["b"])


def test_a_wizard_who_thinks_for_a_minute_is_not_stale(rig: Rig) -> None:
    for _ in range(30):
        rig.round_trip()
        rig.wait(EVERY_S)

    assert not rig.line.arrived(["a"])


def test_ten_keys_in_one_read_after_a_silence_are_stale_without_any_measure(rig: Rig) -> None:
    rig.wait(STALE_S + 0.1)

    assert rig.line.arrived(list("1234567890"))


def test_a_slow_line_that_goes_on_talking_is_not_stale(rig: Rig) -> None:
    rig.round_trip()
    rig.line.question_sent()
    for _ in range(20):
        rig.wait(0.4)
        assert not rig.line.arrived(["a"])


@given(st.lists(st.tuples(st.floats(0.02, 1.0), st.sampled_from(["a", "ab"])), max_size=40))
def test_fast_typing_is_never_stale(strokes: list[tuple[float, str]]) -> None:
    rig = Rig()
    for pause, keys in strokes:
        rig.wait(pause)
        assert not rig.line.arrived(list(keys))


def test_a_key_held_down_is_not_stale(rig: Rig) -> None:
    rig.wait(10)
    assert not rig.line.arrived(["up"])
    for _ in range(100):
        rig.wait(0.1)
        assert not rig.line.arrived(["up"] * 3)


def test_a_key_held_down_through_a_freeze_is_stale(rig: Rig) -> None:
    rig.wait(STALE_S + 0.1)

    assert rig.line.arrived(["up"] * 50)


def test_text_pasted_without_marks_is_stale_at_any_time(rig: Rig) -> None:
    assert rig.line.arrived(list("hello world"))


@pytest.mark.parametrize("asleep", [False, True])
def test_keys_that_came_while_process_or_computer_stood_still_are_stale(
    rig: Rig, asleep: bool
) -> None:
    (rig.clock.sleep if asleep else rig.clock.advance)(5)
    rig.line.awake()

    assert rig.line.arrived(["a"])
    rig.wait(1)
    assert not rig.line.arrived(["b"])


def test_nobody_watches_while_suspended(rig: Rig) -> None:
    rig.round_trip()
    rig.line.leave()
    rig.line.awake()
    rig.line.arrived([])
    while_away = rig.feed.line_ok

    rig.clock.advance(100)
    rig.line.reset()

    assert (while_away, rig.feed.line_ok) == (False, True)
    assert not rig.line.arrived(["a"])


def test_a_terminal_that_is_frozen_when_the_console_goes_on_is_dead_again(rig: Rig) -> None:
    rig.round_trip()
    rig.line.leave()
    rig.clock.advance(100)
    rig.line.reset()
    rig.line.question_sent()
    rig.wait(DEAD_S + 0.1)

    assert not rig.feed.line_ok


def test_a_terminal_that_takes_no_question_is_dead_and_its_keys_are_stale(rig: Rig) -> None:
    rig.round_trip()
    rig.wait(EVERY_S)
    while rig.line.question_in_s <= 0 and rig.line.ok:
        rig.line.put_off()
        rig.wait(rig.line.question_in_s)

    assert not rig.feed.line_ok
    assert rig.line.arrived(["a"])


def test_asking_once_more_makes_a_line_neither_alive_nor_its_keys_fresh(rig: Rig) -> None:
    rig.round_trip()
    rig.line.question_sent()
    rig.wait(rig.line.question_in_s)
    rig.line.question_sent()
    rig.wait(0.5)

    assert not rig.feed.line_ok
    assert rig.line.arrived(["a"])
    rig.line.answered()
    assert rig.feed.line_ok


def test_output_that_waits_for_a_moment_makes_no_key_stale(rig: Rig) -> None:
    rig.round_trip()
    rig.wait(EVERY_S)
    rig.line.put_off()
    rig.wait(rig.line.question_in_s)
    rig.round_trip()
    rig.wait(STALE_S)

    assert not rig.line.arrived(["a"])


def test_no_question_while_the_terminal_takes_nothing(rig: Rig) -> None:
    rig.round_trip()
    rig.line.question_sent()
    rig.wait(12)
    rig.line.put_off()

    assert rig.line.question_in_s > 0
    assert not rig.line.ok
