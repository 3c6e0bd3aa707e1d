"""The list of what is queued, as a wizard sees it."""

from __future__ import annotations

from tests.console import scenes
from tests.console.piloting import piloted_console
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

NOW = scenes.NOW


def queued_action(run: str, action: str, t: int) -> list[m.Message]:
    return [
        m.ActionRequested(run=run, action=action, source="key", t=t),
        m.Command(
            command=f"c{run}",
            run=run,
            action=action,
            verb="say",
            args={"text": action},
            driver="head",
            source="key",
            t=t,
        ),
    ]


async def test_the_queue_names_who_waits_where_and_for_how_long() -> None:
    async with piloted_console(scenes.welcome(state=[*scenes.healthy()])) as pilot:
        await pilot.press("ctrl+j")
        assert "Nothing is queued" in pilot.drawn()
        await pilot.tell(
            *queued_action("r1", "Hello", NOW),
            m.Dispatched(command="cr1", driver="head", latency_us=1, t=NOW),
            *queued_action("r2", "Map", NOW),
        )
        await pilot.pass_time(3)
        drawn = pilot.drawn()
        (waits,) = [line for line in drawn.splitlines() if "3.0 s" in line and "Map" in line]
        assert "Hello" not in waits
        assert "Del" in drawn
        await pilot.press("delete")
        assert isinstance(pilot.feed.asked[-1], r.AskEmptyQueue)
        await pilot.tell(
            m.Stopped(command="cr2", driver="head", reason="queue emptied by the wizard", t=NOW),
            m.ActionStopped(run="r2", action="Map", reason="queue emptied by the wizard", t=NOW),
        )
        assert "Nothing is queued" in pilot.drawn()


async def test_the_lowest_line_names_the_queue_while_something_waits() -> None:
    async with piloted_console(scenes.welcome(state=[*scenes.healthy()])) as pilot:
        assert " queue" not in pilot.text("StopBar")
        await pilot.tell(*queued_action("r1", "Hello", NOW))
        assert " queue" in pilot.text("StopBar")
