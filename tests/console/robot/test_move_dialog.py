"""Typing an animation: names by a part, whole paths as they are typed, what was played before."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import msgspec
import pytest
from textual.widgets import Input

from tests.console import scenes
from tests.console.piloting import ConsolePilot, piloted_console
from tests.console.robot import pepper
from tests.console.robot.screen import type_in
from woz_tui.console.screens.move import MoveDialog
from woz_tui.protocol import requests as r
from woz_tui.protocol.messages import Json

HEY = "animations/Stand/Gestures/Hey_1"


@asynccontextmanager
async def typing(first: r.Welcome | None = None) -> AsyncIterator[ConsolePilot]:
    async with piloted_console(first or pepper.welcome()) as pilot:
        await pilot.press("%")
        yield pilot


def entry(pilot: ConsolePilot) -> Input:
    return pilot.console.screen.query_one("#entry", Input)


def requested_moves(pilot: ConsolePilot) -> list[tuple[Json, str, str]]:
    """What was asked for: the name, the driver, the key."""
    asked = [each for each in pilot.feed.asked if isinstance(each, r.AskVerb)]
    assert all(each.verb == "play" and set(each.args) == {"move"} for each in asked)
    return [(each.args["move"], each.on, each.key) for each in asked]


async def test_a_part_of_the_name_and_tab() -> None:
    async with typing() as pilot:
        await type_in(pilot, "hey")
        drawn = pilot.drawn()
        assert HEY in drawn
        assert "Happy_1" not in drawn
        await pilot.press("tab", "enter")
        assert requested_moves(pilot) == [(HEY, "pepper", "%")]
        assert pilot.console.dialog is None


async def test_enter_plays_what_is_marked() -> None:
    async with typing() as pilot:
        await type_in(pilot, "happy")
        assert "▸ animations/Stand/Emotions/Positive/Happy_1" in pilot.drawn()
        await pilot.press("enter")
        assert requested_moves(pilot) == [
            ("animations/Stand/Emotions/Positive/Happy_1", "pepper", "%")
        ]


@pytest.mark.parametrize("typed", ["Hey_1", "Stand/Gestures/Hey", HEY, "Dance_9"])
async def test_whole_names_and_paths_are_sent_as_they_are(typed: str) -> None:
    async with typing() as pilot:
        await type_in(pilot, typed)
        assert "▸ animations" not in pilot.drawn()
        await pilot.press("enter")
        assert requested_moves(pilot) == [(typed, "pepper", "%")]


async def test_what_is_not_in_the_list_is_sent_as_it_is_typed() -> None:
    async with typing() as pilot:
        await type_in(pilot, "my/own-anim")
        assert "not in the list" in pilot.drawn()
        await pilot.press("tab", "enter")
        assert requested_moves(pilot) == [("my/own-anim", "pepper", "%")]


async def test_an_empty_line_only_closes() -> None:
    async with typing() as pilot:
        await pilot.press("enter")
        assert pilot.console.dialog is None
        assert requested_moves(pilot) == []


async def test_what_was_played_before() -> None:
    async with typing() as pilot:
        for name in ("Hey_1", "Bow_1", "Hey_1"):
            await type_in(pilot, name)
            await pilot.press("enter", "%")
        await pilot.press("up")
        assert entry(pilot).value == "Hey_1"
        await pilot.press("up", "up", "up")
        assert entry(pilot).value == "Bow_1"
        await pilot.press("down", "down")
        assert entry(pilot).value == ""


async def test_another_robot_plays() -> None:
    async with typing(pepper.welcome(drivers=("left", "right"))) as pilot:
        assert "robot: left" in pilot.drawn()
        await pilot.press("ctrl+o")
        assert "robot: right" in pilot.drawn()
        await type_in(pilot, "Hey_1")
        await pilot.press("enter")
        assert requested_moves(pilot) == [("Hey_1", "right", "%")]


async def test_a_draft_outlives_the_stop() -> None:
    async with typing() as pilot:
        await type_in(pilot, "Hey")
        await pilot.press("escape")
        await pilot.until(lambda: pilot.console.dialog is None)
        assert requested_moves(pilot) == []
        await pilot.press("%")
        assert entry(pilot).value == "Hey"


async def test_a_robot_that_lists_no_moves_is_asked_for_a_name_without_a_path() -> None:
    async with typing(scenes.welcome()) as pilot:
        assert "path" not in pilot.drawn()
        assert "animation" not in pilot.drawn()
        await type_in(pilot, "nod")
        assert "this robot does not list its moves" in pilot.drawn()
        await pilot.press("enter")
        assert requested_moves(pilot) == [("nod", "head", "%")]


async def test_a_robot_without_a_picture_of_itself_lists_its_moves_too() -> None:
    async with typing(scenes.welcome(settings={"moves": {"head": ["nod", "shake"]}})) as pilot:
        await type_in(pilot, "sh")
        assert "▸ shake" in pilot.drawn()
        assert "does not list its moves" not in pilot.drawn()
        await pilot.press("enter")
        assert requested_moves(pilot) == [("shake", "head", "%")]


async def test_where_nobody_plays_animations_there_is_nothing_to_type() -> None:
    first = msgspec.structs.replace(pepper.welcome(), verbs={"pepper": ["say"]})
    async with typing(first) as pilot:
        assert not isinstance(pilot.console.dialog, MoveDialog)
        assert "This robot plays no moves" in pilot.text("StopBar")
