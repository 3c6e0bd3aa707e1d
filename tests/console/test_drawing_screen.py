"""A body or a panel in full size is looked at while the robot is played."""

from __future__ import annotations

import msgspec
import pytest

from tests.console import bodies
from tests.console.piloting import ConsolePilot, piloted_console
from woz_tui.console.screens.body import BodyDialog
from woz_tui.console.screens.drawing import DrawingDialog
from woz_tui.console.screens.knobs import KnobsDialog
from woz_tui.features.scripts.kinds import AskScript
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r


def command(name: str, verb: str = "play", **more: str) -> m.Command:
    """A command to the body."""
    plain = m.Command(command=name, driver="body", verb=verb, args={}, source="key", t=bodies.NOW)
    return msgspec.structs.replace(plain, **more)


def refused_message(name: str, reason: str, remedy: str = "") -> m.Refused:
    """The body's answer to a command."""
    return m.Refused(
        command=name, driver="body", reason=reason, remedy=remedy, code="args", t=bodies.NOW
    )


def requested_actions(pilot: ConsolePilot) -> list[str]:
    """The actions that were asked for."""
    return [asked.action for asked in pilot.feed.asked if isinstance(asked, r.AskAction)]


@pytest.mark.toolkit("V1", "K2")
@pytest.mark.parametrize("key", ["semicolon", "plus"])
async def test_keys_play_while_it_is_drawn(key: str) -> None:
    async with piloted_console(bodies.welcome(bodies.alive())) as pilot:
        name = pilot.console.state.panels[0].actions[0]
        await pilot.press(key)
        assert pilot.console.dialog is not None
        assert pilot.console.keyboard.arrive(name.key), "taken in the thread that reads the line"
        await pilot.press(name.key)
        assert requested_actions(pilot) == [name.name, name.name]
        await pilot.press("space")
        assert any(isinstance(asked, AskScript) for asked in pilot.feed.asked)
        assert pilot.console.dialog is not None


@pytest.mark.parametrize("key", ["semicolon", "plus"])
async def test_the_key_that_opened_it_closes_it(key: str) -> None:
    async with piloted_console(bodies.welcome(bodies.alive())) as pilot:
        for closing in (key, "ctrl+q"):
            await pilot.press(key)
            assert isinstance(pilot.console.dialog, DrawingDialog)
            await pilot.press(closing)
            assert not isinstance(pilot.console.dialog, DrawingDialog)


async def test_body_and_panel_take_turns() -> None:
    async with piloted_console(bodies.welcome(bodies.alive())) as pilot:
        await pilot.press("semicolon")
        assert isinstance(pilot.console.dialog, BodyDialog)
        await pilot.press("plus")
        assert isinstance(pilot.console.dialog, KnobsDialog)
        await pilot.press("plus")
        assert not pilot.console.screen.is_modal


async def test_a_text_field_over_it_has_the_keyboard_and_gives_it_back() -> None:
    async with piloted_console(bodies.welcome(bodies.alive())) as pilot:
        key = pilot.console.state.panels[0].actions[0].key
        await pilot.press("semicolon", "comma")
        await pilot.press(key)
        assert not requested_actions(pilot), "it belongs into the note"
        await pilot.press("ctrl+q")
        assert isinstance(pilot.console.dialog, BodyDialog)
        await pilot.press(key)
        assert len(requested_actions(pilot)) == 1


async def test_what_is_refused_is_told_with_its_remedy() -> None:
    async with piloted_console(bodies.welcome(bodies.alive())) as pilot:
        name = pilot.console.state.panels[0].actions[0]
        await pilot.press("semicolon")
        await pilot.tell(
            m.ActionRequested(run="a1", action=name.name, source="key", t=bodies.NOW),
            command("c1", run="a1", action=name.name),
            refused_message(
                "c1",
                "the mode demo ignores animations",
                "mode: normal ends it",
            ),
            m.ActionRefused(run="a1", action=name.name, reason="in the mode demo", t=bodies.NOW),
        )
        told = f"{name.label}: the mode demo ignores animations (mode: normal ends it)"
        assert told[:78] in pilot.drawn()


async def test_a_refusal_from_before_is_not_told_again() -> None:
    before: list[m.Message] = [
        command("c1"),
        refused_message("c1", "the stop is pressed"),
    ]
    async with piloted_console(bodies.welcome([*bodies.alive(), *before])) as pilot:
        assert "play: the stop is pressed" not in pilot.text("StopBar")
        await pilot.tell(
            command("c2"),
            refused_message("c2", "no such move"),
        )
        assert "play: no such move" in pilot.text("StopBar")


@pytest.mark.parametrize("role", ["wizard", "watcher"])
async def test_only_who_may_release_the_stop_is_told_the_key(role: str) -> None:
    welcome = msgspec.structs.replace(bodies.welcome(bodies.alive()), role=role)
    async with piloted_console(welcome) as pilot:
        await pilot.tell(m.StopPressed(source="key", t=bodies.NOW))
        shown = pilot.text("StopBar")
        assert "STOPPED" in shown
        assert ("^R releases" in shown) is (role == "wizard")


async def test_a_knob_that_is_refused_is_silent() -> None:
    async with piloted_console(bodies.welcome(bodies.alive())) as pilot:
        await pilot.tell(
            command("c2", source="midi", verb="control"),
            refused_message("c2", "in the mode demo"),
        )
        assert "in the mode demo" not in pilot.text("StopBar")
