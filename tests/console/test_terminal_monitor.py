from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.console.still_feed import StillFeed
from woz_tui.console.input.terminal_monitor import (
    DEAD_S,
    EVERY_S,
    OTHER_QUESTION,
    PAUSE_S,
    QUESTION,
    TerminalMonitor,
)
from woz_tui.protocol.requests import Beat
from woz_tui.protocol.welcome import STALE_S
from woz_tui.system.clock import ManualClock

pytestmark = pytest.mark.safety


class Rig:
    """A line with a clock that a test moves."""

    def __init__(self, *, multiplexed: bool = False) -> None:
        self.clock = ManualClock()
        self.feed = StillFeed()
        self.line = TerminalMonitor(self.feed, self.clock, multiplexed=multiplexed)

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


class Desk:
    """The wizard's end of a line: what is typed and answered there comes in order, or not at all.

    `played` are the ages of the keys that were not stale.
    """

    def __init__(self, rig: Rig, round_trip_s: float = 0.02) -> None:
        self.rig = rig
        self.played: list[int] = []
        self._way_us = round(round_trip_s * 500_000)
        self._flows = self._runs = True
        #: What is on its way there, and here: when it comes, and what it is (a key: when typed).
        self._down: list[tuple[int, str]] = []
        self._up: list[tuple[int, str | int]] = []

    def run(self, seconds: float) -> None:
        """Let time pass; a console that was stopped goes on at its end."""
        until = self.rig.clock.now_us() + round(seconds * 1_000_000)
        while self.rig.clock.now_us() < until:
            self.rig.clock.advance(0.01)
            self._answer()
            if self._runs:
                self._look()
        self._runs = True

    def nothing(self) -> None:
        """Time alone passes."""

    def press(self) -> None:
        now = self.rig.clock.now_us()
        self._up.append((now + self._way_us, now))

    def stall(self) -> None:
        self._flows = False

    def flow(self) -> None:
        self._flows = True

    def stop(self) -> None:
        """The console stands still until the end of the next `run`."""
        self._runs = False

    def away(self) -> None:
        """The console is suspended and goes on at once: it asks who this is, and throws away what
        has come.
        """
        now = self.rig.clock.now_us()
        self._up = [each for each in self._up if not self._flows or each[0] > now]
        self.rig.line.leave()
        self.rig.line.reset()
        self._down.append((now + self._way_us, OTHER_QUESTION))

    def lose(self) -> None:
        """The answers that are under way are lost, and questions that are, too."""
        self._down.clear()
        self._up = [each for each in self._up if isinstance(each[1], int)]

    def _answer(self) -> None:
        now = self.rig.clock.now_us()
        for due, question in [each for each in self._down if each[0] <= now]:
            self._down.remove((due, question))
            self._up.append((now + self._way_us, question))

    def _look(self) -> None:
        line, now = self.rig.line, self.rig.clock.now_us()
        line.awake()
        come = [each for each in self._up if self._flows and each[0] <= now]
        if come:
            del self._up[: len(come)]
            line.arrived(["a" for _, what in come if isinstance(what, int)])
            for _, what in come:
                if what == QUESTION:
                    line.answered()
                elif what == OTHER_QUESTION:
                    line.identified()
                elif isinstance(what, int) and not line.stale:
                    self.played.append(now - what)
        if line.question_in_s <= 0:
            self._down.append((now + self._way_us, line.question))
            line.question_sent()


@pytest.fixture
def rig() -> Rig:
    return Rig()


def test_the_round_trip_is_measured_and_told_to_the_feed(rig: Rig) -> None:
    assert rig.line.rtt_ms is None
    rig.round_trip(0.08)

    assert rig.line.rtt_ms == pytest.approx(80)
    assert rig.feed.round_trip_us == 80_000
    assert rig.feed.line_ok


def test_the_question_is_asked_twice_a_second(rig: Rig) -> None:
    assert rig.line.question_in_s <= 0
    rig.round_trip(0.2)

    assert rig.line.question_in_s == pytest.approx(EVERY_S - 0.2)


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


def test_a_dead_line_is_told_at_once_and_within_three_seconds(rig: Rig) -> None:
    """Also where keys go on coming: their wizard sees an old picture."""
    rig.round_trip()
    silent_from = rig.clock.now_us()
    rig.wait(rig.line.question_in_s)
    while not rig.feed.asked:
        rig.line.question_sent()
        rig.wait(0.25)
        rig.line.arrived(["up"])

    assert rig.feed.asked == [Beat(line_ok=False)]
    assert rig.clock.now_us() - silent_from <= 3_000_000


def test_a_key_after_a_stall_is_stale_until_a_question_asked_behind_it_is_answered(
    rig: Rig,
) -> None:
    rig.round_trip()
    rig.line.question_sent()
    rig.wait(STALE_S + 0.5)

    assert rig.line.arrived(["a"])
    assert rig.line.arrived(["b", "c"])
    rig.line.answered()
    assert rig.line.stale, "its answer was under way for as long"
    assert rig.line.arrived(["d"])
    rig.round_trip()
    assert not rig.line.arrived(["e"])


def test_a_lost_answer_is_not_mistaken_for_the_next_one(rig: Rig) -> None:
    rig.round_trip()
    rig.line.question_sent()
    rig.wait(EVERY_S)
    assert rig.line.question == OTHER_QUESTION
    rig.line.question_sent()
    rig.wait(0.02)
    rig.line.arrived([])
    rig.line.identified()

    assert not rig.line.arrived(["a"])
    assert rig.line.question == QUESTION
    rig.line.answered()
    assert rig.line.age_us == 20_000, "nobody asked: it counts for nothing"


def test_a_wizard_who_thinks_for_a_minute_is_not_stale(rig: Rig) -> None:
    for _ in range(30):
        rig.round_trip()
        rig.wait(EVERY_S)

    assert not rig.line.arrived(["a"])


def test_ten_keys_in_one_read_after_a_silence_are_stale_without_any_measure(rig: Rig) -> None:
    rig.wait(STALE_S + 0.1)

    assert rig.line.arrived(list("1234567890"))


@given(
    st.sampled_from([0.02, 0.3, 0.9]),
    st.lists(
        st.tuples(
            st.sampled_from(["press", "stall", "flow", "stop", "lose", "away", "nothing"]),
            st.floats(0.0, 2.5),
        ),
        max_size=40,
    ),
)
def test_whatever_the_line_does_no_old_key_is_played_and_soon_a_new_one_is(
    round_trip_s: float, story: list[tuple[str, float]]
) -> None:
    desk = Desk(Rig(), round_trip_s)
    desk.run(2.0)
    for what, seconds in story:
        getattr(desk, what)()
        desk.run(seconds)
    assert all(age_us <= STALE_S * 1_000_000 for age_us in desk.played)

    desk.flow()
    desk.run(2 * round_trip_s + 1.6)
    before = len(desk.played)
    desk.press()
    desk.run(round_trip_s)
    assert len(desk.played) == before + 1


def test_keys_that_trickle_in_while_no_answer_comes_are_stale(rig: Rig) -> None:
    rig.round_trip()
    rig.line.question_sent()
    stale = []
    for _ in range(10):
        rig.wait(0.4)
        stale.append(rig.line.arrived(["a"]))

    assert stale == [False] * 3 + [True] * 7


@pytest.mark.parametrize("round_trip_s", [0.3, 0.6, 0.9])
def test_keys_on_a_slow_line_are_played(rig: Rig, round_trip_s: float) -> None:
    desk = Desk(rig, round_trip_s)
    desk.run(5.0)
    for _ in range(40):
        desk.press()
        desk.run(0.13)
    desk.run(round_trip_s)

    assert len(desk.played) == 40
    assert rig.feed.line_ok


@pytest.mark.parametrize("multiplexed", [False, True])
def test_three_keys_in_one_read_are_stale_where_the_answer_is_not_the_terminals_own(
    multiplexed: bool,
) -> None:
    rig = Rig(multiplexed=multiplexed)
    for _ in range(4):
        rig.round_trip()
        rig.wait(EVERY_S)

    assert rig.line.arrived(["a", "b", "c"]) is multiplexed


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


def test_the_rest_of_such_a_text_is_stale_however_short(rig: Rig) -> None:
    assert rig.line.arrived(list("hello wor"))
    rig.wait(0.1)
    assert rig.line.arrived(["l", "d"])
    rig.line.arrived([])
    assert rig.line.arrived(["!"])
    rig.wait(PAUSE_S + 0.1)
    assert not rig.line.arrived(["a"])


def test_behind_such_a_text_a_held_key_counts_again_without_being_let_go(rig: Rig) -> None:
    assert rig.line.arrived(list("hello wor"))
    stale = []
    for _ in range(20):
        rig.wait(0.033)
        stale.append(rig.line.arrived(["up"]))
    assert stale[0]
    assert not any(stale[10:])


def test_what_is_pressed_behind_a_text_in_a_dialog_is_the_wizards(rig: Rig) -> None:
    assert rig.line.arrived(list("hello world"), play=False)
    assert not rig.line.arrived(["enter"], play=False)
    assert not rig.line.arrived(["a"])


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
    assert rig.line.arrived(["a"]), "it may have been under way all the time"
    rig.clock.advance(0.02)
    rig.line.identified()
    assert not rig.line.arrived(["b"])


def test_an_answer_that_was_thrown_away_with_the_suspension_is_not_waited_for(rig: Rig) -> None:
    rig.round_trip()
    rig.line.question_sent()
    rig.line.leave()
    rig.clock.advance(100)
    rig.line.reset()
    assert rig.line.question_in_s == EVERY_S, "it is asked who it is, anyway"
    rig.line.identified()

    assert rig.line.question == QUESTION
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


def test_asking_again_and_again_makes_a_line_neither_alive_nor_its_keys_fresh(rig: Rig) -> None:
    rig.round_trip()
    for _ in range(5):
        rig.line.question_sent()
        rig.wait(EVERY_S)

    dead = not rig.feed.line_ok
    assert rig.line.arrived(["a"])
    rig.line.answered()
    assert (dead, rig.feed.line_ok) == (True, True)
    assert rig.line.stale
    ages = []
    for _ in range(4):
        rig.line.identified()
        ages.append(rig.line.age_us)
    assert ages == [2_000_000, 1_500_000, 1_000_000, 500_000]


@pytest.mark.parametrize(("stale_after_s", "late_s"), [(0.3, 0.1), (5.0, 4.0)])
def test_the_experiment_says_how_old_a_key_may_be(
    rig: Rig, stale_after_s: float, late_s: float
) -> None:
    rig.feed.stale_after_s = stale_after_s
    desk = Desk(rig)
    for seconds in (late_s, stale_after_s + 0.1):
        desk.run(3.0)
        desk.stall()
        desk.press()
        desk.run(seconds)
        desk.flow()
        desk.run(0.3)

    assert len(desk.played) == 1
    for _ in range(20):
        desk.press()
        desk.run(0.11)
    assert len(desk.played) == 21


def test_output_that_waits_for_a_moment_makes_no_key_stale(rig: Rig) -> None:
    rig.round_trip()
    rig.wait(EVERY_S)
    rig.line.put_off()
    rig.wait(rig.line.question_in_s)
    rig.round_trip()
    rig.wait(EVERY_S)

    assert not rig.line.arrived(["a"])


def test_no_question_while_the_terminal_takes_nothing(rig: Rig) -> None:
    rig.round_trip()
    rig.line.question_sent()
    rig.wait(12)
    rig.line.put_off()

    assert rig.line.question_in_s > 0
    assert not rig.line.ok
