"""The script on the screen: its line at the bottom, the whole of it, its sentence edited."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from tests.console import scenes
from tests.console.dialogs import entry
from tests.console.piloting import piloted_console
from tests.console.test_action_texts import guide
from tests.console.test_meters import console_state, text
from tests.features.phases.test_phases_on_screen import at, begins, counts_once
from tests.features.phases.test_phases_on_screen import guide as with_phases
from woz_tui.console.commands import COMMANDS, by_key
from woz_tui.console.drawing.cells import length
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.features.scripts.console import script_row, script_rows
from woz_tui.features.scripts.kinds import AskScript, ScriptMoved
from woz_tui.features.scripts.shown_script import shown_script
from woz_tui.protocol import messages as m

NOW = scenes.NOW


def scripted(position: int, height: int) -> list[str]:
    state = ConsoleState()
    state.apply([scenes.welcome(state=[scenes.start()])], 0)
    state.apply([ScriptMoved(position=position, t=NOW)], 0)
    rows = script_rows(state, PaintFrame(40, height, NOW))
    assert len(rows) <= height
    assert all(length(row) == 40 for row in rows)
    return ["".join(text for text, _ in row).rstrip() for row in rows]


def test_the_script_marks_what_was_played_and_what_is_next() -> None:
    shown = scripted(1, 30)
    assert shown[0] == " ✓ Hello"
    assert " ▸ Welcome" in shown
    assert shown[-1] == "     Goodbye, and thank you for coming."


@pytest.mark.parametrize("position", range(7))
def test_the_next_line_of_the_script_is_always_in_sight(position: int) -> None:
    shown = scripted(position, 5)
    assert 4 <= len(shown) <= 5
    if position < 6:
        assert any(line.startswith(" ▸") for line in shown)


def test_the_scripts_line() -> None:
    shown = text([script_row(console_state(), PaintFrame(60, 1, NOW), ("Space", ""))])
    assert "▸ Map" in shown
    assert "→ Roman glass" in shown
    assert shown.rstrip().endswith("2/6")
    ended = text(
        [script_row(console_state(ScriptMoved(position=6)), PaintFrame(60, 1, NOW), ("Space", ""))]
    )
    assert "Script has ended" in ended


def test_the_scripts_line_leaves_out_what_was_played_by_its_key() -> None:
    picture = console_state(ScriptMoved(position=0, played=[1, 2, 4], t=NOW))
    shown = text([script_row(picture, PaintFrame(80, 1, NOW), ("Space", ""))])
    assert "▸ Hello  → Roman glass  → Goodbye" in shown
    assert shown.rstrip().endswith("3/6")


def test_the_scripts_line_promises_no_key_while_the_stop_is_pressed() -> None:
    halted = ScriptMoved(position=1, played=[0], halted="refused", t=NOW)
    stop = m.StopPressed(source="key", t=NOW)
    frame, keys = PaintFrame(80, 1, NOW), ("Space", ">")
    stopped = text([script_row(console_state(halted, stop), frame, keys)])
    assert "refused" in stopped
    assert "Space plays it" not in stopped
    released = console_state(halted, stop, m.StopReleased(source="key", t=NOW))
    assert "refused: Space plays it, > goes on" in text([script_row(released, frame, keys)])


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_space_plays_the_script_of_the_phase(size: tuple[int, int]) -> None:
    async with piloted_console(with_phases(), size=size) as pilot:
        await at(pilot, begins("opening"))
        await at(pilot, ScriptMoved(position=1, phase="opening", played=[0]), 5001)
        assert "1/2" in pilot.text("StopBar")
        assert "Nod" in pilot.text("StopBar")
        halted = ScriptMoved(position=0, phase="opening", played=[], halted="failed")
        await at(pilot, halted, 5002)
        assert "Hello" in pilot.text("StopBar")
        assert "failed" in pilot.text("StopBar")
        assert "again" not in pilot.text("StopBar")  # of one that was refused nothing was said
        for how, words in (("stopped", "was cut"), ("mistake", "marked as a mistake")):
            halted = ScriptMoved(position=0, phase="opening", played=[], halted=how)
            await at(pilot, halted, 5003)
            assert f"{words}: Space plays it" in pilot.text("StopBar")


async def test_the_next_line_is_edited_before_it_is_said() -> None:
    async with piloted_console(guide()) as pilot:
        await pilot.press("ctrl+g")
        assert "Edit: Tank" in pilot.drawn()
        assert entry(pilot).value == "This is the krill tank."
        assert "enter says it so, once; the file is not changed" in pilot.drawn()
        await pilot.press(*["backspace"] * 11)
        await pilot.type("whale!")
        await pilot.press("escape", "ctrl+g")
        assert entry(pilot).value == "This is the whale!", "a stop keeps what was typed"
        await pilot.press("enter")
        asked = pilot.feed.last(AskScript)
        assert isinstance(asked, AskScript)
        assert (asked.play, asked.to, asked.text) == (True, 0, "This is the whale!")
        await pilot.press("ctrl+g", "enter")
        asked = pilot.feed.last(AskScript)
        assert isinstance(asked, AskScript)
        assert asked.text == "", "unchanged it is said as it stands in the file"


async def test_a_line_is_not_edited_that_was_played_meanwhile_or_is_kept() -> None:
    async with piloted_console(guide(blind=True)) as pilot:
        await pilot.press("ctrl+g")
        assert "Edit: Tank" in pilot.drawn()
        await pilot.tell(ScriptMoved(position=1, played=[0], t=NOW + 1))
        assert pilot.console.dialog is None
        await pilot.press("ctrl+g")
        assert pilot.console.dialog is None
        assert "what it says is kept from you" in pilot.drawn()
        await pilot.tell(ScriptMoved(position=2, played=[0, 1], t=NOW + 2))
        await pilot.press("ctrl+g")
        assert "The script has no next line" in pilot.drawn()


async def test_its_keys_play_it_and_move_in_it() -> None:
    async with piloted_console() as pilot:
        await pilot.press("space")
        assert isinstance(pilot.feed.last(AskScript), AskScript)
        for key, by in (("greater_than_sign", 1), ("less_than_sign", -1)):
            await pilot.press(key)
            moved = pilot.feed.last(AskScript)
            assert isinstance(moved, AskScript)
            assert (moved.play, moved.by) == (False, by)


@given(st.integers(-2, 9), st.lists(st.integers(-2, 9), max_size=3), st.integers(0, 5))
def test_a_place_outside_of_the_script_is_its_nearest_end(
    position: int, played: list[int], lines: int
) -> None:
    state = ConsoleState()
    shorter = replace(scenes.welcome(), script=["Hello"] * lines)
    state.apply([shorter, ScriptMoved(position=position, played=played, t=NOW)], 0)
    assert shown_script(state).position == min(max(position, 0), lines)
    assert len(script_rows(state, PaintFrame(40, 5, NOW))) <= 5
    assert script_row(state, PaintFrame(40, 1, NOW), ("Space", ">")) or not lines


def test_a_held_key_plays_one_line() -> None:
    counts_once("space", AskScript)


def test_every_command_of_scripts_has_a_key() -> None:
    assert {"script_next", "script_back", "script_on", "script_edit"} <= by_key(COMMANDS).keys()
