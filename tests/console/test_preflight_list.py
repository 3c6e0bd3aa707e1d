"""The preflight's list for humans, and what the wizard is told of cues."""

from __future__ import annotations

import pytest

from tests.console import scenes, study_scene
from tests.console.dialogs import open_dialog
from tests.console.piloting import piloted_console
from woz_tui.console.drawing.glyphs import ASCII
from woz_tui.console.drawing.theme import Appearance
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

NOW, SECOND = study_scene.NOW, study_scene.SECOND


def ticked(check: str = study_scene.CHECKS[0], level: str = "ok") -> m.PreflightChecked:
    return m.PreflightChecked(check=check, level=level, source="wizard", t=NOW)


@pytest.mark.parametrize("key", ["space", "enter"])
async def test_a_line_is_ticked_and_the_tick_taken_away(key: str) -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await open_dialog(pilot, "PreflightDialog")
        assert f"○ {study_scene.CHECKS[0]}" in pilot.drawn()
        await pilot.press("down", key)
        asked = pilot.feed.last(r.AskCheck)
        assert isinstance(asked, r.AskCheck)
        assert (asked.check, asked.ok) == (study_scene.CHECKS[1], True)
        await pilot.tell(ticked(study_scene.CHECKS[1]))
        assert f"✓ {study_scene.CHECKS[1]}" in pilot.drawn()
        await pilot.press(key)
        asked = pilot.feed.last(r.AskCheck)
        assert isinstance(asked, r.AskCheck)
        assert asked.ok is False


async def test_a_newcomer_sees_what_is_ticked() -> None:
    async with piloted_console(study_scene.welcome(*map(ticked, study_scene.CHECKS))) as pilot:
        await open_dialog(pilot, "PreflightDialog")
        assert pilot.drawn().count("✓ the") == 2


async def test_the_verdict_counts_what_is_left_to_do() -> None:
    async with piloted_console(study_scene.welcome(), size=(160, 50)) as pilot:
        await open_dialog(pilot, "PreflightDialog")
        await pilot.until(lambda: "2 of your own checks" in pilot.drawn())
        await pilot.tell(*map(ticked, study_scene.CHECKS))
        assert "your own checks" not in pilot.drawn()


async def test_checks_run_again_by_letter_and_nothing_is_ticked() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await open_dialog(pilot, "PreflightDialog")
        await pilot.press("c")
        asked = [one for one in pilot.feed.asked if isinstance(one, r.AskPreflight)]
        assert len(asked) == 2
        assert pilot.feed.last(r.AskCheck) is None


async def test_without_a_list_enter_checks_again() -> None:
    async with piloted_console(scenes.welcome()) as pilot:
        await open_dialog(pilot, "PreflightDialog")
        await pilot.press("enter")
        asked = [one for one in pilot.feed.asked if isinstance(one, r.AskPreflight)]
        assert len(asked) == 2


async def test_a_refusal_is_said() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await open_dialog(pilot, "PreflightDialog")
        await pilot.until(lambda: "your own checks" in pilot.drawn())
        pilot.feed.answers[r.AskCheck] = lambda asked, ref: r.Reply(
            ref=ref, ok=False, reason="you are watching"
        )
        await pilot.press("space")
        assert "you are watching" in pilot.drawn()


async def test_signs_of_a_plain_terminal() -> None:
    async with piloted_console(study_scene.welcome(), look=Appearance(ASCII, "woz-16")) as pilot:
        await pilot.tell(ticked())
        await open_dialog(pilot, "PreflightDialog")
        assert f"+ {study_scene.CHECKS[0]}" in pilot.drawn()
        assert f"o {study_scene.CHECKS[1]}" in pilot.drawn()
