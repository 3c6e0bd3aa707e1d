"""Typing an utterance for a robot that knows tags; what was there before works as before."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import msgspec
from textual.widgets import Input

from tests.console.driving import Sitting, sitting
from tests.console.robot import pepper
from tests.console.robot.screen import type_in
from woz_tui.protocol import requests as r


@asynccontextmanager
async def saying(first: r.Welcome | None = None) -> AsyncIterator[Sitting]:
    async with sitting(*([first] if first is not None else [])) as seat:
        await seat.press("/")
        yield seat


def entry(seat: Sitting) -> Input:
    return seat.console.screen.query_one("#entry", Input)


async def test_tags_with_their_help_and_tab() -> None:
    async with saying(pepper.welcome()) as seat:
        await type_in(seat, "Hi \\")
        drawn = seat.drawn()
        assert "\\rspd=100\\  speed in percent" in drawn
        assert "\\pau=500\\   pause in ms" in drawn, "in a column"
        await type_in(seat, "rs")
        assert "pause in ms" not in seat.drawn()
        await seat.press("tab")
        assert entry(seat).value == "Hi \\rspd=100\\"
        await type_in(seat, " you")
        await seat.press("enter")
        asked = seat.feed.last(r.AskVerb)
        assert isinstance(asked, r.AskVerb)
        assert asked.args == {"text": "Hi \\rspd=100\\ you"}


async def test_digits_behind_tab_are_the_number() -> None:
    async with saying(pepper.welcome()) as seat:
        await type_in(seat, "Hi \\rs")
        await seat.press("tab")
        await type_in(seat, "80\\")
        assert entry(seat).value == "Hi \\rspd=80\\"
        await type_in(seat, " you 2")
        assert entry(seat).value == "Hi \\rspd=80\\ you 2"


async def test_animations_by_name() -> None:
    async with saying(pepper.welcome()) as seat:
        await type_in(seat, "^ru")
        assert "plays an animation and waits" in seat.drawn()
        await seat.press("tab")
        assert entry(seat).value == "^run("
        assert "^run(animations/Stand/Gestures/Hey_2)" in seat.drawn()
        await type_in(seat, "happy")
        await seat.press("tab")
        assert entry(seat).value == "^run(animations/Stand/Emotions/Positive/Happy_1)"


async def test_the_caret_decides_and_not_the_end() -> None:
    async with saying(pepper.welcome()) as seat:
        await type_in(seat, "\\rs Hello")
        assert "speed in percent" not in seat.drawn()
        await seat.press(*["left"] * len(" Hello"))
        assert "speed in percent" in seat.drawn()
        await seat.press("tab")
        assert entry(seat).value == "\\rspd=100\\ Hello"
        assert entry(seat).cursor_position == len("\\rspd=100\\")


async def test_an_unknown_tag_is_told_and_tab_leaves_it() -> None:
    async with saying(pepper.welcome()) as seat:
        await type_in(seat, "\\xyz")
        assert "not a tag of this robot" in seat.drawn()
        await seat.press("tab")
        assert entry(seat).value == "\\xyz"


async def test_what_is_pale_behind_the_caret_is_what_tab_takes() -> None:
    async with saying(pepper.welcome()) as seat:
        await type_in(seat, "\\v")
        await seat.until(lambda: entry(seat)._suggestion == "\\vct=100\\")


async def test_variables_and_utterances_as_before() -> None:
    async with saying(pepper.welcome()) as seat:
        await type_in(seat, "Hello {par")
        await seat.press("tab")
        assert entry(seat).value == "Hello {participant}"
        await seat.press("ctrl+q", "/")
        entry(seat).value = ""
        await seat.type("Welcome")
        assert "Welcome to the museum!" in seat.drawn()
        await seat.press("tab")
        assert entry(seat).value == "Welcome to the museum!"


async def test_a_robot_without_tags_is_not_asked_for_any() -> None:
    async with saying() as seat:
        await type_in(seat, "\\rs")
        assert "tag" not in seat.drawn()
        assert "tags" not in entry(seat).placeholder


async def test_tags_are_those_of_the_voice_that_speaks() -> None:
    first = pepper.welcome()
    first = msgspec.structs.replace(first, verbs={"puppet": ["say"], **first.verbs})
    async with saying(first) as seat:
        await type_in(seat, "\\rs")
        assert "speed in percent" not in seat.drawn()
        await seat.press("ctrl+o")
        assert "speed in percent" in seat.drawn()
