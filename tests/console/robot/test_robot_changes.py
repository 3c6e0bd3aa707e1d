"""The robot's settings on the screen: how they are changed, and what is refused."""

from __future__ import annotations

import functools
from collections.abc import Callable

import msgspec
import pytest
from textual.widgets import Input

from tests.console.robot import pepper
from tests.console.robot.screen import (
    choose,
    dialog,
    done_message,
    line,
    opened_robot_screen,
    runs,
    type_in,
    verbs,
)
from woz_tui.console.screens.robot import RobotDialog, ValueDialog
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import PanelView


async def test_arrows_and_space_change_what_is_chosen() -> None:
    async with opened_robot_screen() as pilot:
        await choose(pilot, "Motors on")
        await pilot.press("space")
        await choose(pilot, "Posture")
        await pilot.press("left")
        await choose(pilot, "Autonomous life")
        await pilot.press("enter")
        await choose(pilot, "Volume")
        await pilot.press("right")
        await choose(pilot, "Speed")
        await pilot.press("left")
        assert verbs(pilot) == [
            ("torque", {"on": False}, "pepper"),
            ("posture", {"name": "Crouch"}, "pepper"),
            ("autonomy", {"state": "interactive"}, "pepper"),
            ("volume", {"level": 0.75}, "pepper"),
            ("speech_speed", {"percent": 90}, "pepper"),
        ]
        asked = pilot.feed.last(r.AskVerb)
        assert isinstance(asked, r.AskVerb)
        assert (asked.source, asked.key) == ("key", "@")
        assert dialog(pilot) is RobotDialog


async def test_what_is_only_shown_sends_nothing() -> None:
    async with opened_robot_screen() as pilot:
        for label in ("Address", "Battery"):
            await choose(pilot, label)
            await pilot.press("left", "right", "space", "enter")
        assert verbs(pilot) == []
        assert "only shown" in pilot.drawn()
        await choose(pilot, "Address")
        assert "chosen under Connection" in pilot.drawn(), "by enter, and not by an arrow too many"


async def test_a_held_arrow_sends_its_last_value_when_the_one_before_is_done() -> None:
    async with opened_robot_screen() as pilot:
        runs(pilot)
        await choose(pilot, "Volume")
        await pilot.press("right", "right", "right")
        assert verbs(pilot) == [("volume", {"level": 0.75}, "pepper")]
        assert line(pilot, "Volume") == "Volume 0.70 → 0.85"
        await pilot.tell(done_message("c1"))
        assert verbs(pilot)[1:] == [("volume", {"level": 0.85}, "pepper")]
        await pilot.tell(pepper.settings_shown(volume=0.75))
        assert line(pilot, "Volume") == "Volume 0.75 → 0.85"
        await pilot.tell(done_message("c2"), pepper.settings_shown(volume=0.85))
        assert line(pilot, "Volume") == "Volume 0.85"
        assert len(verbs(pilot)) == 2


async def test_a_value_that_is_never_read_back_is_not_shown_for_ever() -> None:
    async with opened_robot_screen() as pilot:
        runs(pilot)
        await choose(pilot, "Volume")
        await pilot.press("right")
        await pilot.tell(done_message("c1"))
        assert line(pilot, "Volume") == "Volume 0.70 → 0.75"
        await pilot.pass_time(4.0)
        await pilot.pass_time(0.1)
        assert line(pilot, "Volume") == "Volume 0.70"


async def test_a_refusal_stands_at_its_line() -> None:
    async with opened_robot_screen() as pilot:
        pilot.feed.answers[r.AskVerb] = lambda request, ref: r.Reply(
            ref=ref, ok=False, reason="the stop is on", hint="release it"
        )
        await choose(pilot, "Volume")
        await pilot.press("right")
        assert line(pilot, "Volume") == "Volume 0.70 ⊘ the stop is on (release it)"
        assert "Not done: the stop is on" in pilot.drawn()
        del pilot.feed.answers[r.AskVerb]
        await pilot.press("right")
        assert line(pilot, "Volume") == "Volume 0.70"


REFUSED = functools.partial(m.Refused, code="args")


@pytest.mark.parametrize("kind", [m.Failed, m.TimedOut, REFUSED])
async def test_so_does_what_the_robot_would_not_do(kind: Callable[..., m.Message]) -> None:
    async with opened_robot_screen() as pilot:
        runs(pilot)
        await choose(pilot, "Posture")
        await pilot.press("right")
        await pilot.tell(
            kind(command="c1", driver="pepper", reason="it is charging", remedy="unplug")
        )
        assert line(pilot, "Posture") == "Posture Stand ⊘ it is charging (unplug)"


async def test_a_refusal_after_the_screen_was_closed_is_told_on_the_main_screen() -> None:
    async with opened_robot_screen() as pilot:
        await choose(pilot, "Volume")
        ask = pilot.feed.ask
        held: list[int] = []

        def later(request: r.Request) -> int:
            pilot.feed.asked.append(request)
            held.append(len(pilot.feed.asked))
            return held[-1]

        pilot.feed.ask = later  # type: ignore[method-assign]
        await pilot.press("right")
        await pilot.press("ctrl+q")
        pilot.feed.ask = ask  # type: ignore[method-assign]
        await pilot.tell(r.Reply(ref=held[0], ok=False, reason="the robot is resting"))
        assert "the robot is resting" in pilot.text("StopBar")


async def test_numbers_texts_and_colours_are_typed() -> None:
    async with opened_robot_screen() as pilot:
        for label, typed in (("Volume", "0.33"), ("Colour", "#ff8000"), ("Shows", "wifi")):
            await choose(pilot, label)
            await pilot.press("enter")
            assert dialog(pilot) is ValueDialog
            await pilot.type(typed)
            await pilot.press("enter")
            assert dialog(pilot) is RobotDialog
        assert verbs(pilot) == [
            ("volume", {"level": 0.33}, "pepper"),
            ("eyes", {"color": "#ff8000"}, "pepper"),
            ("tablet", {"what": "wifi"}, "pepper"),
        ]


async def test_a_wrong_number_is_told_in_the_field() -> None:
    async with opened_robot_screen() as pilot:
        await choose(pilot, "Volume")
        await pilot.press("enter")
        await pilot.type("7")
        await pilot.press("enter")
        assert dialog(pilot) is ValueDialog
        assert "7 is out of range; type 0.00 to 1.00." in pilot.drawn()
        pilot.console.screen.query_one("#entry", Input).value = ""
        await pilot.press("enter")
        assert dialog(pilot) is RobotDialog
        assert verbs(pilot) == []


def locked_welcome(*covers: str, is_locked: bool = True) -> r.Welcome:
    first = pepper.welcome(pepper.settings_shown())
    panel = PanelView(title="Lights", actions=[], locked=is_locked, covers=list(covers))
    return msgspec.structs.replace(first, panels=[*first.panels, panel])


async def test_a_line_whose_verb_is_covered_by_a_locked_panel_sends_nothing() -> None:
    async with opened_robot_screen(first=locked_welcome("volume", "eyes")) as pilot:
        await choose(pilot, "Volume")
        await pilot.press("right", "left", "space", "enter")
        assert verbs(pilot) == []
        assert dialog(pilot) is RobotDialog
        assert line(pilot, "Volume") == "Volume 0.70 ◇ locked with Lights"
        assert "Unlock Lights" in pilot.drawn()
        await pilot.tell(m.PanelLocked(panel="Lights", locked=False))
        await pilot.press("right")
        assert verbs(pilot) == [("volume", {"level": 0.75}, "pepper")]


async def test_a_lock_that_comes_while_a_value_is_typed_counts() -> None:
    async with opened_robot_screen(first=locked_welcome("volume", is_locked=False)) as pilot:
        await choose(pilot, "Volume")
        await pilot.press("enter")
        await pilot.type("0.5")
        await pilot.tell(m.PanelLocked(panel="Lights", locked=True))
        await pilot.press("enter")
        assert verbs(pilot) == []


async def test_the_robot_is_chosen() -> None:
    async with opened_robot_screen() as pilot:
        await choose(pilot, "pepper.local")
        await pilot.press("enter")
        await choose(pilot, "Another address")
        await pilot.press("enter")
        await pilot.type("10.0.0.9")
        await pilot.press("enter")
        await choose(pilot, "Disconnect")
        await pilot.press("enter")
        assert verbs(pilot) == [
            ("connect", {"robot": "pepper.local"}, "pepper"),
            ("connect", {"robot": "10.0.0.9"}, "pepper"),
            ("disconnect", {}, "pepper"),
        ]


async def test_a_password_in_an_address_is_sent_nowhere() -> None:
    async with opened_robot_screen(size=(160, 50)) as pilot:
        await choose(pilot, "Another address")
        await pilot.press("enter")
        await type_in(pilot, "tcps://nao:secret@10.0.0.9")
        await pilot.press("enter")
        assert "No password here" in pilot.drawn()
        assert verbs(pilot) == []


async def test_a_connection_that_failed_is_forgotten_with_the_next_try() -> None:
    async with opened_robot_screen(size=(160, 50)) as pilot:
        pilot.feed.answers[r.AskVerb] = lambda request, ref: r.Reply(
            ref=ref, ok=False, reason="nothing listens there"
        )
        await choose(pilot, "Another address")
        await pilot.press("enter")
        assert "now 192.168.1.20" in pilot.drawn()
        assert pilot.drawn().count("tcps://USER@HOST:PORT") == 2, "at the line, and at the field"
        await type_in(pilot, "10.0.0.9")
        await pilot.press("enter")
        assert line(pilot, "Another address").endswith("⊘ nothing listens there")
        del pilot.feed.answers[r.AskVerb]
        await choose(pilot, "pepper.local")
        await pilot.press("enter")
        assert line(pilot, "Another address") == "Another address"


async def test_steps_of_the_arrow_keys_are_changed_here_and_sent_nowhere() -> None:
    async with opened_robot_screen() as pilot:
        await choose(pilot, "Turn, with alt")
        await pilot.press("right", "right")
        await choose(pilot, "Turn, with alt")
        await pilot.press("enter")
        await pilot.type("45")
        await pilot.press("enter")
        assert pilot.console.keyboard.steps.turn == 45
        assert line(pilot, "Turn, with alt") == "Turn, with alt 45°"
        assert verbs(pilot) == []
