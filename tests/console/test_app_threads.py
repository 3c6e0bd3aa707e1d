"""What the feed's thread sets off on the screen."""

from __future__ import annotations

from tests.console.driving import sitting
from woz_tui.console.screens.lost import LostDialog


async def test_a_painting_that_another_thread_wakes_may_open_a_dialog() -> None:
    async with sitting() as seat:
        seat.clock.advance(1.0)  # the last painting is old: the loss is painted at once
        seat.feed.cut("the robot process closed the connection")
        await seat.until(lambda: isinstance(seat.console.dialog, LostDialog))
        await seat.until(lambda: "The robot process is gone" in seat.drawn())
