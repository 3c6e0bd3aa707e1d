"""The start dialog in an experiment with a design: the order is proposed."""

from __future__ import annotations

import msgspec
import pytest
from textual.widgets import Input

from tests.console import scenes, study_scene
from tests.console.dialogs import named, open_dialog
from tests.console.piloting import ConsolePilot, piloted_console
from woz_tui.console.screens.lost import LostDialog
from woz_tui.console.screens.start import StartDialog
from woz_tui.features.study.kinds import AskAssign, AskProposal
from woz_tui.features.study.order_dialog import proposal_of
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


def propose(pilot: ConsolePilot, **other: m.Json) -> None:
    pilot.feed.answers[AskProposal] = lambda asked, ref: r.Reply(
        ref=ref, ok=True, data={**DATA, **other}
    )


REFUSED = r.Reply(ref=0, ok=False, reason="'P1' is no code", hint="it must look like P01")


async def test_enter_with_a_wrong_code_says_what_is_wrong_with_the_code() -> None:
    first = scenes.welcome(
        state=[scenes.start("", "")], settings={"study": study_scene.study_description()}
    )
    async with piloted_console(first) as pilot:
        pilot.feed.answers[AskProposal] = lambda asked, ref: msgspec.structs.replace(
            REFUSED, ref=ref
        )
        await named(pilot, "P1")
        await pilot.press("enter")
        await pilot.settle()
        assert "'P1' is no code: it must look like P01" in pilot.drawn()


def last(pilot: ConsolePilot) -> AskAssign:
    asked = pilot.feed.last(AskAssign)
    assert isinstance(asked, AskAssign)
    return asked


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_a_code_brings_its_order_and_enter_accepts_it(size: tuple[int, int]) -> None:
    async with piloted_console(study_scene.welcome(), size=size) as pilot:
        propose(pilot)
        await named(pilot)
        asked = pilot.feed.last(AskProposal)
        assert isinstance(asked, AskProposal)
        assert asked.participant == "P08"
        drawn = pilot.drawn()
        for part in ("1. cold", "2. warm", "next: trial 1 in cold", "latin-square", "so far"):
            assert part in drawn, part
        await pilot.press("enter")
        assert (last(pilot).participant, last(pilot).order) == ("P08", ["cold", "warm"])
        assert pilot.feed.last(r.AskSet) is None
        assert pilot.console.dialog is None


async def test_a_proposed_order_is_accepted_whatever_its_conditions_are_called() -> None:
    names = ["slow, calm", "fast"]
    async with piloted_console(
        msgspec.structs.replace(study_scene.welcome(), conditions=names)
    ) as pilot:
        propose(pilot, order=[*names], condition=names[0])
        await named(pilot)
        await pilot.press("enter")
        assert last(pilot).order == names


async def test_enter_before_the_proposal_has_come_accepts_it_when_it_comes() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        late: list[int] = []

        def answer(asked: r.Request, ref: int) -> r.Reply:
            late.append(ref)
            return r.Reply(ref=0, ok=True)  # to nobody

        pilot.feed.answers[AskProposal] = answer
        await named(pilot)
        await pilot.press("enter")
        await pilot.settle()
        assert pilot.feed.last(AskAssign) is pilot.feed.last(r.AskSet) is None
        await pilot.tell(r.Reply(ref=late[-1], ok=True, data=DATA))
        await pilot.until(lambda: pilot.console.dialog is None)
        assert (last(pilot).participant, last(pilot).order) == ("P08", ["cold", "warm"])
        assert pilot.feed.last(r.AskSet) is None


async def test_an_incomplete_code_has_no_order() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:

        def answer(asked: r.Request, ref: int) -> r.Reply:
            assert isinstance(asked, AskProposal)
            if asked.participant != "P08":
                return r.Reply(ref=ref, ok=False, reason="it does not match the pattern")
            return r.Reply(ref=ref, ok=True, data=DATA)

        pilot.feed.answers[AskProposal] = answer
        await named(pilot, "P0")
        assert "Proposed" not in pilot.drawn()
        await pilot.type("8")
        await pilot.until(lambda: "Proposed" in pilot.drawn())


async def test_another_order_is_written_by_hand() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        propose(pilot)
        await named(pilot)
        order = pilot.console.screen.query_one("#order", Input)
        order.value = "warm, colt"
        await pilot.press("enter")
        assert "There is no condition 'colt'" in pilot.drawn()
        order.value = "warm, cold"
        await pilot.press("enter")
        assert last(pilot).order == ["warm", "cold"]


async def test_who_gets_one_condition_is_offered_a_choice() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        propose(pilot, order=["cold"])
        await named(pilot)
        await pilot.press("enter")
        assert last(pilot).order == ["cold"]


async def test_one_condition_is_chosen_by_hand() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        propose(pilot, order=["cold"])
        await named(pilot)
        await pilot.press("tab", "up", "enter")
        await pilot.press("tab", "enter")
        assert last(pilot).order == ["warm"]


async def test_another_trial_is_set_behind_the_order() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        propose(pilot, trial=3)
        await named(pilot)
        trial = pilot.console.screen.query_one("#trial", Input)
        assert trial.value == "3"
        trial.value = "2"
        await pilot.press("enter")
        asked = pilot.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert (asked.participant, asked.condition, asked.trial) == (None, None, 2)


async def test_who_has_the_order_already_gets_only_another_trial() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        propose(pilot, order=["warm", "cold"], condition="warm", trial=4)
        await open_dialog(pilot, "StartDialog")
        await pilot.settle()
        await pilot.press("enter")
        assert pilot.feed.last(AskAssign) is None
        asked = pilot.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert (asked.participant, asked.condition, asked.trial) == (None, None, 4)


async def test_a_refused_order_keeps_the_dialog_open() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        propose(pilot)
        pilot.feed.answers[AskAssign] = lambda asked, ref: r.Reply(
            ref=ref, ok=False, reason="a trial is under way"
        )
        await named(pilot)
        await pilot.press("enter")
        assert "a trial is under way" in pilot.drawn()


async def test_without_a_design_nothing_is_proposed() -> None:
    async with piloted_console(scenes.welcome()) as pilot:
        await named(pilot)
        assert pilot.feed.last(AskProposal) is None
        await pilot.press("tab", "down", "enter")
        await pilot.until(lambda: pilot.console.dialog is None)
        asked = pilot.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert (asked.participant, asked.condition) == ("P08", "warm")


def test_what_is_no_proposal_is_none() -> None:
    nothing: list[m.Json] = [None, [], "x", {}, {"order": []}, {"order": 3}]
    for data in nothing:
        assert proposal_of(data) is None
    found = proposal_of({"order": ["a"], "trial": "x", "row": None})
    assert found is not None
    assert (found.order, found.trial, found.row) == (("a",), None, -1)


async def crashed(pilot: ConsolePilot, session: str) -> None:
    """The robot process is lost, and the one of `session` is there, with nobody chosen; its log
    is another file than before, as behind a full disk.
    """
    pilot.feed.cut("the robot process closed the connection")
    await pilot.until(lambda: isinstance(pilot.console.dialog, LostDialog))
    start = msgspec.structs.replace(scenes.start("", ""), session=session)
    plain = scenes.welcome([start], settings={"study": study_scene.study_description()})
    pilot.feed.deliver(msgspec.structs.replace(plain, log="recordings/another.jsonl"))
    await pilot.until(lambda: not pilot.console.state.lost)
    await pilot.settle()


async def test_after_a_crash_who_takes_part_is_asked_again_and_filled_in() -> None:
    first = scenes.welcome(
        [scenes.start("", "")], settings={"study": study_scene.study_description()}
    )
    async with piloted_console(first, ask_participant=True) as pilot:
        propose(pilot)
        await pilot.until(lambda: isinstance(pilot.console.dialog, StartDialog))
        await pilot.press("ctrl+q")
        await pilot.tell(m.SessionChanged(participant="P09", condition="warm", trial=2))
        await crashed(pilot, "S02")
        await pilot.until(lambda: isinstance(pilot.console.dialog, StartDialog))
        await pilot.settle()
        assert pilot.console.screen.query_one("#participant", Input).value == "P09"
        asked = pilot.feed.last(AskProposal)
        assert isinstance(asked, AskProposal)
        assert asked.participant == "P09"
        await pilot.until(lambda: "1. cold" in pilot.drawn())
        await pilot.press("enter")
        await pilot.until(lambda: pilot.feed.last(AskAssign) is not None)
        assigned = pilot.feed.last(AskAssign)
        assert isinstance(assigned, AskAssign)
        assert (assigned.participant, assigned.order) == ("P09", ["cold", "warm"])


@pytest.mark.parametrize(("asks", "session"), [(True, "S01"), (False, "S02")])
async def test_nobody_is_asked_again_in_the_same_session_or_where_nobody_was(
    asks: bool, session: str
) -> None:
    first = scenes.welcome(
        [scenes.start("", "")], settings={"study": study_scene.study_description()}
    )
    async with piloted_console(first, ask_participant=asks) as pilot:
        if asks:
            await pilot.until(lambda: isinstance(pilot.console.dialog, StartDialog))
            await pilot.press("ctrl+q")
        await crashed(pilot, session)
        assert pilot.console.dialog is None
