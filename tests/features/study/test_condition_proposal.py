"""Which row is proposed to whom, from what the earlier participants got."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from woz_tui.features.study.condition_proposal import ConditionProposal, ParticipantHistory, propose
from woz_tui.features.study.counterbalancing import block_size, rows
from woz_tui.features.study.design import Design

CONDITIONS = ("a", "b", "c", "d")
DESIGNS = st.builds(
    Design,
    order=st.sampled_from(["latin-square", "blocks", "fixed"]),
    within=st.just(True),
    trials=st.integers(1, 3),
    seed=st.integers(0, 99),
) | st.builds(
    Design,
    order=st.sampled_from(["blocks", "fixed"]),
    within=st.just(False),
    block=st.none(),
    seed=st.integers(0, 99),
)


def past(
    proposal: ConditionProposal, over: int = 0, *, begun: bool = True, done: bool = True
) -> ParticipantHistory:
    return ParticipantHistory(
        proposal.participant,
        proposal.order,
        proposal.method,
        proposal.row,
        {*range(1, over + 1)},
        begun=begun,
        done=done,
    )


def one(participant: str, design: Design, earlier: list[ParticipantHistory]) -> ConditionProposal:
    return propose(participant, design, CONDITIONS, earlier)


@given(DESIGNS, st.integers(1, 26))
def test_rows_are_used_equally_often_however_many_come(design: Design, count: int) -> None:
    earlier: list[ParticipantHistory] = []
    for number in range(count):
        earlier.append(past(one(f"P{number:02}", design, earlier)))
    if design.order == "blocks":
        assert [each.row for each in earlier] == list(range(count))
        size = block_size(design, CONDITIONS)
        whole = Counter(each.order for each in earlier[: count // size * size])
        assert not whole or design.within or len(set(whole.values())) == 1
    else:
        often = Counter(each.row for each in earlier)
        times = [often[row] for row in range(len(rows(design, CONDITIONS)))]
        assert max(times) - min(times) <= 1


@given(DESIGNS, st.lists(st.sampled_from(["done", "aborted", "fresh"]), max_size=14))
def test_the_place_of_who_did_nothing_usable_is_given_again(
    design: Design, results: list[str]
) -> None:
    earlier: list[ParticipantHistory] = []
    for number, result in enumerate(results):
        proposal = one(f"P{number:02}", design, earlier)
        earlier.append(past(proposal, begun=result != "fresh", done=result == "done"))
        following = one("X1", design, earlier)
        if result == "aborted":
            assert (following.row, following.order) == (proposal.row, proposal.order)
        elif design.order == "blocks":
            assert following.row != proposal.row


@given(DESIGNS, st.integers(0, 12))
def test_who_comes_again_goes_on_where_they_stopped(design: Design, over: int) -> None:
    first = one("P01", design, [])
    others = [past(one(f"P{number}", design, [past(first)])) for number in range(2, 5)]
    again = one("P01", design, [*others, past(first, over)])
    assert (again.order, again.row, again.method) == (first.order, first.row, first.method)
    assert again.trial == min(over, again.planned) + 1
    assert again.planned == design.trials * len(first.order)
    if over < again.planned:
        assert again.condition == first.order[over // design.trials]
    else:
        assert again.condition == first.order[-1]
    assert again.why == f"P01 continues with their own order: {over} of {again.planned} trials done"


def test_an_order_that_the_design_does_not_know_any_more_is_proposed_anew() -> None:
    old = ParticipantHistory("P01", ("a", "b"), "latin-square", 0, {1}, begun=True, done=True)
    proposal = one("P01", Design(), [old])
    assert (proposal.row, proposal.trial) == (0, 1)
    assert proposal.why.endswith("; the earlier order of P01 does not fit the present design")


def test_orders_chosen_by_hand_count_for_the_row_that_has_them() -> None:
    square = rows(Design(), CONDITIONS)
    chosen = [
        ParticipantHistory(f"P{n}", square[0], "hand", -1, {1, 2, 3, 4}, begun=True, done=True)
        for n in (1, 2)
    ]
    other = ParticipantHistory(
        "P3", ("a", "b", "c", "d"), "hand", -1, {1, 2, 3, 4}, begun=True, done=True
    )
    assert other.order not in square
    proposal = one("P4", Design(), [*chosen, other])
    assert proposal.row == 1
    assert proposal.why == "row 2 of 4: least used so far (0 participants)"


def test_blocks_of_another_seed_have_left_all_places_free() -> None:
    first = one("P01", Design(order="blocks", seed=1), [])
    assert one("P02", Design(order="blocks", seed=1), [past(first)]).row == 1
    other = Design(order="blocks", seed=4)
    assert one("P01", other, []).order != first.order
    assert one("P02", other, [past(first)]).row == 0


def test_why_says_how_often_and_names_no_condition() -> None:
    conditions = ("warmest", "coldest", "middling")
    square = propose("P01", Design(), conditions, [])
    assert square.why == "row 1 of 6: least used so far (0 participants)"
    block = propose("P01", Design(order="blocks"), conditions, [])
    assert block.why == "place 1 of 3 in block 1: the first free one"
    fixed = propose(
        "P02", Design(order="fixed"), conditions, [past(replace(block, order=conditions))]
    )
    assert fixed.why == "all participants have the order of the file (1 participant so far)"
    for proposal in (square, block, fixed):
        assert not any(condition in proposal.why for condition in conditions)


def test_without_conditions_there_are_trials_alone() -> None:
    design = Design(order="fixed", trials=3)
    proposal = propose("P01", design, (), [])
    assert (proposal.order, proposal.condition, proposal.planned) == ((), "", 3)
    assert propose("P01", design, (), [past(proposal, 2)]).trial == 3
