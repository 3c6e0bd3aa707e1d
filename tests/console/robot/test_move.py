"""Typing an animation: names by a part, whole paths as they are typed, what was played before."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import msgspec
import pytest
from textual.widgets import Input

from tests.console import scenes
from tests.console.driving import Sitting, sitting
from tests.console.robot import pepper
from tests.console.robot.screen import type_in
from woz_tui.console.screens.move import MoveDialog
from woz_tui.protocol import requests as r
from woz_tui.protocol.messages import Json

HEY = "animations/Stand/Gestures/Hey_1"


@asynccontextmanager
async def typing(first: r.Welcome | None = None) -> AsyncIterator[Sitting]:
    async with sitting(first or pepper.welcome()) as seat:
        await seat.press("%")
        yield seat


def entry(seat: Sitting) -> Input:
    return seat.console.screen.query_one("#entry", Input)


def played(seat: Sitting) -> list[tuple[Json, str, str]]:
    """What was asked for: the name, the driver, the key."""
    asked = [each for each in seat.feed.asked if isinstance(each, r.AskVerb)]
    assert all(each.verb == "play" and set(each.args) == {"move"} for each in asked)
    return [(each.args["move"], each.on, each.key) for each in asked]


async def test_a_part_of_the_name_and_tab() -> None:
    async with typing() as seat:
        await type_in(seat, "hey")
        drawn = seat.drawn()
        assert HEY in drawn
        assert "Happy_1" not in drawn
        await seat.press("tab", "enter")
        assert played(seat) == [(HEY, "pepper", "%")]
        assert seat.console.dialog is None


async def test_enter_plays_what_is_marked() -> None:
    async with typing() as seat:
        await type_in(seat, "happy")
        assert "▸ animations/Stand/Emotions/Positive/Happy_1" in seat.drawn()
        await seat.press("enter")
        assert played(seat) == [("animations/Stand/Emotions/Positive/Happy_1", "pepper", "%")]


@pytest.mark.parametrize("typed", ["Hey_1", "Stand/Gestures/Hey", HEY, "Dance_9"])
async def test_whole_names_and_paths_are_sent_as_they_are(typed: str) -> None:
    async with typing() as seat:
        await type_in(seat, typed)
        assert "▸ animations" not in seat.drawn()
        await seat.press("enter")
        assert played(seat) == [(typed, "pepper", "%")]


async def test_what_is_not_in_the_list_is_sent_as_it_is_typed() -> None:
    async with typing() as seat:
        await type_in(seat, "my/own-anim")
        assert "not in the list" in seat.drawn()
        await seat.press("tab", "enter")
        assert played(seat) == [("my/own-anim", "pepper", "%")]


async def test_an_empty_line_only_closes() -> None:
    async with typing() as seat:
        await seat.press("enter")
        assert seat.console.dialog is None
        assert played(seat) == []


async def test_what_was_played_before() -> None:
    async with typing() as seat:
        for name in ("Hey_1", "Bow_1", "Hey_1"):
            await type_in(seat, name)
            await seat.press("enter", "%")
        await seat.press("up")
        assert entry(seat).value == "Hey_1"
        await seat.press("up", "up", "up")
        assert entry(seat).value == "Bow_1"
        await seat.press("down", "down")
        assert entry(seat).value == ""


async def test_another_robot_plays() -> None:
    async with typing(pepper.welcome(drivers=("left", "right"))) as seat:
        assert "robot: left" in seat.drawn()
        await seat.press("ctrl+o")
        assert "robot: right" in seat.drawn()
        await type_in(seat, "Hey_1")
        await seat.press("enter")
        assert played(seat) == [("Hey_1", "right", "%")]


async def test_a_draft_outlives_the_stop() -> None:
    async with typing() as seat:
        await type_in(seat, "Hey")
        await seat.press("escape")
        await seat.until(lambda: seat.console.dialog is None)
        assert played(seat) == []
        await seat.press("%")
        assert entry(seat).value == "Hey"


async def test_a_robot_that_lists_no_moves_is_asked_for_a_name_without_a_path() -> None:
    async with typing(scenes.welcome()) as seat:
        assert "path" not in seat.drawn()
        assert "animation" not in seat.drawn()
        await type_in(seat, "nod")
        assert "this robot does not list its moves" in seat.drawn()
        await seat.press("enter")
        assert played(seat) == [("nod", "head", "%")]


async def test_where_nobody_plays_animations_there_is_nothing_to_type() -> None:
    first = msgspec.structs.replace(pepper.welcome(), verbs={"pepper": ["say"]})
    async with typing(first) as seat:
        assert not isinstance(seat.console.dialog, MoveDialog)
        assert "This robot plays no moves" in seat.text("StopBar")
