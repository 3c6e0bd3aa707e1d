"""Opening the robot's settings, finding a line there, and what was sent."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from textual.events import Key
from textual.keys import _character_to_key

from tests.console.piloting import ConsolePilot, piloted_console
from tests.console.robot import pepper
from woz_tui.console.screens.robot import RobotDialog
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r


@asynccontextmanager
async def opened_robot_screen(*state: m.Message, **options: Any) -> AsyncIterator[ConsolePilot]:
    """The screen of a session with a Pepper, by default one that has told its settings."""
    first = options.pop("first", None) or pepper.welcome(*(state or [pepper.settings_shown()]))
    async with piloted_console(first, **options) as pilot:
        await pilot.press("@")
        assert dialog(pilot) is RobotDialog
        yield pilot


def dialog(pilot: ConsolePilot) -> type[object]:
    """The kind of dialog on top."""
    return type(pilot.console.dialog)


def line(pilot: ConsolePilot, label: str) -> str:
    """What stands at this label."""
    place = pilot.console.screen.query_one("#drawing").region
    drawn = pilot.drawn().splitlines()[place.y : place.bottom]
    rows = [row[place.x : place.right].strip("▸> ") for row in drawn]
    found = [row for row in rows if f"{row} ".startswith(f"{label} ")]
    assert len(found) == 1, (label, found)
    return " ".join(found[0].split())


async def choose(pilot: ConsolePilot, label: str) -> None:
    """Go up or down to a line."""
    top = pilot.console.dialog
    assert isinstance(top, RobotDialog)
    labels = [each.setting.label for each in top._lines()]
    way = labels.index(label) - top._line
    for _ in range(abs(way)):
        pilot.console.post_message(Key("down" if way > 0 else "up", None))
    await pilot.settle()
    pilot.console.paint()
    await pilot.settle()
    assert any(f"▸ {label} " in row for row in pilot.drawn().splitlines())


def verbs(pilot: ConsolePilot) -> list[tuple[str, dict[str, m.Json], str]]:
    """The verbs that were asked for: verb, arguments, driver."""
    asked = [each for each in pilot.feed.asked if isinstance(each, r.AskVerb)]
    return [(each.verb, each.args, each.on) for each in asked]


def runs(pilot: ConsolePilot) -> None:
    """Answer each request with the id of its command: c1, c2 ..."""
    count = iter(range(1, 100))
    pilot.feed.answers[r.AskVerb] = lambda request, ref: r.Reply(
        ref=ref, ok=True, run=f"c{next(count)}"
    )


def done_message(command: str) -> m.Done:
    return m.Done(command=command, driver="pepper", latency_us=1, duration_us=1, sent={})


async def type_in(pilot: ConsolePilot, text: str) -> None:
    """Type text of whatever characters."""
    for letter in text:
        pilot.console.post_message(Key(_character_to_key(letter), letter))
        await pilot.settle()
