"""A training on the wizard's screen: it waits for a key, shows cues large, and the score."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from tests.console import scenes
from tests.console.driving import sitting
from woz_tui.console.screens.training import BeginDialog, ScoreDialog
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

NOW = scenes.NOW
WAITS = m.TrainingChanged(state="waits", planned=20, t=NOW)
RUNS = m.TrainingChanged(state="runs", planned=20, t=NOW)
OVER = m.TrainingChanged(
    state="over", planned=5, right=3, wrong=1, missed=1, uncalled=2, median_us=1_240_000, t=NOW
)
CUE = m.CueGiven(
    cue="q1", sort="question", text="How old is it?", expects=["Map"], window_us=4_000_000, t=NOW
)


async def test_it_waits_for_the_key_that_begins_it() -> None:
    async with sitting() as seat:
        await seat.tell(WAITS)
        await seat.until(lambda: isinstance(seat.console.dialog, BeginDialog))
        await seat.settle()
        assert "20 cues" in seat.drawn()
        assert seat.feed.last(r.AskTraining) is None
        await seat.press("enter")
        assert isinstance(seat.feed.last(r.AskTraining), r.AskTraining)


async def test_who_looks_at_the_keys_first_begins_it_later() -> None:
    async with sitting(scenes.welcome(state=[*scenes.healthy(), WAITS])) as seat:
        await seat.until(lambda: isinstance(seat.console.dialog, BeginDialog))
        await seat.settle()
        await seat.press("down", "enter")
        await seat.until(lambda: seat.console.dialog is None)
        assert seat.feed.last(r.AskTraining) is None
        await seat.press("asterisk")
        await seat.until(lambda: isinstance(seat.console.dialog, BeginDialog))


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_the_cue_stands_large_above_the_panels(size: tuple[int, int]) -> None:
    async with sitting(size=size) as seat:
        assert not seat.console._main_screen.cue.display
        await seat.tell(RUNS)
        await seat.until(lambda: "first cue" in seat.text("CueBoard"))
        await seat.tell(CUE)
        board = seat.text("CueBoard")
        assert "How old is it?" in board
        assert seat.console._main_screen.cue.size.height >= 3
        assert "Hello" in seat.text("ActionPanels")
        await seat.tell(m.CueAnswered(cue="q1", judged="wrong", reaction_us=900_000, t=NOW))
        assert "How old is it?" not in seat.text("CueBoard")
        assert "wrong" in seat.text("CueBoard")


async def test_a_long_cue_is_readable_as_a_whole_on_a_small_screen() -> None:
    text = "Could you tell me how old this enormous blue whale was when it was found, please?"
    async with sitting(size=(80, 24)) as seat:
        await seat.tell(RUNS, replace(CUE, text=text))
        board = seat.text("CueBoard")
        assert all(word in board for word in text.split())


async def test_a_stop_in_a_training_makes_a_cue_void_and_the_list_counts_it_no_more() -> None:
    async with sitting() as seat:
        await seat.tell(RUNS, replace(OVER, planned=20))
        await seat.until(lambda: isinstance(seat.console.dialog, ScoreDialog))
        assert "3 of 5 cues" in seat.text("EventList")


async def test_the_score_stands_on_the_screen_at_the_end() -> None:
    async with sitting() as seat:
        await seat.tell(OVER)
        await seat.until(lambda: isinstance(seat.console.dialog, ScoreDialog))
        await seat.settle()
        drawn = seat.drawn()
        wrong = "wrong 1, missed 1, pressed without a cue 2"
        for part in ("60%", "3 of 5 right", wrong, "1.24 s"):
            assert part in drawn
        await seat.press("down", "enter")
        assert isinstance(seat.feed.last(r.AskEnd), r.AskEnd)


async def test_an_enter_for_a_note_does_not_end_the_training() -> None:
    async with sitting() as seat:
        await seat.tell(OVER)
        await seat.until(lambda: isinstance(seat.console.dialog, ScoreDialog))
        await seat.press("enter")
        await seat.until(lambda: seat.console.dialog is None)
        assert seat.feed.last(r.AskEnd) is None


async def test_who_watches_is_not_asked() -> None:
    first = scenes.welcome(role="watcher", state=[*scenes.healthy(), WAITS])
    async with sitting(first) as seat:
        assert seat.console.dialog is None
