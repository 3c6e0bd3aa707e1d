"""A body or a panel in full size is looked at while the robot is played."""

from __future__ import annotations

import msgspec
import pytest

from tests.console import bodies
from tests.console.driving import Sitting, sitting
from woz_tui.console.screens.body import BodyDialog
from woz_tui.console.screens.drawing import DrawingDialog
from woz_tui.console.screens.knobs import KnobsDialog
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r


def command(name: str, verb: str = "play", **more: str) -> m.Command:
    """A command to the body."""
    plain = m.Command(command=name, driver="body", verb=verb, args={}, source="key", t=bodies.NOW)
    return msgspec.structs.replace(plain, **more)


def refused(name: str, reason: str, remedy: str = "") -> m.Refused:
    """The body's answer to a command."""
    return m.Refused(
        command=name, driver="body", reason=reason, remedy=remedy, code="args", t=bodies.NOW
    )


def played(seat: Sitting) -> list[str]:
    """The actions that were asked for."""
    return [asked.action for asked in seat.feed.asked if isinstance(asked, r.AskAction)]


@pytest.mark.toolkit("V1", "K2")
@pytest.mark.parametrize("key", ["semicolon", "plus"])
async def test_keys_play_while_it_is_drawn(key: str) -> None:
    async with sitting(bodies.welcome(bodies.alive())) as seat:
        name = seat.console.state.panels[0].actions[0]
        await seat.press(key)
        assert seat.console.dialog is not None
        assert seat.console.keyboard.arrive(name.key), "taken in the thread that reads the line"
        await seat.press(name.key)
        assert played(seat) == [name.name, name.name]
        await seat.press("space")
        assert any(isinstance(asked, r.AskScript) for asked in seat.feed.asked)
        assert seat.console.dialog is not None


@pytest.mark.parametrize("key", ["semicolon", "plus"])
async def test_the_key_that_opened_it_closes_it(key: str) -> None:
    async with sitting(bodies.welcome(bodies.alive())) as seat:
        for closing in (key, "ctrl+q"):
            await seat.press(key)
            assert isinstance(seat.console.dialog, DrawingDialog)
            await seat.press(closing)
            assert not isinstance(seat.console.dialog, DrawingDialog)


async def test_body_and_panel_take_turns() -> None:
    async with sitting(bodies.welcome(bodies.alive())) as seat:
        await seat.press("semicolon")
        assert isinstance(seat.console.dialog, BodyDialog)
        await seat.press("plus")
        assert isinstance(seat.console.dialog, KnobsDialog)
        await seat.press("plus")
        assert not seat.console.screen.is_modal


async def test_a_text_field_over_it_has_the_keyboard_and_gives_it_back() -> None:
    async with sitting(bodies.welcome(bodies.alive())) as seat:
        key = seat.console.state.panels[0].actions[0].key
        await seat.press("semicolon", "comma")
        await seat.press(key)
        assert not played(seat), "it belongs into the note"
        await seat.press("ctrl+q")
        assert isinstance(seat.console.dialog, BodyDialog)
        await seat.press(key)
        assert len(played(seat)) == 1


async def test_what_is_refused_is_told_with_its_remedy() -> None:
    async with sitting(bodies.welcome(bodies.alive())) as seat:
        name = seat.console.state.panels[0].actions[0]
        await seat.press("semicolon")
        await seat.tell(
            m.ActionRequested(run="a1", action=name.name, source="key", t=bodies.NOW),
            command("c1", run="a1", action=name.name),
            refused(
                "c1",
                "the mode demo ignores animations",
                "mode: normal ends it",
            ),
            m.ActionRefused(run="a1", action=name.name, reason="in the mode demo", t=bodies.NOW),
        )
        told = f"{name.label}: the mode demo ignores animations (mode: normal ends it)"
        assert told[:78] in seat.drawn()


async def test_a_refusal_from_before_is_not_told_again() -> None:
    before: list[m.AnyMessage] = [
        command("c1"),
        refused("c1", "the stop is pressed"),
    ]
    async with sitting(bodies.welcome([*bodies.alive(), *before])) as seat:
        assert "play: the stop is pressed" not in seat.text("StopBar")
        await seat.tell(
            command("c2"),
            refused("c2", "no such move"),
        )
        assert "play: no such move" in seat.text("StopBar")


@pytest.mark.parametrize("role", ["wizard", "watcher"])
async def test_only_who_may_release_the_stop_is_told_the_key(role: str) -> None:
    welcome = msgspec.structs.replace(bodies.welcome(bodies.alive()), role=role)
    async with sitting(welcome) as seat:
        await seat.tell(m.StopPressed(source="key", t=bodies.NOW))
        shown = seat.text("StopBar")
        assert "STOPPED" in shown
        assert ("releases it" in shown) is (role == "wizard")


async def test_a_knob_that_is_refused_is_silent() -> None:
    async with sitting(bodies.welcome(bodies.alive())) as seat:
        await seat.tell(
            command("c2", source="midi", verb="control"),
            refused("c2", "in the mode demo"),
        )
        assert "in the mode demo" not in seat.text("StopBar")
