"""The queue for identities: formula 3, with Unknown and ties as the model reads them."""

from __future__ import annotations

from collections import Counter

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from woz_tui.sensing.filters import IdentityFifo, least
from woz_tui.sensing.sample_values import UNKNOWN

names = st.lists(st.sampled_from(["Anna", "Bert", "Carl", UNKNOWN]), max_size=80)
thresholds = st.integers(0, 100).map(lambda number: number / 100)


def run(queue: IdentityFifo, seen: list[str]) -> list[str]:
    """The ID given out after each recognition."""
    given_out = []
    for number, name in enumerate(seen):
        queue.add(name, number)
        given_out.append(queue.name)
    return given_out


@given(names, st.integers(1, 20), thresholds)
def test_the_id_is_one_of_those_with_most_entries_if_they_suffice(
    seen: list[str], n: int, threshold: float
) -> None:
    k = max(1, least(threshold, n))
    for end, name in enumerate(run(IdentityFifo(n, threshold), seen), start=1):
        counts = Counter(seen[max(0, end - n) : end])
        del counts[UNKNOWN]
        most = max(counts.values(), default=0)
        if most < k:
            assert name == UNKNOWN
        else:
            assert counts[name] == most


def test_unknown_fills_places_but_never_wins() -> None:
    """Misprint 8: five Unknown of eight, and three of Anna, are Anna at a threshold of 3/8."""
    assert run(IdentityFifo(8, 0.375), ["Anna"] * 3 + [UNKNOWN] * 5)[-1] == "Anna"
    assert run(IdentityFifo(8, 0.5), ["Anna"] * 3 + [UNKNOWN] * 5)[-1] == UNKNOWN


def test_a_share_that_equals_the_threshold_suffices() -> None:
    """Misprint 7: the prose says "overcomes", the formula says at least."""
    assert run(IdentityFifo(8, 0.5), ["Anna"] * 4)[-1] == "Anna"


def test_a_tie_leaves_the_id_that_was_given_out_last() -> None:
    queue = IdentityFifo(4, 0.5)
    assert run(queue, ["Anna", "Anna", "Bert", "Bert"]) == [UNKNOWN, "Anna", "Anna", "Anna"]


def test_a_tie_of_ids_that_were_not_given_out_goes_to_the_one_seen_last() -> None:
    queue = IdentityFifo(4, 0.25)
    assert run(queue, ["Anna"]) == ["Anna"]
    assert run(queue, [UNKNOWN] * 4)[-1] == UNKNOWN
    queue.configure(4, 0.5)
    assert run(queue, ["Bert", "Carl", "Bert", "Carl"])[-1] == "Bert"
    queue = IdentityFifo(4, 0.5, "hold")
    assert run(queue, ["Bert", "Carl", "Bert", "Carl"])[-1] == "Carl"


@pytest.mark.parametrize("n", [2, 4, 8, 10])
def test_a_b_a_b_does_not_flip_flop(n: int) -> None:
    given_out = run(IdentityFifo(n, 0.5), ["Anna", "Bert"] * 20)[n:]
    assert len(set(given_out)) == 1


@given(st.integers(2, 20), st.integers(51, 100))
def test_persons_who_swap_pass_through_unknown(n: int, per_cent: int) -> None:
    """With k > n/2 there is a sample at least without a name between Anna and Bert.

    For an odd n with the barest majority there is none: two of three are Anna, then two are Bert.
    """
    threshold = per_cent / 100
    assume(2 * least(threshold, n) >= n + 2)
    given_out = run(IdentityFifo(n, threshold), ["Anna"] * n + ["Bert"] * n)
    assert UNKNOWN in given_out[n:]
    assert given_out[-1] == "Bert"
    between = [name for name in given_out if name != UNKNOWN]
    assert between.index("Bert") == between.count("Anna")


@given(names, st.integers(1, 20))
def test_a_threshold_of_nothing_makes_up_no_id(seen: list[str], n: int) -> None:
    for end, name in enumerate(run(IdentityFifo(n, 0.0), seen), start=1):
        held = seen[max(0, end - n) : end]
        assert name in held or name == UNKNOWN
        assert name != UNKNOWN or set(held) <= {UNKNOWN}


def test_one_place_is_the_raw_name() -> None:
    seen = ["Anna", UNKNOWN, "Bert", "Anna"]
    assert run(IdentityFifo(1, 0.5), seen) == seen


def test_start_up() -> None:
    assert run(IdentityFifo(4, 0.5), ["Anna"] * 2) == [UNKNOWN, "Anna"]
    assert run(IdentityFifo(4, 0.5, "partial"), ["Anna", UNKNOWN, UNKNOWN]) == [
        "Anna",
        "Anna",
        UNKNOWN,
    ]
    assert run(IdentityFifo(3, 0.5, "hold"), ["Anna"] * 3) == [UNKNOWN, UNKNOWN, "Anna"]
    assert IdentityFifo(3, 0.5, "hold").verdict is None
    assert IdentityFifo(3, 0.5).verdict == 0


def test_forgotten_there_is_nobody_and_no_tie_remembers_them() -> None:
    queue = IdentityFifo(2, 0.5)
    run(queue, ["Anna", "Anna"])
    queue.forget()
    assert (queue.name, queue.count) == (UNKNOWN, 0)
    assert run(queue, ["Bert", "Anna"]) == ["Bert", "Bert"]


@given(names, st.integers(1, 20), st.integers(1, 20), thresholds)
def test_other_numbers_keep_the_newest_names(
    seen: list[str], n: int, other: int, threshold: float
) -> None:
    """E2: n and the threshold change while running."""
    queue = IdentityFifo(n, 0.5)
    run(queue, seen)
    held = queue.values
    queue.configure(other, threshold)
    assert queue.values == held[max(0, len(held) - other) :]
    assert queue.needed == max(1, least(threshold, other))
    if queue.name == UNKNOWN:
        assert queue.count < queue.needed
    else:
        assert queue.values.count(queue.name) == queue.count >= queue.needed
