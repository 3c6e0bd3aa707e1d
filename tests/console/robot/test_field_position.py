"""The field of a dialog that lists what matches: it stays where it is while the list changes."""

from __future__ import annotations

import pytest

from tests.console.piloting import piloted_console
from tests.console.robot import pepper
from tests.console.robot.screen import type_in


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
@pytest.mark.parametrize(
    ("key", "typed"), [("/", "^start(Hey_2"), ("%", "Happy_1 and more"), (":", "welcome")]
)
async def test_the_field_keeps_its_place(key: str, typed: str, size: tuple[int, int]) -> None:
    async with piloted_console(pepper.welcome(pepper.settings_shown()), size=size) as pilot:
        await pilot.press(key)
        screen = pilot.console.screen
        place = screen.query_one("#entry").region
        heights = set()
        for letter in typed:
            await type_in(pilot, letter)
            assert screen.query_one("#entry").region == place
            heights.add(screen.query_one(".dialog").region.height)
            assert screen.query_one(".dialog").region.bottom <= size[1]
        assert len(heights) > 1, "the list did change"
