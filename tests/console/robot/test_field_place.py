"""The field of a dialog that lists what matches: it stays where it is while the list changes."""

from __future__ import annotations

import pytest

from tests.console.driving import sitting
from tests.console.robot import pepper
from tests.console.robot.screen import type_in


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
@pytest.mark.parametrize(
    ("key", "typed"), [("/", "^start(Hey_2"), ("%", "Happy_1 and more"), (":", "welcome")]
)
async def test_the_field_keeps_its_place(key: str, typed: str, size: tuple[int, int]) -> None:
    async with sitting(pepper.welcome(pepper.shown()), size=size) as seat:
        await seat.press(key)
        screen = seat.console.screen
        place = screen.query_one("#entry").region
        heights = set()
        for letter in typed:
            await type_in(seat, letter)
            assert screen.query_one("#entry").region == place
            heights.add(screen.query_one(".dialog").region.height)
            assert screen.query_one(".dialog").region.bottom <= size[1]
        assert len(heights) > 1, "the list did change"
