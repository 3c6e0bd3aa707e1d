"""The start dialog in an experiment with a design: the order is proposed."""

from __future__ import annotations

import msgspec
import pytest
from textual.widgets import Input

from tests.console import scenes, studied
from tests.console.dialogs import opened
from tests.console.driving import Sitting, sitting
from woz_tui.console.screens.lost import LostDialog
from woz_tui.console.screens.start import StartDialog, proposal_of
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

WHY = "row 2 of 2: least used so far (2 participants)"
DATA: dict[str, m.Json] = {
    "order": ["cold", "warm"],
    "method": "latin-square",
    "row": 1,
    "why": WHY,
    "condition": "cold",
    "trial": 1,
    "planned": 4,
}


def propose(seat: Sitting, **other: m.Json) -> None:
    seat.feed.answers[r.AskProposal] = lambda asked, ref: r.Reply(
        ref=ref, ok=True, data={**DATA, **other}
    )


async def named(seat: Sitting, code: str = "P08") -> None:
    """Open the dialog and write another code."""
    await opened(seat, "StartDialog")
    field = seat.console.screen.query_one("#participant", Input)
    field.value = ""
    await seat.type(code)
    await seat.until(lambda: field.value == code)
    for _ in range(5):  # the question, its answer, the fields that it fills in, their places
        await seat.press()


REFUSED = r.Reply(ref=0, ok=False, reason="'P1' is no code", hint="it must look like P01")


async def test_enter_with_a_wrong_code_says_what_is_wrong_with_the_code() -> None:
    first = scenes.welcome(state=[scenes.start("", "")], settings={"study": studied.told()})
    async with sitting(first) as seat:
        seat.feed.answers[r.AskProposal] = lambda asked, ref: msgspec.structs.replace(
            REFUSED, ref=ref
        )
        await named(seat, "P1")
        await seat.press("enter")
        await seat.settle()
        assert "'P1' is no code: it must look like P01" in seat.drawn()


async def test_enter_on_a_condition_chooses_it_and_accepts() -> None:
    async with sitting() as seat:
        await opened(seat, "StartDialog")
        await seat.press("tab", "down", "enter")
        await seat.until(lambda: seat.console.dialog is None)
        asked = seat.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert asked.condition == "cold"


async def test_enter_on_the_conditions_takes_the_one_that_is_chosen() -> None:
    async with sitting(scenes.welcome(state=[scenes.start("P07", "cold")])) as seat:
        await opened(seat, "StartDialog")
        await seat.press("tab", "enter")
        await seat.until(lambda: seat.console.dialog is None)
        asked = seat.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert asked.condition == "cold"


async def test_somebody_else_gets_neither_trial_nor_condition_of_the_one_before() -> None:
    """Without a design nothing is proposed."""
    third = m.SessionChanged(trial=3, participant="P07", condition="cold", t=scenes.NOW)
    async with sitting(scenes.welcome(state=[scenes.start("P07", "cold"), third])) as seat:
        await named(seat, "P08")
        await seat.press("enter")
        assert seat.feed.last(r.AskSet) is None
        assert "Choose a condition" in seat.drawn()
        await seat.press("tab", "down", "enter")
        await seat.until(lambda: seat.console.dialog is None)
        asked = seat.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert (asked.participant, asked.trial) == ("P08", None)
        assert asked.condition in ("warm", "cold")


def last(seat: Sitting) -> r.AskAssign:
    asked = seat.feed.last(r.AskAssign)
    assert isinstance(asked, r.AskAssign)
    return asked


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_a_code_brings_its_order_and_enter_accepts_it(size: tuple[int, int]) -> None:
    async with sitting(studied.welcome(), size=size) as seat:
        propose(seat)
        await named(seat)
        asked = seat.feed.last(r.AskProposal)
        assert isinstance(asked, r.AskProposal)
        assert asked.participant == "P08"
        drawn = seat.drawn()
        for part in ("1. cold", "2. warm", "next: trial 1 in cold", "latin-square", "so far"):
            assert part in drawn, part
        await seat.press("enter")
        assert (last(seat).participant, last(seat).order) == ("P08", ["cold", "warm"])
        assert seat.feed.last(r.AskSet) is None
        assert seat.console.dialog is None


async def test_a_proposed_order_is_accepted_whatever_its_conditions_are_called() -> None:
    names = ["slow, calm", "fast"]
    async with sitting(msgspec.structs.replace(studied.welcome(), conditions=names)) as seat:
        propose(seat, order=[*names], condition=names[0])
        await named(seat)
        await seat.press("enter")
        assert last(seat).order == names


async def test_enter_before_the_proposal_has_come_accepts_it_when_it_comes() -> None:
    async with sitting(studied.welcome()) as seat:
        late: list[int] = []

        def answer(asked: r.AnyRequest, ref: int) -> r.Reply:
            late.append(ref)
            return r.Reply(ref=0, ok=True)  # to nobody

        seat.feed.answers[r.AskProposal] = answer
        await named(seat)
        await seat.press("enter")
        await seat.settle()
        assert seat.feed.last(r.AskAssign) is seat.feed.last(r.AskSet) is None
        await seat.tell(r.Reply(ref=late[-1], ok=True, data=DATA))
        await seat.until(lambda: seat.console.dialog is None)
        assert (last(seat).participant, last(seat).order) == ("P08", ["cold", "warm"])
        assert seat.feed.last(r.AskSet) is None


async def test_an_incomplete_code_has_no_order() -> None:
    async with sitting(studied.welcome()) as seat:

        def answer(asked: r.AnyRequest, ref: int) -> r.Reply:
            assert isinstance(asked, r.AskProposal)
            if asked.participant != "P08":
                return r.Reply(ref=ref, ok=False, reason="it does not match the pattern")
            return r.Reply(ref=ref, ok=True, data=DATA)

        seat.feed.answers[r.AskProposal] = answer
        await named(seat, "P0")
        assert "Proposed" not in seat.drawn()
        await seat.type("8")
        await seat.until(lambda: "Proposed" in seat.drawn())


async def test_another_order_is_written_by_hand() -> None:
    async with sitting(studied.welcome()) as seat:
        propose(seat)
        await named(seat)
        order = seat.console.screen.query_one("#order", Input)
        order.value = "warm, colt"
        await seat.press("enter")
        assert "There is no condition 'colt'" in seat.drawn()
        order.value = "warm, cold"
        await seat.press("enter")
        assert last(seat).order == ["warm", "cold"]


async def test_who_gets_one_condition_is_offered_a_choice() -> None:
    async with sitting(studied.welcome()) as seat:
        propose(seat, order=["cold"])
        await named(seat)
        await seat.press("enter")
        assert last(seat).order == ["cold"]


async def test_one_condition_is_chosen_by_hand() -> None:
    async with sitting(studied.welcome()) as seat:
        propose(seat, order=["cold"])
        await named(seat)
        await seat.press("tab", "up", "enter")
        await seat.press("tab", "enter")
        assert last(seat).order == ["warm"]


async def test_another_trial_is_set_behind_the_order() -> None:
    async with sitting(studied.welcome()) as seat:
        propose(seat, trial=3)
        await named(seat)
        trial = seat.console.screen.query_one("#trial", Input)
        assert trial.value == "3"
        trial.value = "2"
        await seat.press("enter")
        asked = seat.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert (asked.participant, asked.condition, asked.trial) == (None, None, 2)


async def test_who_has_the_order_already_gets_only_another_trial() -> None:
    async with sitting(studied.welcome()) as seat:
        propose(seat, order=["warm", "cold"], condition="warm", trial=4)
        await opened(seat, "StartDialog")
        await seat.settle()
        await seat.press("enter")
        assert seat.feed.last(r.AskAssign) is None
        asked = seat.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert (asked.participant, asked.condition, asked.trial) == (None, None, 4)


async def test_a_refused_order_keeps_the_dialog_open() -> None:
    async with sitting(studied.welcome()) as seat:
        propose(seat)
        seat.feed.answers[r.AskAssign] = lambda asked, ref: r.Reply(
            ref=ref, ok=False, reason="a trial is under way"
        )
        await named(seat)
        await seat.press("enter")
        assert "a trial is under way" in seat.drawn()


async def test_without_a_design_nothing_is_proposed() -> None:
    async with sitting(scenes.welcome()) as seat:
        await named(seat)
        assert seat.feed.last(r.AskProposal) is None
        await seat.press("tab", "enter")
        await seat.until(lambda: seat.console.dialog is None)
        asked = seat.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert (asked.participant, asked.condition) == ("P08", "warm")


def test_what_is_no_proposal_is_none() -> None:
    nothing: list[m.Json] = [None, [], "x", {}, {"order": []}, {"order": 3}]
    for data in nothing:
        assert proposal_of(data) is None
    found = proposal_of({"order": ["a"], "trial": "x", "row": None})
    assert found is not None
    assert (found.order, found.trial, found.row) == (("a",), None, -1)


async def crashed(seat: Sitting, session: str) -> None:
    """The robot process is lost, and the one of `session` is there, with nobody chosen; its log
    is another file than before, as behind a full disk.
    """
    seat.feed.cut("the robot process closed the connection")
    await seat.until(lambda: isinstance(seat.console.dialog, LostDialog))
    start = msgspec.structs.replace(scenes.start("", ""), session=session)
    plain = scenes.welcome([start], settings={"study": studied.told()})
    seat.feed.deliver(msgspec.structs.replace(plain, log="recordings/another.jsonl"))
    await seat.until(lambda: not seat.console.state.lost)
    await seat.settle()


async def test_after_a_crash_who_takes_part_is_asked_again_and_filled_in() -> None:
    first = scenes.welcome([scenes.start("", "")], settings={"study": studied.told()})
    async with sitting(first, ask_participant=True) as seat:
        propose(seat)
        await seat.until(lambda: isinstance(seat.console.dialog, StartDialog))
        await seat.press("ctrl+q")
        await seat.tell(m.SessionChanged(participant="P09", condition="warm", trial=2))
        await crashed(seat, "S02")
        await seat.until(lambda: isinstance(seat.console.dialog, StartDialog))
        await seat.settle()
        assert seat.console.screen.query_one("#participant", Input).value == "P09"
        asked = seat.feed.last(r.AskProposal)
        assert isinstance(asked, r.AskProposal)
        assert asked.participant == "P09"
        await seat.until(lambda: "1. cold" in seat.drawn())
        await seat.press("enter")
        await seat.until(lambda: seat.feed.last(r.AskAssign) is not None)
        assigned = seat.feed.last(r.AskAssign)
        assert isinstance(assigned, r.AskAssign)
        assert (assigned.participant, assigned.order) == ("P09", ["cold", "warm"])


@pytest.mark.parametrize(("asks", "session"), [(True, "S01"), (False, "S02")])
async def test_nobody_is_asked_again_in_the_same_session_or_where_nobody_was(
    asks: bool, session: str
) -> None:
    first = scenes.welcome([scenes.start("", "")], settings={"study": studied.told()})
    async with sitting(first, ask_participant=asks) as seat:
        if asks:
            await seat.until(lambda: isinstance(seat.console.dialog, StartDialog))
            await seat.press("ctrl+q")
        await crashed(seat, session)
        assert seat.console.dialog is None
