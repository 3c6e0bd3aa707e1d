"""The console shows texts as they are, whatever they look like: no markup, no sequences."""

from __future__ import annotations

import json
import re
from collections.abc import Callable

import pytest
from rich.text import Text

from tests.console import scenes, study_scene
from tests.console.dialogs import OPENERS
from tests.console.piloting import piloted_console
from tests.console.robot import pepper
from tests.fakes.hostile_texts import HOSTILE, MARKUP, OBEYED, WORDS, hostile
from woz_tui.console.screens.robot import ValueDialog
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.robot_outline import RobotOutline, Setting

#: What else is no text but chosen from a list, or a pattern.
_CHOSEN = WORDS | {"keyboard", "key", "role", "when", "order", "health", "participant_pattern"}


def made_hostile(welcome: r.Welcome) -> r.Welcome:
    found = codec.decode_incoming(
        json.dumps(hostile(json.loads(codec.encode(welcome)), _CHOSEN)).encode()
    )
    assert isinstance(found, r.Welcome)
    return found


def guide() -> r.Welcome:
    state = [*scenes.healthy(), *scenes.sensors(), study_scene.conditions_assigned()]
    settings: dict[str, m.Json] = {"study": study_scene.study_description(due=["robot"])}
    return scenes.welcome(state, scenes.history(), settings=settings)


SESSIONS: dict[str, Callable[[], r.Welcome]] = {
    "guide": guide,
    "pepper": lambda: pepper.welcome(pepper.settings_shown()),
}


@pytest.mark.parametrize("name", SESSIONS)
async def test_nothing_of_a_text_reaches_the_terminal_as_a_command(name: str) -> None:
    async with piloted_console(made_hostile(SESSIONS[name]()), size=(160, 50)) as pilot:
        assert not OBEYED.search(pilot.drawn())
        for dialog, key in OPENERS.items():
            await pilot.press(key)
            assert not OBEYED.search(pilot.drawn()), dialog
            await pilot.press("enter")
            assert not OBEYED.search(pilot.drawn()), f"{dialog} after enter"
            while pilot.console.dialog is not None:
                await pilot.press("ctrl+q")


async def test_a_dialogs_title_is_no_markup() -> None:
    volume = Setting(
        name="volume", section="Voice", label=f"Volume {MARKUP}", verb="volume",
        argument="level", kind="number", low=0.0, high=1.0, help=HOSTILE,
    )  # fmt: skip
    outlines: dict[str, m.Json] = {"pepper": RobotOutline(settings=[volume]).as_json()}
    first = pepper.welcome(pepper.settings_shown(), outlines=outlines)
    async with piloted_console(first, size=(160, 50)) as pilot:
        await pilot.press("@", "enter")
        assert isinstance(pilot.console.dialog, ValueDialog)
        assert "pepper: Volume [/x] [bold]b[/bold]" in pilot.drawn()
        assert not OBEYED.search(pilot.drawn())


async def test_a_crash_commands_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    async with piloted_console() as pilot:
        pass
    pilot.console.error_console.print(Text(HOSTILE))
    err = capsys.readouterr().err
    assert MARKUP in err
    assert not OBEYED.search(re.sub("\x1b\\[[0-9;]*m", "", err))
