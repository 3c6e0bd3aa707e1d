"""What the wizard sees while no folder takes the log, and how she goes on all the same."""

from __future__ import annotations

import pytest

from tests.console import scenes
from tests.console.piloting import piloted_console
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

pytestmark = pytest.mark.safety

NOW = scenes.NOW
DETAIL = "the log cannot be written to any folder (~/rec: the disk is full)"
FAILED = m.RecorderState(
    level="failed", lag_us=0, path="x", detail=DETAIL, remedy="free space", t=NOW
)
WAIVED = m.RecorderState(
    level="failed", lag_us=0, path="x", detail=DETAIL, remedy="free space", waived=True, t=NOW
)


async def test_she_reads_why_and_goes_on_with_a_key_and_enter() -> None:
    async with piloted_console(scenes.welcome(), size=(160, 50)) as pilot:
        await pilot.tell(FAILED)
        assert "NOT RECORDED" in pilot.text("StatusLines")
        assert "actions are refused" in pilot.drawn()
        assert "Home go on without a record" in pilot.text("StopBar")
        await pilot.press("home")
        assert "the disk is full" in pilot.drawn()
        assert "free space" in pilot.drawn()
        assert not [asked for asked in pilot.feed.asked if isinstance(asked, r.AskUnrecorded)]
        await pilot.press("enter")
        assert isinstance(pilot.feed.asked[-1], r.AskUnrecorded)
        await pilot.tell(m.RecordWaived(t=NOW), WAIVED)
        assert "WITHOUT A RECORD" in pilot.text("StatusLines")
        assert "Going on without a record" in pilot.drawn()
        assert "Home go on" not in pilot.text("StopBar")


async def test_a_refusal_names_the_key() -> None:
    async with piloted_console(scenes.welcome()) as pilot:
        await pilot.tell(
            FAILED,
            r.Reply(
                ref=1,
                ok=False,
                reason="the log is not written",
                hint="go on without a record",
                command="unrecorded",
            ),
        )
        assert "press Home to go on without a record" in pilot.drawn()


async def test_there_is_nothing_to_go_on_without_while_the_log_is_written() -> None:
    async with piloted_console(scenes.welcome()) as pilot:
        await pilot.press("home")
        assert "The log is written" in pilot.drawn()
        await pilot.press("enter")
        assert not [asked for asked in pilot.feed.asked if isinstance(asked, r.AskUnrecorded)]


async def test_an_open_question_follows_the_log() -> None:
    async with piloted_console(scenes.welcome()) as pilot:
        await pilot.tell(FAILED)
        await pilot.press("home")
        await pilot.tell(m.RecorderState(level="warn", lag_us=0, path="x", t=NOW))
        assert "The log is written" in pilot.drawn()
