"""What a console shows that watches, when the one that played is gone."""

from __future__ import annotations

from tests.console import scenes
from tests.console.driving import sitting
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

NOW = scenes.NOW


async def test_it_says_that_nobody_plays_and_which_key_takes_over() -> None:
    there = m.ConsoleAttached(console="console1", role="wizard", t=NOW)
    async with sitting(scenes.welcome(state=[*scenes.healthy(), there])) as seat:
        await seat.tell(
            m.ConsoleLost(console="console1", role="wizard", why="taken over", t=NOW),
            m.ConsoleAttached(console="con2", role="wizard", t=NOW),
        )
        assert "WATCHING" in seat.text("StatusLines")
        assert "Nobody plays" not in seat.drawn()
        await seat.tell(m.ConsoleLost(console="con2", role="wizard", why="closed", t=NOW))
        assert "NOBODY PLAYS" in seat.text("StatusLines")
        assert "Nobody plays the robot. End" in seat.text("StopBar")
        await seat.press("end")
        assert isinstance(seat.feed.asked[-1], r.AskTakeOver)
        await seat.tell(m.ConsoleAttached(console="console1", role="wizard", t=NOW))
        assert "NOBODY PLAYS" not in seat.drawn()
        assert "Nobody plays" not in seat.drawn()


async def test_a_late_watcher_sees_it_too() -> None:
    there = m.ConsoleAttached(console="console1", role="watcher", t=NOW)
    first = scenes.welcome(state=[*scenes.healthy(), there], role="watcher")
    async with sitting(first) as seat:
        assert "NOBODY PLAYS" in seat.text("StatusLines")


async def test_a_watcher_sees_the_trial_with_its_time_on_a_small_screen() -> None:
    """The title makes room: who watches over several sessions needs the trial."""
    there = m.ConsoleAttached(console="console2", role="wizard", t=NOW)
    study: dict[str, m.Json] = {"design": {"kind": "latin-square", "within": True, "trials": 1}}
    begun = m.TrialStarted(trial=1, t=NOW - 316 * scenes.SECOND)
    first = scenes.welcome(
        state=[*scenes.healthy(), there, begun], role="watcher", settings={"study": study}
    )
    async with sitting(first, size=(80, 24)) as seat:
        top = seat.text("StatusLines").splitlines()[0]
        assert "WATCHING" in top
        assert "trial 1" in top
        assert "05:16" in top
