"""What the feed's thread sets off on the screen."""

from __future__ import annotations

from dataclasses import replace

from tests.console import scenes
from tests.console.driving import sitting
from woz_tui.config.keys.console_keys import BUILTIN_KEYS
from woz_tui.console.screens.lost import LostDialog
from woz_tui.console.screens.note import NoteDialog
from woz_tui.console.screens.release import ReleaseDialog
from woz_tui.protocol import messages as m

NOW = scenes.NOW


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


async def test_news_of_a_loss_are_not_hidden_by_what_was_told_of_the_keys_before() -> None:
    moved = tuple(replace(key, chord="h") if key.id == "say" else key for key in BUILTIN_KEYS)
    async with sitting(builtins=moved) as seat:
        assert "which the experiment uses" in seat.text("StopBar")
        seat.feed.cut("the line was cut")
        await seat.until(lambda: isinstance(seat.console.dialog, LostDialog))
        await seat.press("escape")
        await seat.tell(scenes.welcome())
        assert "the stop is not pressed: press it again" in seat.text("StopBar")


async def test_the_enter_for_a_note_starts_no_robot_process_that_was_lost_meanwhile() -> None:
    began: list[int] = []
    async with sitting(restart=lambda: began.append(1)) as seat:
        await seat.press("comma")
        await seat.until(lambda: isinstance(seat.console.dialog, NoteDialog))
        seat.feed.cut("gone")
        await seat.until(lambda: isinstance(seat.console.dialog, LostDialog))
        await seat.press("enter")
        assert began == []


async def test_a_stop_that_ended_with_the_robot_process_is_told_when_it_is_back() -> None:
    confirmed = m.StopConfirmed(confirmed=["voice", "head"], missing=[], elapsed_us=9, t=NOW)
    for still in (False, True):
        pressed = m.StopPressed(source="key", t=NOW)
        async with sitting() as seat:
            await seat.tell(pressed, confirmed)
            seat.feed.cut("it closed the connection")
            await seat.until(lambda: isinstance(seat.console.dialog, LostDialog))
            state = [*scenes.healthy(), *([pressed, confirmed] if still else [])]
            await seat.tell(scenes.welcome(state))
            assert ("not pressed any more" in seat.text("StopBar")) is (not still)
            events = [line.text for line in seat.console.state.events]
            assert ("The stop is not pressed any more" in events) is (not still)


async def test_a_stop_pressed_during_a_loss_is_not_delivered_whatever_stood_before() -> None:
    confirmed = m.StopConfirmed(confirmed=["voice", "head"], missing=[], elapsed_us=9, t=NOW)
    async with sitting() as seat:
        await seat.tell(m.StopPressed(source="key", t=NOW), confirmed)
        seat.feed.cut("it closed the connection")
        await seat.until(lambda: isinstance(seat.console.dialog, LostDialog))
        await seat.press("escape")
        seat.console.paint()
        assert "STOP NOT DELIVERED" in seat.text("StopBar")
        await seat.press("ctrl+r")
        assert seat.console.dialog is None, "it would release the stop once the line is back"
        await seat.tell(scenes.welcome(scenes.healthy()))
        assert "the stop is not pressed: press it again" in seat.text("StopBar")


async def test_a_robot_process_that_is_back_before_anything_is_painted_is_not_lost() -> None:
    async with sitting() as seat:
        seat.feed.cut("the robot process closed the connection")
        seat.feed.deliver(scenes.welcome())
        await seat.settle()
        seat.console.paint()
        await seat.settle()
        assert seat.console.state.lost is None
        assert seat.console.dialog is None
        assert "is back" in seat.text("StopBar")


async def test_what_said_that_the_robot_is_lost_goes_also_from_below_another_dialog() -> None:
    missing = m.StopConfirmed(confirmed=["voice"], missing=["head"], elapsed_us=9, t=NOW)
    async with sitting() as seat:
        await seat.tell(m.StopPressed(source="key", t=NOW), missing)
        seat.feed.cut("the line was cut")
        await seat.until(lambda: isinstance(seat.console.dialog, LostDialog))
        await seat.press("ctrl+r")
        assert isinstance(seat.console.dialog, ReleaseDialog)
        await seat.tell(scenes.welcome())
        await seat.settle()
        assert seat.console.dialog is None
