"""The list of what is queued, as a wizard sees it."""

from __future__ import annotations

from tests.console import scenes
from tests.console.driving import sitting
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

NOW = scenes.NOW


def asked(run: str, action: str, t: int) -> list[m.AnyMessage]:
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
    async with sitting(scenes.welcome(state=[*scenes.healthy()])) as seat:
        await seat.press("ctrl+j")
        assert "Nothing is queued" in seat.drawn()
        await seat.tell(
            *asked("r1", "Hello", NOW),
            m.Dispatched(command="cr1", driver="head", latency_us=1, t=NOW),
            *asked("r2", "Map", NOW),
        )
        await seat.pass_time(3)
        drawn = seat.drawn()
        (waits,) = [line for line in drawn.splitlines() if "3.0 s" in line and "Map" in line]
        assert "Hello" not in waits
        assert "Del" in drawn
        await seat.press("delete")
        assert isinstance(seat.feed.asked[-1], r.AskEmptyQueue)
        await seat.tell(
            m.Stopped(command="cr2", driver="head", reason="queue emptied by wizard con1", t=NOW),
            m.ActionStopped(run="r2", action="Map", reason="queue emptied by wizard con1", t=NOW),
        )
        assert "Nothing is queued" in seat.drawn()


async def test_the_lowest_line_names_the_queue_while_something_waits() -> None:
    async with sitting(scenes.welcome(state=[*scenes.healthy()])) as seat:
        assert " queue" not in seat.text("StopBar")
        await seat.tell(*asked("r1", "Hello", NOW))
        assert " queue" in seat.text("StopBar")
