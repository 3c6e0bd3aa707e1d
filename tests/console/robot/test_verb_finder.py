"""What a robot can do without a button: found by typing."""

from __future__ import annotations

import msgspec
import pytest
from woz_drivers.pepper.driver import Pepper
from woz_drivers.pepper.settings import PepperSettings

from tests.console import scenes
from tests.console.piloting import piloted_console
from tests.console.robot import pepper
from tests.console.robot.screen import dialog, type_in, verbs
from woz_tui.console.screens.find import OFFERED_CALLS, FindDialog
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r


def offering(*more: str) -> r.Welcome:
    """A session with a Pepper that offers these verbs, too."""
    first = pepper.welcome(pepper.settings_shown())
    return msgspec.structs.replace(first, verbs={"pepper": [*first.verbs["pepper"], *more]})


@pytest.mark.parametrize(
    ("typed", "asked"),
    [
        ("record its microphones, on", ("record_sound", {"on": True}, "pepper")),
        ("end the recording on", ("record_sound", {"on": False}, "pepper")),
        ("record its microphones, b", ("listen", {"on": True}, "pepper")),
        ("end the recording b", ("listen", {"on": False}, "pepper")),
        ("picture of", ("picture", {}, "pepper")),
        ("show nothing", ("tablet", {"what": "hide"}, "pepper")),
    ],
)
async def test_it_is_found_and_done(typed: str, asked: tuple[str, dict[str, m.Json], str]) -> None:
    async with piloted_console(offering("picture", "record_sound", "listen")) as pilot:
        await pilot.press(":")
        assert dialog(pilot) is FindDialog
        await type_in(pilot, typed)
        await pilot.press("enter")
        if asked[1] == {"on": False}:
            assert "Are you sure?" in pilot.drawn()
            await pilot.press("down", "enter")
        assert verbs(pilot) == [asked]
        sent = pilot.feed.last(r.AskVerb)
        assert isinstance(sent, r.AskVerb)
        assert (sent.source, sent.key) == ("key", ":")


async def test_what_the_robot_does_not_offer_is_not_there() -> None:
    for first in (offering("picture"), scenes.welcome()):
        async with piloted_console(first) as pilot:
            await pilot.press(":")
            await type_in(pilot, "recording")
            assert "end the recording" not in pilot.drawn()
            await pilot.press("enter")
            assert verbs(pilot) == []


def test_pepper_takes_all_of_them() -> None:
    """Names, arguments and choices are those of the driver."""
    offered = {verb.name: verb for verb in Pepper.offer(PepperSettings(robots=())).verbs}
    for order in OFFERED_CALLS:
        arguments = {argument.name: argument for argument in offered[order.verb].arguments}
        assert set(order.args) <= set(arguments)
        for name, value in order.args.items():
            choices = arguments[name].choices
            assert not choices or value in choices
