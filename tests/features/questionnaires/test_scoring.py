"""Scores of questionnaires, by figures that others have published or that a hand can reckon."""

from __future__ import annotations

import math

import pytest

from woz_tui.features.questionnaires import scoring as s

#: Means of the ten topics of the user experience with W@ICAR (Maniscalco, Storniolo and Messina
#: 2022, doi 10.1007/s12369-021-00855-w, Table 2; n = 467): overall, four pragmatic, five hedonic.
WICAR = (5.96, 5.21, 4.98, 5.11, 4.71, 5.51, 4.35, 5.84, 4.33, 4.90)


def test_an_answer_from_the_other_end() -> None:
    assert s.reversed_value(2, 1, 7) == 6
    assert s.reversed_value(-3, -3, 3) == 3
    assert s.reversed_value(5, 0, 100) == 95


def test_means_of_what_was_published() -> None:
    pragmatic, hedonic = s.mean_score(WICAR[1:5]), s.mean_score(WICAR[5:])
    assert pragmatic == pytest.approx(5.0025)
    assert hedonic == pytest.approx(4.986)


def test_a_mean_needs_so_many_answers() -> None:
    assert s.mean_score([1, 2, 6]) == 3
    assert s.mean_score([1, None, 6]) is None
    assert s.mean_score([1, None, 6], missing=1) == 3.5
    assert s.mean_score([None, None], missing=2) is None


def test_a_sum_has_the_mean_of_the_others_for_what_is_missing() -> None:
    assert s.sum_score([1, 2, 6]) == 9
    assert s.sum_score([1, None, 6], missing=1) == pytest.approx(10.5)
    assert s.sum_score([1, None, 6]) is None


@pytest.mark.parametrize(
    ("answers", "score"),
    [
        ([5, 1] * 5, 100.0),  # agrees to all that is good, and to nothing else
        ([1, 5] * 5, 0.0),
        ([3] * 10, 50.0),
        ([4, 2] * 5, 75.0),
        ([5] * 10, 50.0),  # agrees to everything: no good robot
        ([5, 4, 2, 1, 2, 3, 2, 4, 5, 2], 55.0),  # 4+1+1+4+1+2+1+1+4+3 = 22, times 2.5
    ],
)
def test_the_system_usability_scale(answers: list[float], score: float) -> None:
    assert s.sus_score(answers) == score


def test_an_item_of_sus_without_an_answer_is_in_the_middle() -> None:
    assert s.sus_score([5, 1, None, 1, 5, 1, 5, 1, 5, 1]) is None
    assert s.sus_score([5, 1, None, 1, 5, 1, 5, 1, 5, 1], missing=1) == 95.0


def test_raw_and_weighted_workload() -> None:
    ratings = [30, 15, 60, 40, 30, 40]
    assert s.mean_score(ratings) == pytest.approx(35.8333, abs=1e-4)
    weights = [3, 0, 5, 1, 3, 3]  # of fifteen comparisons
    assert sum(weights) == 15
    assert s.weighted_score(ratings, weights) == pytest.approx((90 + 0 + 300 + 40 + 90 + 120) / 15)


def test_an_item_without_an_answer_falls_out_with_its_weight() -> None:
    assert s.weighted_score([30, None], [1, 2]) is None
    assert s.weighted_score([30, None], [1, 2], missing=1) == 30
    assert s.weighted_score([None, 30], [1, 0], missing=1) is None  # no weight is left


def test_weights_from_comparisons() -> None:
    assert s.pair_weights(3, [1, 1, 3]) == [2, 0, 1]
    assert s.pair_weights(3, [1, None, 3]) is None
    assert s.scored(s.WEIGHTED, [1, 2], weights=None) is None


def test_how_far_a_score_can_go() -> None:
    assert s.score_range(s.MEAN, [(1, 7), (1, 7)]) == (1, 7)
    assert s.score_range(s.MEAN, [(1, 7), (1, 5)]) == (None, None)
    assert s.score_range(s.SUM, [(1, 5)] * 6) == (6, 30)
    assert s.score_range(s.SUS, [(1, 5)] * 10) == (0, 100)


def test_two_items_of_seven_points_laid_onto_a_hundred() -> None:
    """UMUX-LITE: (sum - 2) x 100 / 12."""
    for first, second in ((1, 1), (7, 7), (6, 5), (2, 4)):
        mean = s.mean_score([first, second])
        assert mean is not None
        laid = s.laid_onto(mean, (1, 7), (0, 100))
        assert laid == pytest.approx((first + second - 2) * 100 / 12)


# -- reliability -----------------------------------------------------------------------------------

#: Ten people and three items.
ROWS = [[1, 2, 1], [2, 2, 3], [3, 3, 2], [4, 3, 4], [5, 5, 5], [2, 1, 2], [3, 4, 3], [4, 4, 4]]
ROWS += [[5, 4, 3], [1, 2, 2]]


def test_alpha_by_hand() -> None:
    def variance(values: list[int]) -> float:
        mean = sum(values) / len(values)
        return sum((value - mean) ** 2 for value in values) / (len(values) - 1)

    own = sum(variance([row[at] for row in ROWS]) for at in range(3))
    alpha = 3 / 2 * (1 - own / variance([sum(row) for row in ROWS]))
    found = s.reliability(ROWS)
    assert found is not None
    assert (found.name, found.n) == (s.ALPHA, 10)
    assert found.value == pytest.approx(alpha)
    assert found.value == pytest.approx(0.92, abs=0.02)


def test_items_that_are_the_same_go_together_wholly() -> None:
    assert s.cronbach_alpha([[n, n, n] for n in range(1, 6)]) == pytest.approx(1)


def test_two_items_have_the_formula_of_spearman_and_brown() -> None:
    rows = [row[:2] for row in ROWS]
    found = s.reliability(rows)
    assert found is not None
    assert found.name == s.SPEARMAN_BROWN
    first, second = [row[0] for row in rows], [row[1] for row in rows]
    x, y = sum(first) / 10, sum(second) / 10
    r = sum((a - x) * (b - y) for a, b in rows) / math.sqrt(
        sum((a - x) ** 2 for a in first) * sum((b - y) ** 2 for b in second)
    )
    assert found.value == pytest.approx(2 * r / (1 + r))


@pytest.mark.parametrize(
    "rows",
    [
        ROWS[:9],  # too few people
        [[*row[:2], None] for row in ROWS],  # nobody answered all
        [[4, 4, 4]] * 12,  # nobody differs
        [[4, n % 5] for n in range(12)],  # one item does not
        [[n] for n in range(12)],  # one item alone
    ],
)
def test_no_figure_where_it_would_mean_nothing(rows: list[list[float | None]]) -> None:
    assert s.reliability(rows) is None
