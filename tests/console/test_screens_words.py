from __future__ import annotations

from dataclasses import replace

import msgspec
import pytest
from textual.events import Key
from textual.widgets import OptionList

from tests.console import scenes
from tests.console.dialogs import busy, entry, opened
from tests.console.driving import sitting
from woz_tui.config.keys.console_keys import BUILTIN_KEYS
from woz_tui.console.screens.say import complete
from woz_tui.protocol import requests as r

# -- say ---------------------------------------------------------------------------------------


async def test_type_and_say() -> None:
    async with sitting() as seat:
        await opened(seat, "SayDialog")
        await seat.type("hi, you")
        await seat.press("enter")
        asked = seat.feed.last(r.AskVerb)
        assert isinstance(asked, r.AskVerb)
        assert (asked.verb, asked.args, asked.on) == ("say", {"text": "hi, you"}, "")
        assert seat.console.dialog is None


async def test_the_log_has_the_key_that_a_keymap_file_gave_to_saying() -> None:
    moved = tuple(replace(key, chord=";") if key.id == "say" else key for key in BUILTIN_KEYS)
    async with sitting(builtins=moved) as seat:
        await seat.press(";")
        await seat.type("hi")
        await seat.press("enter")
        asked = seat.feed.last(r.AskVerb)
        assert isinstance(asked, r.AskVerb)
        assert asked.key == ";"


async def test_a_dialog_closes_as_it_says_wherever_the_keymap_has_put_leaving() -> None:
    moved = tuple(replace(key, chord="f10") if key.id == "leave" else key for key in BUILTIN_KEYS)
    async with sitting(builtins=moved) as seat:
        for key in ("ctrl+q", "f10"):
            await opened(seat, "NoteDialog")
            assert "ctrl+q closes" in seat.drawn()
            await seat.press(key)
            assert seat.console.dialog is None
        await seat.press("ctrl+q")
        assert seat.console.is_running
        assert seat.console.return_value is None


async def test_two_enters_at_once_say_it_once() -> None:
    async with sitting() as seat:
        await opened(seat, "SayDialog")
        await seat.type("hi")
        for _ in range(2):
            seat.console.post_message(Key("enter", "\r"))
        await seat.press()
        assert len([asked for asked in seat.feed.asked if isinstance(asked, r.AskVerb)]) == 1


async def test_history_and_completion() -> None:
    async with sitting() as seat:
        for text in ("first", "second"):
            await opened(seat, "SayDialog")
            await seat.type(text)
            await seat.press("enter")
        await opened(seat, "SayDialog")
        await seat.press("up")
        assert entry(seat).value == "second"
        await seat.press("up")
        assert entry(seat).value == "first"
        await seat.press("down", "down")
        assert entry(seat).value == ""
        await seat.type("plea")
        assert "Please look at the map." in seat.drawn()
        await seat.press("tab")
        assert entry(seat).value == "please look at the map."
        entry(seat).value = "Hello {par"
        await seat.press("tab")
        assert entry(seat).value == "Hello {participant}"


async def test_what_was_typed_survives_a_stop() -> None:
    async with sitting() as seat:
        await opened(seat, "SayDialog")
        await seat.type("half a sen")
        await seat.press("escape")
        await seat.until(lambda: seat.console.dialog is None)
        await opened(seat, "SayDialog")
        assert entry(seat).value == "half a sen"
        await seat.type("tence")
        await seat.press("enter")
        asked = seat.feed.last(r.AskVerb)
        assert isinstance(asked, r.AskVerb)
        assert asked.args == {"text": "half a sentence"}


async def test_nothing_typed_says_nothing() -> None:
    async with sitting() as seat:
        await opened(seat, "SayDialog")
        await seat.press("space", "enter")
        assert seat.feed.last(r.AskVerb) is None
        assert seat.console.dialog is None


@pytest.mark.parametrize(
    ("typed", "whole"),
    [
        ("", None),
        ("Pl", "Please look."),
        ("PLEASE l", "PLEASE look."),
        ("Please look.", None),
        ("x", None),
        ("a {se", "a {session}"),
        ("a {participant} {c", "a {participant} {condition}"),
        ("a {zz", None),
    ],
)
def test_complete(typed: str, whole: str | None) -> None:
    variables = ["session", "participant", "condition"]
    assert complete(typed, ["Please look.", "Pleased"], variables) == whole


# -- find, note, mistake -----------------------------------------------------------------------


async def test_find_an_action_by_a_few_letters_and_play_it() -> None:
    async with sitting() as seat:
        await opened(seat, "FindDialog")
        await seat.type("rom")
        found = seat.console.screen.query_one("#found", OptionList)
        shown = [str(option.prompt) for option in found.options]
        assert "Roman glass" in shown[0]
        assert not any("Hello" in line for line in shown)
        await seat.press("enter")
        asked = seat.feed.last(r.AskAction)
        assert isinstance(asked, r.AskAction)
        assert (asked.action, asked.source) == ("Roman glass", "palette")


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_each_find_takes_one_line(size: tuple[int, int]) -> None:
    first = scenes.welcome()
    spoken = msgspec.structs.replace(
        first.panels[0].actions[0], help="and so on " * 20, utterances=[]
    )
    panel = msgspec.structs.replace(first.panels[0], actions=[spoken])
    first = msgspec.structs.replace(first, panels=[panel, *first.panels[1:]])
    async with sitting(first, size=size) as seat:
        await opened(seat, "FindDialog")
        found = seat.console.screen.query_one("#found", OptionList)
        rows = seat.drawn().splitlines()[found.region.y : found.region.bottom]
        assert "and so on" in rows[0]
        assert "and so on" not in rows[1]


async def test_find_by_words_and_choose_with_the_arrows() -> None:
    async with sitting() as seat:
        await opened(seat, "FindDialog")
        await seat.type("point")
        assert seat.console.screen.query_one("#found", OptionList).highlighted == 0
        await seat.press("down", "enter")
        asked = seat.feed.last(r.AskAction)
        assert isinstance(asked, r.AskAction)
        assert asked.action == "Point right"
        await opened(seat, "FindDialog")
        await seat.type("museum")
        assert "Welcome" in seat.drawn()


async def test_find_locks_panels_and_carries_out_the_consoles_commands() -> None:
    async with sitting() as seat:
        await opened(seat, "FindDialog")
        await seat.type("lock gest")
        await seat.press("enter")
        asked = seat.feed.last(r.AskLock)
        assert isinstance(asked, r.AskLock)
        assert (asked.panel, asked.locked) == ("Gestures", True)
        await opened(seat, "FindDialog")
        await seat.type("light colours")
        await seat.press("enter")
        assert seat.console.theme == "woz-light"


async def test_find_without_a_match_plays_nothing() -> None:
    async with sitting() as seat:
        await opened(seat, "FindDialog")
        await seat.type("qqqqqq")
        await seat.press("enter")
        assert seat.feed.asked == []


async def test_a_note() -> None:
    async with sitting() as seat:
        await opened(seat, "NoteDialog")
        await seat.type("looks away")
        await seat.press("enter")
        asked = seat.feed.last(r.AskNote)
        assert isinstance(asked, r.AskNote)
        assert asked.text == "looks away"
        await opened(seat, "NoteDialog")
        assert entry(seat).value == ""


async def test_a_mistake_is_picked_from_the_log() -> None:
    async with sitting(busy()) as seat:
        await opened(seat, "MistakeDialog")
        await seat.press("down", "down", "enter")
        asked = seat.feed.last(r.AskMistake)
        assert isinstance(asked, r.AskMistake)
        assert asked.run == "a5"
