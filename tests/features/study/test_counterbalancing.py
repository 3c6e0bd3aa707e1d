"""Orders of conditions: what is balanced, whatever the number of conditions and the seed."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.features.study.counterbalancing import (
    block_size,
    letters,
    order_at,
    planned,
    rows,
    williams,
)
from woz_tui.features.study.design import Design

SEEDS = st.integers(0, 999_999)
COUNTS = st.integers(2, 9)


def named(count: int) -> list[str]:
    return [f"c{index}" for index in range(count)]


@given(COUNTS)
def test_a_square_has_n_rows_or_2n_and_everybody_gets_every_condition_once(count: int) -> None:
    square = williams(named(count))
    assert len(set(square)) == len(square) == (2 * count if count % 2 else count)
    assert all(sorted(row) == named(count) for row in square)
    assert square[0][:2] == ("c0", "c1")


@given(COUNTS)
def test_in_a_square_every_condition_stands_equally_often_at_each_place(count: int) -> None:
    square = williams(named(count))
    for place in range(count):
        often = Counter(row[place] for row in square)
        assert set(often.values()) == {len(square) // count}
        assert len(often) == count


@given(COUNTS)
def test_in_a_square_every_condition_stands_equally_often_behind_each_other_one(count: int) -> None:
    square = williams(named(count))
    often = Counter(pair for row in square for pair in pairwise(row))
    assert len(often) == count * (count - 1)
    assert set(often.values()) == {2 if count % 2 else 1}


def test_the_square_of_four_is_that_of_the_textbooks() -> None:
    assert ["".join(row) for row in williams("ABCD")] == ["ABDC", "BCAD", "CDBA", "DACB"]


@given(COUNTS, st.integers(1, 4), SEEDS, st.integers(0, 30))
def test_each_block_has_each_condition_equally_often(
    count: int, times: int, seed: int, block: int
) -> None:
    design = Design(order="blocks", within=False, block=count * times, seed=seed)
    size = block_size(design, named(count))
    got = [order_at(design, named(count), block * size + place) for place in range(size)]
    assert Counter(got) == {(name,): times for name in named(count)}


@given(COUNTS, st.integers(1, 3), SEEDS, st.integers(0, 30))
def test_each_block_has_each_condition_equally_often_at_each_place(
    count: int, times: int, seed: int, block: int
) -> None:
    design = Design(order="blocks", block=count * times, seed=seed)
    size = block_size(design, named(count))
    got = [order_at(design, named(count), block * size + place) for place in range(size)]
    assert all(sorted(order) == named(count) for order in got)
    for place in range(count):
        assert Counter(order[place] for order in got) == dict.fromkeys(named(count), times)


@given(COUNTS, SEEDS, st.integers(0, 200), st.booleans())
def test_the_same_seed_gives_the_same_order_and_another_one_mostly_another(
    count: int, seed: int, row: int, within: bool
) -> None:
    design = Design(order="blocks", within=within, seed=seed)
    assert order_at(design, named(count), row) == order_at(design, named(count), row)
    other = Design(order="blocks", within=within, seed=seed + 1)
    ours = [order_at(design, named(count), each) for each in range(60)]
    assert ours != [order_at(other, named(count), each) for each in range(60)]


def test_blocks_are_the_same_on_every_machine() -> None:
    """Who changes this gives participants of running studies other conditions."""
    one = Design(order="blocks", within=False, block=4, seed=1)
    assert "".join(order_at(one, "ab", row)[0] for row in range(16)) == "aabbaabbbbaaabab"
    all_of_them = Design(order="blocks", seed=7)
    got = ["".join(order_at(all_of_them, "abc", row)) for row in range(6)]
    assert got == ["acb", "bac", "cba", "cab", "bca", "abc"]


def test_a_square_begins_anew_behind_its_last_row_and_a_fixed_order_is_that_of_the_file() -> None:
    conditions = ("b", "a")
    square = Design()
    assert [order_at(square, conditions, row) for row in range(3)] == [
        ("b", "a"),
        ("a", "b"),
        ("b", "a"),
    ]
    assert rows(Design(order="fixed"), conditions) == (("b", "a"),)
    assert rows(Design(order="fixed", within=False), conditions) == (("b",), ("a",))
    assert rows(Design(order="fixed"), ()) == ((),)


@pytest.mark.parametrize(
    ("design", "count", "trials"),
    [
        (Design(trials=3), 2, 6),
        (Design(order="blocks", within=False, trials=3), 2, 3),
        (Design(order="fixed", trials=4), 0, 4),
    ],
)
def test_how_many_trials_a_participant_has(design: Design, count: int, trials: int) -> None:
    assert planned(design, named(count)) == trials


@given(st.integers(1, 40), SEEDS)
def test_every_condition_has_a_label_of_its_own(count: int, seed: int) -> None:
    given_to = letters(named(count), seed)
    assert list(given_to) == named(count)
    assert len(set(given_to.values())) == count
