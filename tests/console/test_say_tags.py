"""Typing an utterance for a robot that knows tags; what was there before works as before."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import msgspec
from textual.widgets import Input

from tests.console.piloting import ConsolePilot, piloted_console
from tests.console.robot import pepper
from tests.console.robot.screen import type_in
from woz_tui.protocol import requests as r


@asynccontextmanager
async def saying(first: r.Welcome | None = None) -> AsyncIterator[ConsolePilot]:
    async with piloted_console(*([first] if first is not None else [])) as pilot:
        await pilot.press("/")
        yield pilot


def entry(pilot: ConsolePilot) -> Input:
    return pilot.console.screen.query_one("#entry", Input)


async def test_tags_with_their_help_and_tab() -> None:
    async with saying(pepper.welcome()) as pilot:
        await type_in(pilot, "Hi \\")
        drawn = pilot.drawn()
        assert "\\rspd=100\\  speed in percent" in drawn
        assert "\\pau=500\\   pause in ms" in drawn, "in a column"
        await type_in(pilot, "rs")
        assert "pause in ms" not in pilot.drawn()
        await pilot.press("tab")
        assert entry(pilot).value == "Hi \\rspd=100\\"
        await type_in(pilot, " you")
        await pilot.press("enter")
        asked = pilot.feed.last(r.AskVerb)
        assert isinstance(asked, r.AskVerb)
        assert asked.args == {"text": "Hi \\rspd=100\\ you"}


async def test_digits_behind_tab_are_the_number() -> None:
    async with saying(pepper.welcome()) as pilot:
        await type_in(pilot, "Hi \\rs")
        await pilot.press("tab")
        await type_in(pilot, "80\\")
        assert entry(pilot).value == "Hi \\rspd=80\\"
        await type_in(pilot, " you 2")
        assert entry(pilot).value == "Hi \\rspd=80\\ you 2"


async def test_animations_by_name() -> None:
    async with saying(pepper.welcome()) as pilot:
        await type_in(pilot, "^ru")
        assert "plays an animation and waits" in pilot.drawn()
        await pilot.press("tab")
        assert entry(pilot).value == "^run("
        assert "^run(animations/Stand/Gestures/Hey_2)" in pilot.drawn()
        await type_in(pilot, "happy")
        await pilot.press("tab")
        assert entry(pilot).value == "^run(animations/Stand/Emotions/Positive/Happy_1)"


async def test_the_caret_decides_and_not_the_end() -> None:
    async with saying(pepper.welcome()) as pilot:
        await type_in(pilot, "\\rs Hello")
        assert "speed in percent" not in pilot.drawn()
        await pilot.press(*["left"] * len(" Hello"))
        assert "speed in percent" in pilot.drawn()
        await pilot.press("tab")
        assert entry(pilot).value == "\\rspd=100\\ Hello"
        assert entry(pilot).cursor_position == len("\\rspd=100\\")


async def test_an_unknown_tag_is_told_and_tab_leaves_it() -> None:
    async with saying(pepper.welcome()) as pilot:
        await type_in(pilot, "\\xyz")
        assert "not a tag of this robot" in pilot.drawn()
        await pilot.press("tab")
        assert entry(pilot).value == "\\xyz"


async def test_what_is_pale_behind_the_caret_is_what_tab_takes() -> None:
    async with saying(pepper.welcome()) as pilot:
        await type_in(pilot, "\\v")
        await pilot.until(lambda: entry(pilot)._suggestion == "\\vct=100\\")


async def test_variables_and_utterances_as_before() -> None:
    async with saying(pepper.welcome()) as pilot:
        await type_in(pilot, "Hello {par")
        await pilot.press("tab")
        assert entry(pilot).value == "Hello {participant}"
        await pilot.press("ctrl+q", "/")
        entry(pilot).value = ""
        await pilot.type("Welcome")
        assert "Welcome to the museum!" in pilot.drawn()
        await pilot.press("tab")
        assert entry(pilot).value == "Welcome to the museum!"


async def test_a_robot_without_tags_is_not_asked_for_any() -> None:
    async with saying() as pilot:
        await type_in(pilot, "\\rs")
        assert "tag" not in pilot.drawn()
        assert "tags" not in entry(pilot).placeholder


async def test_tags_are_those_of_the_voice_that_speaks() -> None:
    first = pepper.welcome()
    first = msgspec.structs.replace(first, verbs={"puppet": ["say"], **first.verbs})
    async with saying(first) as pilot:
        await type_in(pilot, "\\rs")
        assert "speed in percent" not in pilot.drawn()
        await pilot.press("ctrl+o")
        assert "speed in percent" in pilot.drawn()
