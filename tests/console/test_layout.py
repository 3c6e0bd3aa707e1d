from __future__ import annotations

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from textual.geometry import Size

from tests.console import scenes
from tests.console.piloting import piloted_console
from woz_tui.console.widgets.main_screen import (
    ACTIONS,
    ORDER_BAR,
    STATUS,
    Needs,
    shape,
    upper_lines,
)
from woz_tui.protocol import messages as m

NOW = scenes.NOW


@pytest.mark.parametrize(
    ("size", "name"),
    [
        ((80, 24), "narrow"),
        ((119, 60), "narrow"),
        ((120, 24), "wide"),
        ((160, 39), "wide"),
        ((160, 50), "roomy"),
    ],
)
def test_the_shape_follows_the_screen(size: tuple[int, int], name: str) -> None:
    assert shape(Size(*size)) == name


@given(st.integers(1, 300), st.integers(8, 200), st.integers(1, 90), st.integers(1, 90))
def test_the_upper_row_leaves_room_below(width: int, height: int, panels: int, meters: int) -> None:
    lines = upper_lines(Size(width, height), Needs(panels, meters, bar=ORDER_BAR))
    assert lines >= 3
    if height >= 24:
        assert height - STATUS - ACTIONS - ORDER_BAR - lines >= 7


async def test_at_80_by_24_panels_have_ten_lines_and_the_next_sentence_two() -> None:
    async with piloted_console(
        scenes.welcome(state=[*scenes.healthy(), *scenes.sensors()])
    ) as pilot:
        regions = {
            name: pilot.console.query_one(name).region
            for name in ("ActionPanels", "Meters", "EventList", "ActionRow", "StopBar")
        }
        assert regions["ActionPanels"].height == 10
        assert regions["Meters"].height == regions["EventList"].height == 7
        assert regions["ActionRow"].height == 1
        assert regions["StopBar"].height == 4
        await pilot.tell(
            scenes.actions_filled("Map", "All day long I " + "wait and " * 10 + "greet you.")
        )
        script, first, second, hints = pilot.text("StopBar").splitlines()
        assert script.startswith(" Space  ▸ Map")
        assert f"{first.strip()} {second.strip()}" == (
            "“All day long I " + "wait and " * 10 + "greet you.”"
        )
        assert hints.startswith(" Esc stop")
        await pilot.tell(m.StopPressed(source="key", t=NOW))
        script, first, alarm, _ = pilot.text("StopBar").splitlines()
        assert "All day long" in first
        assert "STOPPED by key" in alarm


async def test_the_page_stands_behind_the_hints() -> None:
    first = msgspec.structs.replace(scenes.welcome(), panels=scenes.many_panels(90))
    async with piloted_console(first) as pilot:
        assert pilot.text("StopBar").rstrip().endswith("page 1/3")
        await pilot.press("shift+tab")
        assert pilot.text("StopBar").rstrip().endswith("page 3/3")


async def test_on_a_roomy_screen_events_have_their_width_and_the_script_its_words() -> None:
    first = scenes.welcome(state=[*scenes.healthy(), *scenes.sensors()], recent=scenes.history())
    async with piloted_console(first, size=(160, 50)) as pilot:
        assert "head: servo 2 (pitch) overloaded" in pilot.text("EventList")
        assert "Hello P07, nice to see you." in pilot.text("OrderPane")
        places = [
            pilot.console.query_one(name).region for name in ("ActionPanels", "Meters", "EventList")
        ]
        await pilot.tell(scenes.reading(NOW, "temperature", 40.0))
        await pilot.tell(m.StopPressed(source="key", t=NOW))
        assert places == [
            pilot.console.query_one(name).region for name in ("ActionPanels", "Meters", "EventList")
        ]
        await pilot.pilot.resize_terminal(100, 30)
        await pilot.settle()
        assert not pilot.console.query_one("OrderPane").display
