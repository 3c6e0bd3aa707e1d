"""The start dialog where nothing is proposed: who takes part, and under which condition."""

from __future__ import annotations

from tests.console import scenes
from tests.console.dialogs import named, open_dialog
from tests.console.piloting import piloted_console
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r


async def test_it_says_who_plays_and_how_another_wizard_says_so() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "StartDialog")
        await pilot.until(lambda: "Wizard W2; another: woz run --wizard CODE" in pilot.drawn())
        assert "ctrl+q closes" in pilot.drawn(), "the hint has room in 80 columns"


async def test_enter_on_a_condition_chooses_it_and_accepts() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "StartDialog")
        await pilot.press("tab", "down", "enter")
        await pilot.until(lambda: pilot.console.dialog is None)
        asked = pilot.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert asked.condition == "cold"


async def test_what_looks_chosen_is_chosen() -> None:
    """No condition is lit that enter, or enter in the next field, would not take."""
    first = scenes.welcome(state=[scenes.start("P07", "")])
    async with piloted_console(first) as pilot:
        await open_dialog(pilot, "StartDialog")
        await pilot.press("tab")
        assert not pilot.console.screen.query(".-selected")
        await pilot.press("enter")
        assert "Choose a condition" in pilot.drawn()
        assert "arrows: condition" in pilot.drawn()
        await pilot.press("down", "down", "tab", "enter")
        await pilot.until(lambda: pilot.console.dialog is None)
        asked = pilot.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert asked.condition == "cold"


async def test_enter_on_the_conditions_takes_the_one_that_is_chosen() -> None:
    async with piloted_console(scenes.welcome(state=[scenes.start("P07", "cold")])) as pilot:
        await open_dialog(pilot, "StartDialog")
        await pilot.press("tab", "enter")
        await pilot.until(lambda: pilot.console.dialog is None)
        asked = pilot.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert asked.condition == "cold"


async def test_somebody_else_gets_neither_trial_nor_condition_of_the_one_before() -> None:
    """Without a design nothing is proposed."""
    third = m.SessionChanged(trial=3, participant="P07", condition="cold", t=scenes.NOW)
    async with piloted_console(scenes.welcome(state=[scenes.start("P07", "cold"), third])) as pilot:
        await named(pilot, "P08")
        await pilot.press("enter")
        assert pilot.feed.last(r.AskSet) is None
        assert "Choose a condition" in pilot.drawn()
        await pilot.press("tab", "down", "enter")
        await pilot.until(lambda: pilot.console.dialog is None)
        asked = pilot.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert (asked.participant, asked.trial) == ("P08", None)
        assert asked.condition in ("warm", "cold")
