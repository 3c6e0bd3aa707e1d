"""Reactions over many sessions: no cue is left out of the denominator in silence."""

from __future__ import annotations

import re

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.figures import Reactions
from woz_tui.analysis.html.reaction_plot import reaction_curves
from woz_tui.analysis.reaction_totals import ReactionTotals, early_sentences, reactions_table

SECOND = 1_000_000


def totals(*people: tuple[dict[str, int], list[float]], window_s: float = 10.0) -> ReactionTotals:
    found = ReactionTotals()
    for number, (results, times) in enumerate(people):
        durations = Durations(round(each * SECOND) for each in times)
        found.add(f"P{number}", Reactions(results, durations), round(window_s * SECOND))
    return found


def test_the_share_is_of_all_cues_that_stayed_open() -> None:
    found = totals(
        (
            {"answered": 3, "answered_early": 1, "missed": 4, "superseded": 5, "cut": 7},
            [0.5, 1.0, 4.0],
        )
    )
    assert (found.cues, found.stayed_open) == (20, 8)
    shares = [found.share_within(seconds) for seconds in (1, 2, 3, 5)]
    assert shares == [3 / 8, 3 / 8, 3 / 8, 4 / 8]


def test_the_middle_is_that_of_the_participants() -> None:
    """Who had most cues does not weigh most; who answered none in time has no middle."""
    found = totals(
        ({"answered": 5}, [1.0] * 5), ({"answered": 1}, [3.0]), ({"answered": 1}, [5.0]),
        ({"missed": 2}, []),
    )  # fmt: skip
    assert found.median_us == 3 * SECOND
    [row] = reactions_table({"warm": found}).rows
    assert list(row[:9]) == ["warm", "9", "7", "", "2", "", "", "3", "3.00 s"]


def test_the_picture_rises_from_what_was_early_to_what_was_answered() -> None:
    found = totals(({"answered": 2, "answered_early": 1, "missed": 1, "cut": 9}, [2.5, 5.0]))
    curves = reaction_curves({"warm": found, "cold": totals(({"cut": 1}, []))})
    assert curves is not None
    path, _of_the_name = re.findall(r' d="([^"]+)"', curves)
    bottom, top = 176.0, 12.0
    heights = [float(each) for each in re.findall(r"(?:V|M40 )([\d.]+)", path)]
    shares = [(bottom - each) / (bottom - top) for each in heights]
    assert shares == [0.25, 0.5, 0.75]
    assert [float(each) for each in re.findall(r"H([\d.]+)", path)] == [110.0, 180.0, 320.0]
    assert "warm 75.0 % within the window" in curves
    assert reaction_curves({"cold": totals(({"cut": 1}, []))}) is None


def test_beyond_the_window_nobody_knows() -> None:
    found = totals(({"answered": 1, "missed": 1}, [1.5]), window_s=2.5)
    assert [found.share_within(seconds) for seconds in (1, 2, 3, 5)] == [0, 0.5, None, None]
    assert "window 2.5 s" in reactions_table({"": found}).title


def test_of_no_cue_there_is_nothing_to_say() -> None:
    found = totals(({}, []))
    assert found.share_within(1) is None
    assert found.median_us is None
    assert not reactions_table({"warm": found}).rows


def test_many_early_answers_are_told_as_late_cues() -> None:
    quick = totals(({"answered_early": 2, "answered": 8}, [1.0] * 8))
    usual = totals(({"answered_early": 1, "answered": 9}, [1.0] * 9))
    [sentence] = early_sentences({"warm": quick, "cold": usual})
    assert sentence.startswith("warm: 20.0 % of the cues were answered early")
