"""The table of commands: each key has its row, and each row does what palette and help say."""

from __future__ import annotations

import pytest
from textual.widgets import OptionList

from tests.console import scenes
from tests.console.dialogs import busy, open_dialog
from tests.console.piloting import ConsolePilot, piloted_console
from woz_tui.config.keys.console_keys import BUILTIN_KEYS
from woz_tui.console.commands import COMMANDS, by_key
from woz_tui.console.replay import commands as replay
from woz_tui.console.screens.dialog import ConsoleCommand
from woz_tui.gate.table import WATCHER_MAY
from woz_tui.protocol import requests as r


def test_each_key_of_the_console_belongs_to_one_command() -> None:
    keys = [key for command in COMMANDS for key in command.keys if key.chord]
    assert sorted(keys, key=BUILTIN_KEYS.index) == [*BUILTIN_KEYS]


@pytest.mark.parametrize("commands", [COMMANDS, replay.COMMANDS], ids=["session", "replay"])
def test_no_two_commands_have_a_name_in_common(commands: tuple[ConsoleCommand, ...]) -> None:
    keys = [key.id for command in commands for key in command.keys]
    assert len(keys) == len(set(keys))
    ranks = [command.hint.rank for command in commands if command.hint is not None]
    assert len(ranks) == len(set(ranks))


def palette_lines(pilot: ConsolePilot) -> list[str]:
    """The lines of the palette."""
    return [
        str(option.prompt)
        for option in pilot.console.screen.query_one("#found", OptionList).options
    ]


async def chosen(pilot: ConsolePilot, words: str) -> None:
    await open_dialog(pilot, "FindDialog")
    await pilot.type(words)
    assert words[:30] in palette_lines(pilot)[0]
    await pilot.press("enter")


LISTED = [
    command for command in COMMANDS if command.found and not command.name.startswith("repair_")
]


@pytest.mark.parametrize("share", range(4))
async def test_what_the_palette_lists_it_does(share: int) -> None:
    suspended: list[bool] = []
    async with piloted_console(busy()) as pilot:
        pilot.console.keyboard.on_suspend = lambda: suspended.append(True)

        def state() -> tuple[object, ...]:
            bar = pilot.text("StopBar")
            panels, events = pilot.console._panels.text, pilot.text("EventList")
            return (type(pilot.console.dialog), pilot.console.theme, bar, panels, events)

        for command in LISTED[share::4]:
            pilot.console.theme = "woz-light" if command.name == "dark" else "woz-dark"
            before, asked = state(), len(pilot.feed.asked)
            await chosen(pilot, command.words)
            did = state() != before or len(pilot.feed.asked) > asked or bool(suspended)
            assert did or command.name == "redraw", command.name
            suspended.clear()
            while pilot.console.dialog is not None:
                await pilot.press("ctrl+q")


async def test_a_marker_is_put_by_the_palette() -> None:
    async with piloted_console() as pilot:
        await chosen(pilot, "put a marker into the log")
        assert pilot.feed.last(r.AskMarker) is not None


async def test_a_watcher_is_offered_what_it_may_use() -> None:
    async with piloted_console(scenes.welcome(role="watcher"), size=(160, 50)) as pilot:
        line = pilot.drawn().splitlines()[-1]
        assert "find" in line
        assert "note" in line
        assert "say" not in line
        await open_dialog(pilot, "FindDialog")
        await pilot.type("type something to say")
        assert not any("something to say" in line for line in palette_lines(pilot))
        await pilot.press("ctrl+q")
        await open_dialog(pilot, "HelpDialog")
        (say,) = (line for line in pilot.drawn().splitlines() if "type something to say" in line)
        (note,) = (line for line in pilot.drawn().splitlines() if "write a note" in line)
        assert "for the wizard" in say
        assert "for the wizard" not in note


async def test_what_a_watcher_is_offered_is_what_the_robot_process_takes() -> None:
    async with piloted_console(scenes.welcome(role="watcher")) as pilot:
        for name, command in by_key(COMMANDS).items():
            if command.sends is not None and command.serves("watcher"):
                pilot.console.do(name)
        assert pilot.feed.asked
        assert all(isinstance(asked, WATCHER_MAY) for asked in pilot.feed.asked)
