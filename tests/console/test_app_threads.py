"""What the feed's thread sets off on the screen."""

from __future__ import annotations

from dataclasses import replace

from tests.console import scenes
from tests.console.piloting import piloted_console
from woz_tui.config.keys.console_keys import BUILTIN_KEYS
from woz_tui.console.screens.lost import LostDialog
from woz_tui.console.screens.note import NoteDialog
from woz_tui.console.screens.release import ReleaseDialog
from woz_tui.protocol import messages as m

NOW = scenes.NOW


async def test_a_painting_that_another_thread_wakes_may_open_a_dialog() -> None:
    async with piloted_console() as pilot:
        pilot.clock.advance(1.0)  # the last painting is old: the loss is painted at once
        pilot.feed.cut("the robot process closed the connection")
        await pilot.until(lambda: isinstance(pilot.console.dialog, LostDialog))
        await pilot.until(lambda: "The robot process is gone" in pilot.drawn())


async def test_a_stop_that_did_not_arrive_is_told_when_the_line_is_back() -> None:
    async with piloted_console() as pilot:
        pilot.feed.cut("the line was cut")
        await pilot.until(lambda: isinstance(pilot.console.dialog, LostDialog))
        await pilot.press("escape")
        await pilot.until(lambda: "STOP NOT DELIVERED" in pilot.text("StopBar"))
        await pilot.tell(scenes.welcome())
        assert "STOP SENT" not in pilot.text("StopBar")
        assert "the stop is not pressed: press it again" in pilot.text("StopBar")


async def test_news_of_a_loss_are_not_hidden_by_what_was_told_of_the_keys_before() -> None:
    moved = tuple(replace(key, chord="h") if key.id == "say" else key for key in BUILTIN_KEYS)
    async with piloted_console(builtins=moved) as pilot:
        assert "which the experiment uses" in pilot.text("StopBar")
        pilot.feed.cut("the line was cut")
        await pilot.until(lambda: isinstance(pilot.console.dialog, LostDialog))
        await pilot.press("escape")
        await pilot.tell(scenes.welcome())
        assert "the stop is not pressed: press it again" in pilot.text("StopBar")


async def test_the_enter_for_a_note_starts_no_robot_process_that_was_lost_meanwhile() -> None:
    began: list[int] = []
    async with piloted_console(restart=lambda: began.append(1)) as pilot:
        await pilot.press("comma")
        await pilot.until(lambda: isinstance(pilot.console.dialog, NoteDialog))
        pilot.feed.cut("gone")
        await pilot.until(lambda: isinstance(pilot.console.dialog, LostDialog))
        await pilot.press("enter")
        assert began == []


async def test_a_stop_that_ended_with_the_robot_process_is_told_when_it_is_back() -> None:
    confirmed = m.StopConfirmed(confirmed=["voice", "head"], missing=[], elapsed_us=9, t=NOW)
    for still in (False, True):
        pressed = m.StopPressed(source="key", t=NOW)
        async with piloted_console() as pilot:
            await pilot.tell(pressed, confirmed)
            pilot.feed.cut("it closed the connection")
            await pilot.until(lambda: isinstance(pilot.console.dialog, LostDialog))
            state = [*scenes.healthy(), *([pressed, confirmed] if still else [])]
            await pilot.tell(scenes.welcome(state))
            assert ("not pressed any more" in pilot.text("StopBar")) is (not still)
            events = [line.text for line in pilot.console.state.events]
            assert ("The stop is not pressed any more" in events) is (not still)


async def test_a_stop_pressed_during_a_loss_is_not_delivered_whatever_stood_before() -> None:
    confirmed = m.StopConfirmed(confirmed=["voice", "head"], missing=[], elapsed_us=9, t=NOW)
    async with piloted_console() as pilot:
        await pilot.tell(m.StopPressed(source="key", t=NOW), confirmed)
        pilot.feed.cut("it closed the connection")
        await pilot.until(lambda: isinstance(pilot.console.dialog, LostDialog))
        await pilot.press("escape")
        pilot.console.paint()
        assert "STOP NOT DELIVERED" in pilot.text("StopBar")
        await pilot.press("ctrl+r")
        assert pilot.console.dialog is None, "it would release the stop once the line is back"
        await pilot.tell(scenes.welcome(scenes.healthy()))
        assert "the stop is not pressed: press it again" in pilot.text("StopBar")


async def test_a_robot_process_that_is_back_before_anything_is_painted_is_not_lost() -> None:
    async with piloted_console() as pilot:
        pilot.feed.cut("the robot process closed the connection")
        pilot.feed.deliver(scenes.welcome())
        await pilot.settle()
        pilot.console.paint()
        await pilot.settle()
        assert pilot.console.state.lost is None
        assert pilot.console.dialog is None
        assert "is back" in pilot.text("StopBar")


async def test_what_said_that_the_robot_is_lost_goes_also_from_below_another_dialog() -> None:
    missing = m.StopConfirmed(confirmed=["voice"], missing=["head"], elapsed_us=9, t=NOW)
    async with piloted_console() as pilot:
        await pilot.tell(m.StopPressed(source="key", t=NOW), missing)
        pilot.feed.cut("the line was cut")
        await pilot.until(lambda: isinstance(pilot.console.dialog, LostDialog))
        await pilot.press("ctrl+r")
        assert isinstance(pilot.console.dialog, ReleaseDialog)
        await pilot.tell(scenes.welcome())
        await pilot.settle()
        assert pilot.console.dialog is None
