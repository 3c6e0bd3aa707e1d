from __future__ import annotations

from dataclasses import replace

import msgspec
import pytest
from textual.events import Key
from textual.widgets import OptionList

from tests.console import scenes
from tests.console.dialogs import busy, entry, open_dialog
from tests.console.piloting import piloted_console
from woz_tui.config.keys.console_keys import BUILTIN_KEYS
from woz_tui.console.screens.say import complete
from woz_tui.protocol import requests as r

# -- say ---------------------------------------------------------------------------------------


async def test_type_and_say() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "SayDialog")
        await pilot.type("hi, you")
        await pilot.press("enter")
        asked = pilot.feed.last(r.AskVerb)
        assert isinstance(asked, r.AskVerb)
        assert (asked.verb, asked.args, asked.on) == ("say", {"text": "hi, you"}, "")
        assert pilot.console.dialog is None


async def test_the_log_has_the_key_that_a_keymap_file_gave_to_saying() -> None:
    moved = tuple(replace(key, chord=";") if key.id == "say" else key for key in BUILTIN_KEYS)
    async with piloted_console(builtins=moved) as pilot:
        await pilot.press(";")
        await pilot.type("hi")
        await pilot.press("enter")
        asked = pilot.feed.last(r.AskVerb)
        assert isinstance(asked, r.AskVerb)
        assert asked.key == ";"


async def test_a_dialog_closes_as_it_says_wherever_the_keymap_has_put_leaving() -> None:
    moved = tuple(replace(key, chord="f10") if key.id == "leave" else key for key in BUILTIN_KEYS)
    async with piloted_console(builtins=moved) as pilot:
        for key in ("ctrl+q", "f10"):
            await open_dialog(pilot, "NoteDialog")
            assert "ctrl+q closes" in pilot.drawn()
            await pilot.press(key)
            assert pilot.console.dialog is None
        await pilot.press("ctrl+q")
        assert pilot.console.is_running
        assert pilot.console.return_value is None


async def test_two_enters_at_once_say_it_once() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "SayDialog")
        await pilot.type("hi")
        for _ in range(2):
            pilot.console.post_message(Key("enter", "\r"))
        await pilot.press()
        assert len([asked for asked in pilot.feed.asked if isinstance(asked, r.AskVerb)]) == 1


async def test_history_and_completion() -> None:
    async with piloted_console() as pilot:
        for text in ("first", "second"):
            await open_dialog(pilot, "SayDialog")
            await pilot.type(text)
            await pilot.press("enter")
        await open_dialog(pilot, "SayDialog")
        await pilot.press("up")
        assert entry(pilot).value == "second"
        await pilot.press("up")
        assert entry(pilot).value == "first"
        await pilot.press("down", "down")
        assert entry(pilot).value == ""
        await pilot.type("plea")
        assert "Please look at the map." in pilot.drawn()
        await pilot.press("tab")
        assert entry(pilot).value == "please look at the map."
        entry(pilot).value = "Hello {par"
        await pilot.press("tab")
        assert entry(pilot).value == "Hello {participant}"


async def test_what_was_typed_survives_a_stop() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "SayDialog")
        await pilot.type("half a sen")
        await pilot.press("escape")
        await pilot.until(lambda: pilot.console.dialog is None)
        await open_dialog(pilot, "SayDialog")
        assert entry(pilot).value == "half a sen"
        await pilot.type("tence")
        await pilot.press("enter")
        asked = pilot.feed.last(r.AskVerb)
        assert isinstance(asked, r.AskVerb)
        assert asked.args == {"text": "half a sentence"}


async def test_nothing_typed_says_nothing() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "SayDialog")
        await pilot.press("space", "enter")
        assert pilot.feed.last(r.AskVerb) is None
        assert pilot.console.dialog is None


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
    async with piloted_console() as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type("rom")
        found = pilot.console.screen.query_one("#found", OptionList)
        shown = [str(option.prompt) for option in found.options]
        assert "Roman glass" in shown[0]
        assert not any("Hello" in line for line in shown)
        await pilot.press("enter")
        asked = pilot.feed.last(r.AskAction)
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
    async with piloted_console(first, size=size) as pilot:
        await open_dialog(pilot, "FindDialog")
        found = pilot.console.screen.query_one("#found", OptionList)
        rows = pilot.drawn().splitlines()[found.region.y : found.region.bottom]
        assert "and so on" in rows[0]
        assert "and so on" not in rows[1]


async def test_find_by_words_and_choose_with_the_arrows() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type("point")
        assert pilot.console.screen.query_one("#found", OptionList).highlighted == 0
        await pilot.press("down", "enter")
        asked = pilot.feed.last(r.AskAction)
        assert isinstance(asked, r.AskAction)
        assert asked.action == "Point right"
        await open_dialog(pilot, "FindDialog")
        await pilot.type("museum")
        assert "Welcome" in pilot.drawn()


async def test_find_locks_panels_and_carries_out_the_consoles_commands() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type("lock gest")
        await pilot.press("enter", "down", "enter")
        asked = pilot.feed.last(r.AskLock)
        assert isinstance(asked, r.AskLock)
        assert (asked.panel, asked.locked) == ("Gestures", True)
        await open_dialog(pilot, "FindDialog")
        await pilot.type("light colours")
        await pilot.press("enter")
        assert pilot.console.theme == "woz-light"


async def test_find_without_a_match_plays_nothing() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type("qqqqqq")
        await pilot.press("enter")
        assert pilot.feed.asked == []


async def test_a_note() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "NoteDialog")
        await pilot.type("looks away")
        await pilot.press("enter")
        asked = pilot.feed.last(r.AskNote)
        assert isinstance(asked, r.AskNote)
        assert asked.text == "looks away"
        await open_dialog(pilot, "NoteDialog")
        assert entry(pilot).value == ""


async def test_a_mistake_is_picked_from_the_log() -> None:
    async with piloted_console(busy()) as pilot:
        await open_dialog(pilot, "MistakeDialog")
        await pilot.press("down", "down", "enter")
        asked = pilot.feed.last(r.AskMistake)
        assert isinstance(asked, r.AskMistake)
        assert asked.run == "a5"
