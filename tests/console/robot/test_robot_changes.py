"""The robot's settings on the screen: how they are changed, and what is refused."""

from __future__ import annotations

import functools
from collections.abc import Callable

import msgspec
import pytest
from textual.widgets import Input

from tests.console.robot import pepper
from tests.console.robot.screen import choose, dialog, done, line, opened, runs, type_in, verbs
from woz_tui.console.screens.robot import RobotDialog, ValueDialog
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import PanelView


async def test_arrows_and_space_change_what_is_chosen() -> None:
    async with opened() as seat:
        await choose(seat, "Motors on")
        await seat.press("space")
        await choose(seat, "Posture")
        await seat.press("left")
        await choose(seat, "Autonomous life")
        await seat.press("enter")
        await choose(seat, "Volume")
        await seat.press("right")
        await choose(seat, "Speed")
        await seat.press("left")
        assert verbs(seat) == [
            ("torque", {"on": False}, "pepper"),
            ("posture", {"name": "Crouch"}, "pepper"),
            ("autonomy", {"state": "interactive"}, "pepper"),
            ("volume", {"level": 0.75}, "pepper"),
            ("speech_speed", {"percent": 90}, "pepper"),
        ]
        asked = seat.feed.last(r.AskVerb)
        assert isinstance(asked, r.AskVerb)
        assert (asked.source, asked.key) == ("key", "@")
        assert dialog(seat) is RobotDialog


async def test_what_is_only_shown_sends_nothing() -> None:
    async with opened() as seat:
        for label in ("Address", "Battery"):
            await choose(seat, label)
            await seat.press("left", "right", "space", "enter")
        assert verbs(seat) == []
        assert "only shown" in seat.drawn()
        await choose(seat, "Address")
        assert "chosen under Connection" in seat.drawn(), "by enter, and not by an arrow too many"


async def test_a_held_arrow_sends_its_last_value_when_the_one_before_is_done() -> None:
    async with opened() as seat:
        runs(seat)
        await choose(seat, "Volume")
        await seat.press("right", "right", "right")
        assert verbs(seat) == [("volume", {"level": 0.75}, "pepper")]
        assert line(seat, "Volume") == "Volume 0.70 → 0.85"
        await seat.tell(done("c1"))
        assert verbs(seat)[1:] == [("volume", {"level": 0.85}, "pepper")]
        await seat.tell(pepper.shown(volume=0.75))
        assert line(seat, "Volume") == "Volume 0.75 → 0.85"
        await seat.tell(done("c2"), pepper.shown(volume=0.85))
        assert line(seat, "Volume") == "Volume 0.85"
        assert len(verbs(seat)) == 2


async def test_a_value_that_is_never_read_back_is_not_shown_for_ever() -> None:
    async with opened() as seat:
        runs(seat)
        await choose(seat, "Volume")
        await seat.press("right")
        await seat.tell(done("c1"))
        assert line(seat, "Volume") == "Volume 0.70 → 0.75"
        await seat.pass_time(4.0)
        await seat.pass_time(0.1)
        assert line(seat, "Volume") == "Volume 0.70"


async def test_a_refusal_stands_at_its_line() -> None:
    async with opened() as seat:
        seat.feed.answers[r.AskVerb] = lambda request, ref: r.Reply(
            ref=ref, ok=False, reason="the stop is on", hint="release it"
        )
        await choose(seat, "Volume")
        await seat.press("right")
        assert line(seat, "Volume") == "Volume 0.70 ⊘ the stop is on (release it)"
        assert "Not done: the stop is on" in seat.drawn()
        del seat.feed.answers[r.AskVerb]
        await seat.press("right")
        assert line(seat, "Volume") == "Volume 0.70"


REFUSED = functools.partial(m.Refused, code="args")


@pytest.mark.parametrize("kind", [m.Failed, m.TimedOut, REFUSED])
async def test_so_does_what_the_robot_would_not_do(kind: Callable[..., m.AnyMessage]) -> None:
    async with opened() as seat:
        runs(seat)
        await choose(seat, "Posture")
        await seat.press("right")
        await seat.tell(
            kind(command="c1", driver="pepper", reason="it is charging", remedy="unplug")
        )
        assert line(seat, "Posture") == "Posture Stand ⊘ it is charging (unplug)"


async def test_a_refusal_after_the_screen_was_closed_is_told_on_the_main_screen() -> None:
    async with opened() as seat:
        await choose(seat, "Volume")
        ask = seat.feed.ask
        held: list[int] = []

        def later(request: r.AnyRequest) -> int:
            seat.feed.asked.append(request)
            held.append(len(seat.feed.asked))
            return held[-1]

        seat.feed.ask = later  # type: ignore[method-assign]
        await seat.press("right")
        await seat.press("ctrl+q")
        seat.feed.ask = ask  # type: ignore[method-assign]
        await seat.tell(r.Reply(ref=held[0], ok=False, reason="the robot is resting"))
        assert "the robot is resting" in seat.text("StopBar")


async def test_numbers_texts_and_colours_are_typed() -> None:
    async with opened() as seat:
        for label, typed in (("Volume", "0.33"), ("Colour", "#ff8000"), ("Shows", "wifi")):
            await choose(seat, label)
            await seat.press("enter")
            assert dialog(seat) is ValueDialog
            await seat.type(typed)
            await seat.press("enter")
            assert dialog(seat) is RobotDialog
        assert verbs(seat) == [
            ("volume", {"level": 0.33}, "pepper"),
            ("eyes", {"color": "#ff8000"}, "pepper"),
            ("tablet", {"what": "wifi"}, "pepper"),
        ]


async def test_a_wrong_number_is_told_in_the_field() -> None:
    async with opened() as seat:
        await choose(seat, "Volume")
        await seat.press("enter")
        await seat.type("7")
        await seat.press("enter")
        assert dialog(seat) is ValueDialog
        assert "7 is out of range; type 0.00 to 1.00." in seat.drawn()
        seat.console.screen.query_one("#entry", Input).value = ""
        await seat.press("enter")
        assert dialog(seat) is RobotDialog
        assert verbs(seat) == []


def locked(*covers: str, is_locked: bool = True) -> r.Welcome:
    first = pepper.welcome(pepper.shown())
    panel = PanelView(title="Lights", actions=[], locked=is_locked, covers=list(covers))
    return msgspec.structs.replace(first, panels=[*first.panels, panel])


async def test_a_line_whose_verb_is_covered_by_a_locked_panel_sends_nothing() -> None:
    async with opened(first=locked("volume", "eyes")) as seat:
        await choose(seat, "Volume")
        await seat.press("right", "left", "space", "enter")
        assert verbs(seat) == []
        assert dialog(seat) is RobotDialog
        assert line(seat, "Volume") == "Volume 0.70 ◇ locked with Lights"
        assert "Unlock Lights" in seat.drawn()
        await seat.tell(m.PanelLocked(panel="Lights", locked=False))
        await seat.press("right")
        assert verbs(seat) == [("volume", {"level": 0.75}, "pepper")]


async def test_a_lock_that_comes_while_a_value_is_typed_counts() -> None:
    async with opened(first=locked("volume", is_locked=False)) as seat:
        await choose(seat, "Volume")
        await seat.press("enter")
        await seat.type("0.5")
        await seat.tell(m.PanelLocked(panel="Lights", locked=True))
        await seat.press("enter")
        assert verbs(seat) == []


async def test_the_robot_is_chosen() -> None:
    async with opened() as seat:
        await choose(seat, "pepper.local")
        await seat.press("enter")
        await choose(seat, "Another address")
        await seat.press("enter")
        await seat.type("10.0.0.9")
        await seat.press("enter")
        await choose(seat, "Disconnect")
        await seat.press("enter")
        assert verbs(seat) == [
            ("connect", {"robot": "pepper.local"}, "pepper"),
            ("connect", {"robot": "10.0.0.9"}, "pepper"),
            ("disconnect", {}, "pepper"),
        ]


async def test_a_password_in_an_address_is_sent_nowhere() -> None:
    async with opened(size=(160, 50)) as seat:
        await choose(seat, "Another address")
        await seat.press("enter")
        await type_in(seat, "tcps://nao:secret@10.0.0.9")
        await seat.press("enter")
        assert "No password here" in seat.drawn()
        assert verbs(seat) == []


async def test_a_connection_that_failed_is_forgotten_with_the_next_try() -> None:
    async with opened(size=(160, 50)) as seat:
        seat.feed.answers[r.AskVerb] = lambda request, ref: r.Reply(
            ref=ref, ok=False, reason="nothing listens there"
        )
        await choose(seat, "Another address")
        await seat.press("enter")
        assert "now 192.168.1.20" in seat.drawn()
        assert seat.drawn().count("tcps://USER@HOST:PORT") == 2, "at the line, and at the field"
        await type_in(seat, "10.0.0.9")
        await seat.press("enter")
        assert line(seat, "Another address").endswith("⊘ nothing listens there")
        del seat.feed.answers[r.AskVerb]
        await choose(seat, "pepper.local")
        await seat.press("enter")
        assert line(seat, "Another address") == "Another address"


async def test_steps_of_the_arrow_keys_are_changed_here_and_sent_nowhere() -> None:
    async with opened() as seat:
        await choose(seat, "Turn, with alt")
        await seat.press("right", "right")
        await choose(seat, "Turn, with alt")
        await seat.press("enter")
        await seat.type("45")
        await seat.press("enter")
        assert seat.console.keyboard.steps.turn == 45
        assert line(seat, "Turn, with alt") == "Turn, with alt 45°"
        assert verbs(seat) == []
