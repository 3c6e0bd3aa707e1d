"""The keys that the lowest line names: only those that do something in this session."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest

from tests.console import scenes
from tests.console.piloting import piloted_console
from tests.console.robot import pepper
from woz_tui.console.commands import COMMANDS, by_key, hints
from woz_tui.console.drawing.cells import length
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.widgets.bottom_rows import BarInfo, News, bar_rows
from woz_tui.protocol import requests as r
from woz_tui.system.user_folders import is_first_start


def named(first: r.Welcome) -> list[str]:
    state = ConsoleState()
    state.apply([first], 0)
    return [word for _, word in hints(state, by_key(COMMANDS))]


def test_a_robots_keys_are_named_where_there_is_a_robot() -> None:
    assert "robot" not in named(scenes.welcome())
    told = named(pepper.welcome())
    assert [word for word in told if word in ("robot", "gesture", "camera")] == [
        "robot",
        "gesture",
        "camera",
    ]


def test_the_scripts_key_is_named_where_there_is_a_script() -> None:
    assert "script" in named(scenes.welcome())
    assert "script" not in named(msgspec.structs.replace(scenes.welcome(), script=[]))
    assert "script" in [word for _, word in hints(ConsoleState(), by_key(COMMANDS))], (
        "nobody knows yet"
    )


@pytest.mark.parametrize("script", [True, False])
async def test_the_robots_key_has_room_in_80_columns(script: bool) -> None:
    first = pepper.welcome(pepper.settings_shown())
    if not script:
        first = msgspec.structs.replace(first, script=[])
    async with piloted_console(first) as pilot:
        assert "@ robot" in pilot.drawn().splitlines()[-1]


def hint_texts(news: str, width: int = 80) -> list[str]:
    rows = bar_rows(
        ConsoleState(),
        PaintFrame(width, 2, 0),
        BarInfo(News(news), (("Esc", "stop"),), ("Space", "")),
    )
    assert [length(row) for row in rows] == [width, width]
    return ["".join(text for text, _ in row).strip() for row in rows]


def test_news_that_is_too_long_for_a_line_takes_both() -> None:
    long = "this console only watches; another console plays the robot"
    remedy = "(start `woz attach --take-over` to play the robot here)"
    assert hint_texts(long)[1] == long
    assert hint_texts(f"{long} {remedy}") == [
        f"{long} (start `woz attach",
        "--take-over` to play the robot here)",
    ]
    assert hint_texts("word " * 100)[1].endswith("…")
    assert hint_texts("x" * 200)[1].endswith("…")


async def test_who_sees_the_console_for_the_first_time_reads_how_to_stop_and_to_leave() -> None:
    async with piloted_console(greets=True) as pilot:
        assert "Esc stops the robot; ^Q closes; ? lists all keys" in pilot.drawn()
        await pilot.pass_time(9)
        assert "stops the robot" not in pilot.drawn()


def test_the_first_start_is_remembered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert is_first_start()
    assert not is_first_start()
    monkeypatch.setenv("XDG_STATE_HOME", "/proc/nowhere")
    assert not is_first_start(), "a folder that takes nothing"
