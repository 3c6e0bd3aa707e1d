"""The queues for presence, gaze and distance: what follows from formulas 1, 2 and 4."""

from __future__ import annotations

import itertools
import math
import statistics
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.sensing.filters import Fifo, Median, least

places = st.integers(1, 40)
#: Thresholds as people type them.
thresholds = st.integers(0, 1000).map(lambda number: number / 1000)
above_none = st.integers(1, 1000).map(lambda number: number / 1000)
bits = st.lists(st.booleans(), max_size=120)


def run(queue: Fifo, values: list[bool] | list[float]) -> list[int | None]:
    """The verdict after each value."""
    verdicts = []
    for number, value in enumerate(values):
        queue.add(value, number)
        verdicts.append(queue.verdict)
    return verdicts


# -- k = ceil(t_r n), exactly -------------------------------------------------------------------


@given(st.integers(0, 10**6), st.integers(0, 6), places)
def test_the_least_count_is_that_of_the_decimal_as_typed(
    digits: int, decimals: int, n: int
) -> None:
    typed = f"0.{digits % 10**decimals:0{decimals}d}" if decimals else "1"
    assert least(float(typed), n) == math.ceil(Fraction(typed) * n)


@pytest.mark.parametrize(
    ("threshold", "n", "k"),
    [(0.7, 10, 7), (0.5, 8, 4), (0.55, 20, 11), (0.07, 100, 7), (0.29, 100, 29), (0, 8, 0)],
)  # fmt: skip
def test_seven_tenths_of_ten_are_seven(threshold: float, n: int, k: int) -> None:
    assert least(threshold, n) == k


# -- properties of the formula ------------------------------------------------------------------


@given(bits, places, thresholds)
def test_the_verdict_is_the_formulas(values: list[bool], n: int, threshold: float) -> None:
    verdicts = run(Fifo(n, threshold), values)
    for end, verdict in enumerate(verdicts, start=1):
        ones = sum(values[max(0, end - n) : end])
        assert verdict == int(Fraction(ones, n) >= Fraction(str(threshold)))


@given(places, above_none)
def test_on_after_k_samples_and_off_after_n_minus_k_plus_one(n: int, threshold: float) -> None:
    """E1, E2: delays of a step without noise; together n + 1 samples, whatever the threshold."""
    queue, k = Fifo(n, threshold), least(threshold, n)
    run(queue, [False] * n)
    on = run(queue, [True] * (n + 1)).index(1) + 1
    off = run(queue, [False] * (n + 1)).index(0) + 1
    assert (on, off) == (k, n - k + 1)
    assert on + off == n + 1


def test_eight_places_at_one_half_take_four_and_five_samples() -> None:
    """E1: the published numbers, 1.33 s and 1.67 s at 3 Hz."""
    queue = Fifo(8, 0.5)
    assert run(queue, [True] * 8) == [0, 0, 0, 1, 1, 1, 1, 1]
    assert run(queue, [False] * 8) == [1, 1, 1, 1, 0, 0, 0, 0]


@given(places, above_none, st.data())
def test_errors_within_any_window_that_are_few_enough_never_show(
    n: int, threshold: float, data: st.DataObject
) -> None:
    k = least(threshold, n)
    zeros = data.draw(st.sets(st.integers(0, n - 1), max_size=n - k))
    queue = Fifo(n, threshold)
    run(queue, [True] * n)
    on = run(queue, [place not in zeros for place in range(n)] + [True] * n)
    assert set(on) == {1}
    ones = data.draw(st.sets(st.integers(0, n - 1), max_size=k - 1))
    run(queue, [False] * n)
    assert set(run(queue, [place in ones for place in range(n)] + [False] * n)) == {0}


@given(places, above_none)
def test_a_burst_one_longer_always_shows(n: int, threshold: float) -> None:
    k = least(threshold, n)
    queue = Fifo(n, threshold)
    run(queue, [True] * n)
    assert 0 in run(queue, [False] * (n - k + 1) + [True] * n)
    run(queue, [False] * n)
    assert 1 in run(queue, [True] * k + [False] * n)


@given(st.integers(0, 10).map(lambda half: 2 * half + 1))
def test_there_is_no_hysteresis(n: int) -> None:
    queue = Fifo(n, 0.5)
    flickering = [place % 2 == 0 for place in range(6 * n)]
    verdicts = run(queue, flickering)[n - 1 :]
    majority = [int(sum(flickering[end - n : end]) * 2 > n) for end in range(n, 6 * n + 1)]
    assert verdicts == majority
    assert all(one != other for one, other in itertools.pairwise(verdicts))


@given(bits, above_none)
def test_one_place_is_the_raw_signal(values: list[bool], threshold: float) -> None:
    assert run(Fifo(1, threshold), values) == [int(value) for value in values]


@given(bits, places)
def test_a_threshold_of_nothing_always_says_yes(values: list[bool], n: int) -> None:
    assert set(run(Fifo(n, 0.0), values)) <= {1}


@pytest.mark.parametrize("start_up", ["zero-fill", "partial"])
def test_an_empty_queue_never_says_yes(start_up: str) -> None:
    assert Fifo(8, 0.0, start_up).verdict == 0
    assert Median(8, 0.5, start_up, 1.3).verdict == 0


# -- distance -----------------------------------------------------------------------------------


def test_formula_4_counts_what_is_near_and_does_not_add_metres() -> None:
    """Misprint 2: a sum of 8 x 0.9 m is far beyond S_d, and yet all are near."""
    assert run(Fifo(8, 0.5, near=1.3), [0.9] * 8)[-1] == 1


def test_formula_4_compares_a_share_with_the_threshold_not_a_count() -> None:
    """Misprint 3: one near sample of eight does not reach a threshold of one half."""
    assert run(Fifo(8, 0.5, near=1.3), [3.0] * 7 + [0.9])[-1] == 0


def test_formula_4_says_yes_where_the_share_equals_the_threshold() -> None:
    """Misprint 4: equality stands in both lines; it counts as near."""
    assert run(Fifo(8, 0.5, near=1.3), [3.0] * 4 + [0.9] * 4)[-1] == 1


def test_the_social_distance_itself_is_near() -> None:
    """Misprint 5: what is compared with a distance is S_d, and S_d is no longer far."""
    assert run(Fifo(1, 0.5, near=1.3), [1.3, 1.3000001]) == [1, 0]


@given(
    st.lists(st.floats(0.1, 5.0) | st.just(math.inf), min_size=1, max_size=60),
    st.integers(1, 9),
    st.floats(0.2, 4.0),
)
def test_the_median_is_that_of_the_statistics(values: list[float], n: int, near: float) -> None:
    """Misprint 6: the text's median, as an option by its name."""
    verdicts = run(Median(n, 0.5, "zero-fill", near), values)
    for end, verdict in enumerate(verdicts, start=1):
        held = values[max(0, end - n) : end]
        filled = held + [math.inf] * (n - len(held))
        assert verdict == int(statistics.median(filled) <= near)


@given(st.lists(st.floats(0.1, 5.0), max_size=60), st.integers(0, 6))
def test_median_and_formula_agree_for_odd_numbers_at_one_half(
    values: list[float], half: int
) -> None:
    n = 2 * half + 1
    assert run(Median(n, 0.5, "zero-fill", 1.3), values) == run(Fifo(n, 0.5, near=1.3), values)


def test_median_and_formula_differ_for_even_numbers() -> None:
    values = [0.9] * 4 + [3.0] * 4
    assert run(Median(8, 0.5, "zero-fill", 1.3), values)[-1] == 0
    assert run(Fifo(8, 0.5, near=1.3), values)[-1] == 1


def test_another_social_distance_counts_for_what_is_held_already() -> None:
    for queue in (Fifo(4, 0.5, near=1.3), Median(4, 0.5, "zero-fill", 1.3)):
        run(queue, [2.0] * 4)
        queue.near_within(2.5)
        assert queue.verdict == 1


# -- start-up -----------------------------------------------------------------------------------


def test_zero_fill_counts_empty_places_as_no() -> None:
    assert run(Fifo(8, 0.5), [True] * 4) == [0, 0, 0, 1]


def test_partial_divides_by_what_is_held() -> None:
    assert run(Fifo(8, 0.5, "partial"), [True, False, False, True]) == [1, 1, 0, 1]
    assert run(Median(5, 0.5, "partial", 1.3), [0.9, 3.0, 3.0]) == [1, 0, 0]


def test_hold_says_nothing_until_it_is_full() -> None:
    assert run(Fifo(3, 0.5, "hold"), [True] * 4) == [None, None, 1, 1]
    assert run(Median(3, 0.5, "hold", 1.3), [0.9] * 4) == [None, None, 1, 1]


@given(bits, places, thresholds, st.sampled_from(["zero-fill", "partial", "hold"]))
def test_a_full_queue_does_not_know_how_it_was_filled(
    values: list[bool], n: int, threshold: float, start_up: str
) -> None:
    verdicts = run(Fifo(n, threshold, start_up), values)
    assert verdicts[n - 1 :] == run(Fifo(n, threshold), values)[n - 1 :]


def test_forgotten_it_starts_up_anew() -> None:
    queue = Fifo(3, 0.5, "hold")
    run(queue, [True] * 3)
    queue.forget()
    assert queue.verdict is None
    assert run(queue, [True] * 3) == [None, None, 1]


# -- while running ------------------------------------------------------------------------------


@given(bits, places, places, thresholds)
def test_other_numbers_keep_the_newest_values(
    values: list[bool], n: int, other: int, threshold: float
) -> None:
    """E2: n and the threshold change while running; k follows."""
    queue = Fifo(n, 0.5)
    run(queue, values)
    queue.configure(other, threshold)
    kept = values[max(0, len(values) - n) :]
    kept = kept[max(0, len(kept) - other) :]
    assert queue.values == kept
    assert queue.needed == least(threshold, other)
    assert queue.count == sum(kept)
    assert queue.verdict == int(bool(kept) and sum(kept) >= least(threshold, other))


@given(st.lists(st.floats(0.1, 5.0), max_size=40), st.integers(1, 9), st.integers(1, 9))
def test_a_median_of_other_length_is_as_if_it_had_been_so_before(
    values: list[float], n: int, other: int
) -> None:
    queue = Median(n, 0.5, "zero-fill", 1.3)
    run(queue, values)
    queue.configure(other, 0.5)
    fresh = Median(other, 0.5, "zero-fill", 1.3)
    run(fresh, queue.values)
    assert (queue.median, queue.verdict) == (fresh.median, fresh.verdict)
    assert run(queue, values) == run(fresh, values)
