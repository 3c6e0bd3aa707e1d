"""What the feed's thread sets off on the screen."""

from __future__ import annotations

from tests.console import scenes
from tests.console.driving import sitting
from woz_tui.console.screens.lost import LostDialog


async def test_a_painting_that_another_thread_wakes_may_open_a_dialog() -> None:
    async with sitting() as seat:
        seat.clock.advance(1.0)  # the last painting is old: the loss is painted at once
        seat.feed.cut("the robot process closed the connection")
        await seat.until(lambda: isinstance(seat.console.dialog, LostDialog))
        await seat.until(lambda: "The robot process is gone" in seat.drawn())


async def test_a_stop_that_did_not_arrive_is_told_when_the_line_is_back() -> None:
    async with sitting() as seat:
        seat.feed.cut("the line was cut")
        await seat.until(lambda: isinstance(seat.console.dialog, LostDialog))
        await seat.press("escape")
        await seat.until(lambda: "STOP NOT DELIVERED" in seat.text("StopBar"))
        await seat.tell(scenes.welcome())
        assert "STOP SENT" not in seat.text("StopBar")
        assert "the stop is not pressed: press it again" in seat.text("StopBar")
