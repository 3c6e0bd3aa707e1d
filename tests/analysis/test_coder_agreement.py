"""Two coders' agreement: figures of published examples, bins, and what lies outside of trials."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.analysis.example_sessions import SECOND, ExampleSession, in_time
from woz_tui.analysis.coder_agreement import Agreement, agreements, binned, coded_spans
from woz_tui.log.coding_file import Code
from woz_tui.protocol import messages as m
from woz_tui.timeline.timeline import timeline_of

#: J. L. Fleiss, B. Levin, M. C. Paik, Statistical Methods for Rates and Proportions, 3rd edition,
#: Wiley 2003, table 18.1: diagnoses of 100 subjects by two raters; kappa is given as 0.68.
DIAGNOSES = {
    ("psychotic", "psychotic"): 75, ("psychotic", "neurotic"): 1, ("psychotic", "organic"): 4,
    ("neurotic", "psychotic"): 5, ("neurotic", "neurotic"): 4, ("neurotic", "organic"): 1,
    ("organic", "organic"): 10,
}  # fmt: skip
#: StataCorp, Base Reference Manual, kappa, example 1 (data of N. F. Boyd and others, Journal of the
#: National Cancer Institute 68, 1982): 85 xeromammograms read by two radiologists; agreement is
#: given as 63.53 %, kappa as 0.4728.
MAMMOGRAMS = {
    ("normal", "normal"): 21, ("normal", "benign"): 12,
    ("benign", "normal"): 4, ("benign", "benign"): 17, ("benign", "suspect"): 1,
    ("suspect", "normal"): 3, ("suspect", "benign"): 9, ("suspect", "suspect"): 15,
    ("suspect", "cancer"): 2, ("cancer", "cancer"): 1,
}  # fmt: skip


@pytest.mark.parametrize(
    ("table", "agreed", "kappa"), [(DIAGNOSES, 0.89, 0.68), (MAMMOGRAMS, 0.6353, 0.4728)]
)
def test_figures_of_published_examples(
    table: Mapping[tuple[str, str], int], agreed: float, kappa: float
) -> None:
    agreement = Agreement("t", table)
    digits = len(str(kappa)) - 2
    assert (round(agreement.agreed or 0, 4), round(agreement.kappa or 0, digits)) == (agreed, kappa)


def coded(coder: str, *codes: tuple[float, str]) -> list[Code]:
    return [Code(coder, n, round(t * SECOND), text, "") for n, (t, text) in enumerate(codes)]


def test_the_same_figures_come_of_codes_in_time() -> None:
    """A code a second, in the order of the table."""
    pairs = [pair for pair, count in DIAGNOSES.items() for _ in range(count)]
    one = coded("K1", *((t, f"x: {pair[0]}") for t, pair in enumerate(pairs)))
    other = coded("K2", *((t, f"x: {pair[1]}") for t, pair in enumerate(pairs)))
    [agreement] = agreements(one, other, [(0, 100 * SECOND)])
    assert (agreement.tier, agreement.table) == ("x", DIAGNOSES)
    [coarse] = agreements(one, other, [(0, 100 * SECOND)], 10 * SECOND)
    assert coarse.bins == 10


def test_a_code_holds_until_the_next_of_its_tier_and_a_moment_for_its_bin() -> None:
    codes = coded(
        "K1",
        (1.6, "gaze: robot"),
        (2, "smiles"),
        (3.2, "gaze: away"),
        (4.9, "gaze:"),
        (5.5, "nods"),
    )
    within = [(0, 7 * SECOND)]
    assert binned(codes, "gaze", within, SECOND) == ["", "", "robot", "away", "away", "", ""]
    assert binned(codes, "markers", within, SECOND) == ["", "", "smiles", "", "", "nods", ""]


def test_a_note_is_no_code() -> None:
    note = Code("K1", 0, SECOND, "gaze: I am not sure", "", note=True)
    assert agreements([note], [], [(0, SECOND)]) == []


def test_one_code_alone_has_no_kappa() -> None:
    codes = coded("K1", (0, "x: a"))
    [agreement] = agreements(codes, codes, [(0, 5 * SECOND)])
    assert (agreement.agreed, agreement.kappa) == (1.0, None)
    [nothing] = agreements(codes, codes, [])
    assert (nothing.agreed, nothing.kappa) == (None, None)


def trials() -> ExampleSession:
    session = ExampleSession()
    for begin, end, how in ((2, 10, "done"), (12, 15, "aborted"), (20, 30, "done")):
        session.add(begin, m.TrialStarted(trial=1, condition="warm"))
        session.add(end, m.TrialEnded(trial=1, outcome=how))
    return session.add(23, m.BreakStarted()).add(25, m.BreakEnded()).end(40)


def seconds(found: Sequence[tuple[int, int]]) -> list[tuple[float, float]]:
    return [(begin / SECOND, end / SECOND) for begin, end in found]


def test_only_trials_that_count_are_compared() -> None:
    timeline = timeline_of(in_time(trials()))
    assert seconds(coded_spans(timeline)) == [(2, 10), (20, 23), (25, 30)]
    assert (12, 15) in seconds(coded_spans(timeline, every=True))
    codes = coded("K1", (1, "x: before"), (9, "x: a"), (13, "x: aborted"))
    assert binned(codes, "x", coded_spans(timeline), SECOND) == [*[""] * 7, "a", *[""] * 8]


def test_a_session_without_trials_is_compared_as_a_whole() -> None:
    assert seconds(coded_spans(timeline_of(in_time(ExampleSession().end(9))))) == [(0, 9)]


CODES = st.lists(
    st.tuples(st.floats(0, 20), st.sampled_from(["x: a", "x: b", "x:", "smiles", "nods"])),
    max_size=9,
)


@given(CODES, CODES)
def test_it_is_the_same_both_ways_and_whole_with_oneself(
    one: list[tuple[float, str]], other: list[tuple[float, str]]
) -> None:
    a, b, within = coded("K1", *one), coded("K2", *other), [(0, 20 * SECOND)]
    there = {each.tier: each.kappa for each in agreements(a, b, within)}
    back = {each.tier: each.kappa for each in agreements(b, a, within)}
    assert there.keys() == back.keys()
    for tier, kappa in there.items():
        assert kappa == pytest.approx(back[tier])
        assert kappa is None or -1 <= kappa <= 1 + 1e-9
    for each in agreements(a, a, within):
        assert each.agreed == 1
        assert each.kappa is None or each.kappa == pytest.approx(1)
