"""Opening the robot's settings, finding a line there, and what was sent."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from textual.events import Key
from textual.keys import _character_to_key

from tests.console.driving import Sitting, sitting
from tests.console.robot import pepper
from woz_tui.console.screens.robot import RobotDialog
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r


@asynccontextmanager
async def opened(*state: m.AnyMessage, **options: Any) -> AsyncIterator[Sitting]:
    """The screen of a session with a Pepper, by default one that has told its settings."""
    first = options.pop("first", None) or pepper.welcome(*(state or [pepper.shown()]))
    async with sitting(first, **options) as seat:
        await seat.press("@")
        assert dialog(seat) is RobotDialog
        yield seat


def dialog(seat: Sitting) -> type[object]:
    """The kind of dialog on top."""
    return type(seat.console.dialog)


def line(seat: Sitting, label: str) -> str:
    """What stands at this label."""
    place = seat.console.screen.query_one("#drawing").region
    drawn = seat.drawn().splitlines()[place.y : place.bottom]
    rows = [row[place.x : place.right].strip("▸> ") for row in drawn]
    found = [row for row in rows if f"{row} ".startswith(f"{label} ")]
    assert len(found) == 1, (label, found)
    return " ".join(found[0].split())


async def choose(seat: Sitting, label: str) -> None:
    """Go up or down to a line."""
    top = seat.console.dialog
    assert isinstance(top, RobotDialog)
    labels = [each.setting.label for each in top._lines()]
    way = labels.index(label) - top._line
    for _ in range(abs(way)):
        seat.console.post_message(Key("down" if way > 0 else "up", None))
    await seat.settle()
    seat.console.paint()
    await seat.settle()
    assert any(f"▸ {label} " in row for row in seat.drawn().splitlines())


def verbs(seat: Sitting) -> list[tuple[str, dict[str, m.Json], str]]:
    """The verbs that were asked for: verb, arguments, driver."""
    asked = [each for each in seat.feed.asked if isinstance(each, r.AskVerb)]
    return [(each.verb, each.args, each.on) for each in asked]


def runs(seat: Sitting) -> None:
    """Answer each request with the id of its command: c1, c2 ..."""
    count = iter(range(1, 100))
    seat.feed.answers[r.AskVerb] = lambda request, ref: r.Reply(
        ref=ref, ok=True, run=f"c{next(count)}"
    )


def done(command: str) -> m.Done:
    return m.Done(command=command, driver="pepper", latency_us=1, duration_us=1, sent={})


async def type_in(seat: Sitting, text: str) -> None:
    """Type text of whatever characters."""
    for letter in text:
        seat.console.post_message(Key(_character_to_key(letter), letter))
        await seat.settle()
