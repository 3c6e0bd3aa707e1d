"""What a console shows that watches, when the one that played is gone."""

from __future__ import annotations

from tests.console import scenes
from tests.console.piloting import piloted_console
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

NOW = scenes.NOW


async def test_it_says_that_nobody_plays_and_which_key_takes_over() -> None:
    there = m.ConsoleAttached(console="console1", role="wizard", t=NOW)
    async with piloted_console(scenes.welcome(state=[*scenes.healthy(), there])) as pilot:
        await pilot.tell(
            m.ConsoleLost(console="console1", role="wizard", why="taken over", t=NOW),
            m.ConsoleAttached(console="con2", role="wizard", t=NOW),
        )
        assert "WATCHING" in pilot.text("StatusLines")
        assert "Nobody plays" not in pilot.drawn()
        await pilot.tell(m.ConsoleLost(console="con2", role="wizard", why="closed", t=NOW))
        assert "NOBODY PLAYS" in pilot.text("StatusLines")
        assert "Nobody plays the robot. End" in pilot.text("StopBar")
        await pilot.press("end")
        assert isinstance(pilot.feed.asked[-1], r.AskTakeOver)
        await pilot.tell(m.ConsoleAttached(console="console1", role="wizard", t=NOW))
        assert "NOBODY PLAYS" not in pilot.drawn()
        assert "Nobody plays" not in pilot.drawn()


async def test_a_late_watcher_sees_it_too() -> None:
    there = m.ConsoleAttached(console="console1", role="watcher", t=NOW)
    first = scenes.welcome(state=[*scenes.healthy(), there], role="watcher")
    async with piloted_console(first) as pilot:
        assert "NOBODY PLAYS" in pilot.text("StatusLines")


async def test_a_watcher_sees_the_trial_with_its_time_on_a_small_screen() -> None:
    """The title makes room: who watches over several sessions needs the trial."""
    there = m.ConsoleAttached(console="console2", role="wizard", t=NOW)
    study: dict[str, m.Json] = {"design": {"kind": "latin-square", "within": True, "trials": 1}}
    trial_started = m.TrialStarted(trial=1, t=NOW - 316 * scenes.SECOND)
    first = scenes.welcome(
        state=[*scenes.healthy(), there, trial_started], role="watcher", settings={"study": study}
    )
    async with piloted_console(first, size=(80, 24)) as pilot:
        top = pilot.text("StatusLines").splitlines()[0]
        assert "WATCHING" in top
        assert "trial 1" in top
        assert "05:16" in top
