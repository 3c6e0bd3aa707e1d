"""A flood of log lines does not flood the line to the terminal."""

from __future__ import annotations

from tests.console import scenes
from tests.console.piloting import ConsolePilot, piloted_console
from woz_tui.console.screen_app import PAINT_S
from woz_tui.console.widgets.event_list import BURST_ROWS, ROWS_S
from woz_tui.protocol import messages as m

SIZE = (160, 50)


async def rows_repainted(pilot: ConsolePilot, seconds: float) -> int:
    """How many rows of the list change while every beat brings a screenful of lines."""
    changed = 0
    for beat in range(round(seconds / PAINT_S)):
        before = pilot.text("EventList").splitlines()
        lines = [m.Notice(level="info", text=f"{beat}.{n}", t=scenes.NOW) for n in range(SIZE[1])]
        await pilot.tell_quietly(*lines)
        await pilot.pass_time(PAINT_S)
        after = pilot.text("EventList").splitlines()
        changed += sum(old != new for old, new in zip(before, after, strict=False))
    return changed


async def test_a_flood_repaints_a_bounded_number_of_rows() -> None:
    async with piloted_console(size=SIZE) as pilot:
        seconds = 8.0
        changed = await rows_repainted(pilot, seconds)
        assert BURST_ROWS / 2 < changed <= BURST_ROWS + ROWS_S * seconds + SIZE[1]


async def test_after_the_flood_the_last_line_is_shown() -> None:
    async with piloted_console(size=SIZE) as pilot:
        await rows_repainted(pilot, 5.0)
        await pilot.tell_quietly(m.Notice(level="info", text="the last line", t=scenes.NOW))
        await pilot.pass_time(1.0)
        assert "the last line" in pilot.text("EventList")


async def test_a_new_size_is_drawn_in_the_flood_too() -> None:
    async with piloted_console(size=SIZE) as pilot:
        await rows_repainted(pilot, 5.0)
        await pilot.tell_quietly(m.Notice(level="info", text="the last line", t=scenes.NOW))
        await pilot.pilot.resize_terminal(120, 40)
        await pilot.until(lambda: "the last line" in pilot.text("EventList"))
        assert len(pilot.text("EventList").splitlines()[0]) < SIZE[0]
