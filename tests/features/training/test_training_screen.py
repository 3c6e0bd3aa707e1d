"""A training on the wizard's screen: it waits for a key, shows cues large, and the score."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from tests.console import scenes, study_scene
from tests.console.piloting import piloted_console
from woz_tui.features.training.dialog import BeginDialog, ScoreDialog
from woz_tui.features.training.kinds import AskTraining, CueAnswered, CueGiven, TrainingChanged
from woz_tui.protocol import requests as r

NOW = scenes.NOW
WAITS = TrainingChanged(state="waits", planned=20, t=NOW)
RUNS = TrainingChanged(state="runs", planned=20, t=NOW)
OVER = TrainingChanged(
    state="over", planned=5, right=3, wrong=1, missed=1, uncalled=2, median_us=1_240_000, t=NOW
)
CUE = CueGiven(
    cue="q1", sort="question", text="How old is it?", expects=["Map"], window_us=4_000_000, t=NOW
)


async def test_it_waits_for_the_key_that_begins_it() -> None:
    async with piloted_console() as pilot:
        await pilot.tell(WAITS)
        await pilot.until(lambda: isinstance(pilot.console.dialog, BeginDialog))
        await pilot.settle()
        assert "20 cues" in pilot.drawn()
        assert pilot.feed.last(AskTraining) is None
        await pilot.press("enter")
        assert isinstance(pilot.feed.last(AskTraining), AskTraining)


async def test_who_looks_at_the_keys_first_begins_it_later() -> None:
    async with piloted_console(scenes.welcome(state=[*scenes.healthy(), WAITS])) as pilot:
        await pilot.until(lambda: isinstance(pilot.console.dialog, BeginDialog))
        await pilot.settle()
        await pilot.press("down", "enter")
        await pilot.until(lambda: pilot.console.dialog is None)
        assert pilot.feed.last(AskTraining) is None
        await pilot.press("asterisk")
        await pilot.until(lambda: isinstance(pilot.console.dialog, BeginDialog))


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_the_cue_stands_large_above_the_panels(size: tuple[int, int]) -> None:
    async with piloted_console(size=size) as pilot:
        assert not pilot.console._main_screen.boards[0].display
        await pilot.tell(RUNS)
        await pilot.until(lambda: "first cue" in pilot.text("FeatureBoard"))
        await pilot.tell(CUE)
        board = pilot.text("FeatureBoard")
        assert "How old is it?" in board
        assert pilot.console._main_screen.boards[0].size.height >= 3
        assert "Hello" in pilot.text("ActionPanels")
        await pilot.tell(CueAnswered(cue="q1", judged="wrong", reaction_us=900_000, t=NOW))
        assert "How old is it?" not in pilot.text("FeatureBoard")
        assert "wrong" in pilot.text("FeatureBoard")


async def test_a_long_cue_is_readable_as_a_whole_on_a_small_screen() -> None:
    text = "Could you tell me how old this enormous blue whale was when it was found, please?"
    async with piloted_console(size=(80, 24)) as pilot:
        await pilot.tell(RUNS, replace(CUE, text=text))
        board = pilot.text("FeatureBoard")
        assert all(word in board for word in text.split())


async def test_a_stop_in_a_training_makes_a_cue_void_and_the_list_counts_it_no_more() -> None:
    async with piloted_console() as pilot:
        await pilot.tell(RUNS, replace(OVER, planned=20))
        await pilot.until(lambda: isinstance(pilot.console.dialog, ScoreDialog))
        assert "3 of 5 cues" in pilot.text("EventList")


async def test_the_row_of_what_comes_next_names_the_training_and_no_trial() -> None:
    """Also where the file has trials: the same key begins both."""
    async with piloted_console(replace(study_scene.welcome(), script=[])) as pilot:
        assert "*  begins trial" in pilot.text("StopBar")
        await pilot.tell(WAITS)
        assert "*  begins the training" in pilot.text("StopBar")
        await pilot.tell(RUNS)
        assert "no trials in a training" in pilot.text("StopBar")


async def test_the_score_stands_on_the_screen_at_the_end() -> None:
    async with piloted_console() as pilot:
        await pilot.tell(OVER)
        await pilot.until(lambda: isinstance(pilot.console.dialog, ScoreDialog))
        await pilot.settle()
        drawn = pilot.drawn()
        wrong = "wrong 1, missed 1, pressed without a cue 2"
        for part in ("60 %", "3 of 5 right", wrong, "1.24 s"):
            assert part in drawn
        await pilot.press("down", "enter")
        assert isinstance(pilot.feed.last(r.AskEnd), r.AskEnd)


async def test_an_enter_for_a_note_does_not_end_the_training() -> None:
    async with piloted_console() as pilot:
        await pilot.tell(OVER)
        await pilot.until(lambda: isinstance(pilot.console.dialog, ScoreDialog))
        await pilot.press("enter")
        await pilot.until(lambda: pilot.console.dialog is None)
        assert pilot.feed.last(r.AskEnd) is None


async def test_who_watches_is_not_asked() -> None:
    first = scenes.welcome(role="watcher", state=[*scenes.healthy(), WAITS])
    async with piloted_console(first) as pilot:
        assert pilot.console.dialog is None


@pytest.mark.parametrize(
    ("judged", "reaction_us", "told", "listed"),
    [
        ("right", 1_240_000, "right, 1.2 s", "✓ Cue answered  1.2 s"),
        ("wrong", 2_000_000, "wrong, 2.0 s; right: Map (m)", "wrongly  2.0 s, right: Map"),
        ("missed", -1, "missed; right: Map (m)", "▲ Cue missed  right: Map"),
        ("uncalled", -1, "no cue was waiting", "▲ No cue was waiting"),
    ],
)
async def test_a_trainee_is_told_how_it_was(
    judged: str, reaction_us: int, told: str, listed: str
) -> None:
    async with piloted_console(study_scene.welcome(), size=(160, 50)) as pilot:
        cue_given = CueGiven(
            cue="q1", sort="question", text="where is it?", expects=["Map"], window_us=1, t=NOW
        )
        await pilot.tell(cue_given)
        assert "Cue: question" in pilot.text("EventList")
        assert "Map" not in pilot.text("EventList")
        await pilot.tell(CueAnswered(cue="q1", judged=judged, reaction_us=reaction_us, t=NOW))
        assert told in pilot.text("StopBar")
        assert listed in pilot.text("EventList")


async def test_the_label_and_the_key_of_each_right_answer_is_told() -> None:
    async with piloted_console(study_scene.welcome(), size=(160, 50)) as pilot:
        expects = ["Map", "gone from the file"]
        await pilot.tell(CueGiven(cue="q2", sort="leave", expects=expects, window_us=1, t=NOW))
        await pilot.tell(CueAnswered(cue="q2", judged="missed", t=NOW))
        assert "missed; right: Map (m) or gone from the file" in pilot.text("StopBar")


async def test_a_verdict_on_another_cue_names_nothing() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await pilot.tell(CueGiven(cue="q2", sort="leave", expects=["Map"], window_us=1, t=NOW))
        await pilot.tell(CueAnswered(cue="q1", judged="missed", t=NOW))
        assert "missed" in pilot.text("StopBar")
        assert "right" not in pilot.text("StopBar")
