"""Releasing the stop: never by a single key while somebody may still move."""

from __future__ import annotations

import msgspec
import pytest

from tests.console import scenes
from tests.console.piloting import ConsolePilot, piloted_console
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import ActionView, PanelView

ROBOTS = ["pepper.pepper", "nao.nao", "reachy.reachy", "furhat.furhat", "ros.turtlebot"]
RELEASED = m.StopReleased(source="key", t=scenes.NOW + 1)
PRESSED = m.StopPressed(source="key", t=scenes.NOW)


def confirmation(*missing: str, unreached: list[str] | None = None) -> m.StopConfirmed:
    well = [name for name in ROBOTS if name not in missing]
    return m.StopConfirmed(
        confirmed=well, missing=[*missing], unreached=unreached or [], elapsed_us=500_000
    )


def robots() -> list[m.Message]:
    return [scenes.start(), *(m.DriverConnected(driver=name) for name in ROBOTS)]


def released(pilot: ConsolePilot) -> int:
    return sum(isinstance(asked, r.AskRelease) for asked in pilot.feed.asked)


async def test_a_stop_that_all_confirmed_is_released_by_one_key() -> None:
    async with piloted_console(scenes.welcome(robots())) as pilot:
        await pilot.tell(PRESSED, confirmation())
        assert "^R releases" in pilot.text("StopBar")
        await pilot.press("ctrl+r")
        assert released(pilot) == 1
        assert pilot.console.dialog is None


async def test_who_has_not_confirmed_is_named_before_the_release() -> None:
    async with piloted_console(scenes.welcome(robots())) as pilot:
        await pilot.tell(PRESSED, confirmation("nao.nao", "furhat.furhat", unreached=["nao.nao"]))
        assert "^R releases (asks first)" in pilot.text("StopBar")
        await pilot.press("ctrl+r", "ctrl+r", "h", "space")
        assert released(pilot) == 0
        drawn = pilot.drawn()
        assert "not reached: nao" in drawn
        assert "not confirmed: furhat" in drawn
        assert "confirmed: pepper, reachy" in drawn
        await pilot.press("enter")
        assert released(pilot) == 1
        asked = pilot.feed.last(r.AskRelease)
        assert isinstance(asked, r.AskRelease)
        assert asked.missing == ["nao.nao", "furhat.furhat"]
        assert pilot.console.dialog is None


async def test_a_robot_that_comes_back_and_confirms_releases_nothing_by_itself() -> None:
    async with piloted_console(scenes.welcome(robots())) as pilot:
        await pilot.tell(PRESSED, confirmation("nao.nao"))
        await pilot.press("ctrl+r")
        await pilot.tell(m.StopPressed(source="return of nao.nao", t=scenes.NOW), confirmation())
        assert released(pilot) == 0
        assert "All have confirmed now" in pilot.drawn()
        await pilot.press("enter")
        assert released(pilot) == 1


async def test_the_question_can_be_declined_and_the_stop_pressed_in_it() -> None:
    async with piloted_console(scenes.welcome(robots())) as pilot:
        await pilot.tell(PRESSED, confirmation("nao.nao"))
        await pilot.press("ctrl+r", "ctrl+q")
        assert pilot.console.dialog is None
        await pilot.press("ctrl+r", "escape")
        assert pilot.feed.last(r.AskStop) is not None
        await pilot.until(lambda: pilot.console.dialog is None)
        assert released(pilot) == 0


async def test_a_release_before_the_confirmation_waits_for_it() -> None:
    async with piloted_console(scenes.welcome(robots())) as pilot:
        await pilot.tell(PRESSED)
        await pilot.press("ctrl+r")
        assert released(pilot) == 0
        assert "not confirmed the stop yet" in pilot.drawn()
        await pilot.tell(confirmation())
        assert released(pilot) == 1
        assert pilot.console.dialog is None


async def test_a_release_right_behind_the_stop_does_not_overtake_its_confirmation() -> None:
    async with piloted_console(scenes.welcome(robots())) as pilot:
        await pilot.press("escape")
        await pilot.until(lambda: "STOP SENT" in pilot.text("StopBar"))
        await pilot.press("ctrl+r")
        assert released(pilot) == 0
        await pilot.tell(PRESSED)
        assert released(pilot) == 0
        await pilot.tell(confirmation())
        assert released(pilot) == 1


async def test_a_release_before_the_confirmation_asks_if_somebody_is_missing() -> None:
    async with piloted_console(scenes.welcome(robots())) as pilot:
        await pilot.tell(PRESSED)
        await pilot.press("ctrl+r")
        await pilot.tell(confirmation("reachy.reachy"))
        assert released(pilot) == 0
        assert "not confirmed: reachy" in pilot.drawn()
        await pilot.tell(m.StopReleased(source="program", t=scenes.NOW))
        assert pilot.console.dialog is None


async def test_a_robot_of_one_driver_is_called_by_its_name_in_events() -> None:
    async with piloted_console(scenes.welcome(robots())) as pilot:
        await pilot.tell(m.DriverLost(driver="furhat.furhat", detail="it does not answer"))
        assert "furhat lost  it does not" in pilot.text("EventList")


@pytest.mark.parametrize("width", [80, 160])
async def test_the_bar_names_five_robots_without_cutting_any(width: int) -> None:
    async with piloted_console(scenes.welcome(robots()), size=(width, 24)) as pilot:
        for missing in ([], ["nao.nao"], ["nao.nao", "furhat.furhat"], ROBOTS):
            await pilot.tell(PRESSED, confirmation(*missing, unreached=missing[:1]))
            shown = pilot.text("StopBar").splitlines()[-1]
            assert "…" not in shown
            for name in ROBOTS if len(missing) < 2 else missing:
                assert name.partition(".")[0] in shown


async def test_what_has_no_room_is_counted_and_the_key_is_named() -> None:
    names = [f"a-very-long-robot-name-{n}" for n in range(6)]
    confirmed = m.StopConfirmed(
        confirmed=names[4:], missing=names[:4], unreached=names[:1], elapsed_us=1
    )
    async with piloted_console(scenes.welcome(robots())) as pilot:
        await pilot.tell(PRESSED, confirmed)
        shown = pilot.text("StopBar")
        assert "1 NOT REACHED" in shown
        assert "3 NOT CONFIRMED" in shown
        assert "2 of 6 confirmed; ^R names them" in shown
        await pilot.press("ctrl+r")
        drawn = "".join(pilot.drawn().split())
        assert all(name.replace(" ", "") in drawn.replace("│", "") for name in names)


@pytest.mark.parametrize(("yaw", "offered"), [(30.0, True), (4.0, False)])
async def test_after_a_stop_that_left_the_robot_turned_away_the_key_for_home_is_named(
    yaw: float, offered: bool
) -> None:
    home = ActionView(name="Home", label="Home", key="0", verbs=["home"])
    first = msgspec.structs.replace(
        scenes.welcome(), panels=[PanelView(title="Body", actions=[home])]
    )
    async with piloted_console(first) as pilot:
        turned = scenes.reading(scenes.NOW, "joint.head.yaw", yaw, driver="head", unit="deg")
        await pilot.tell(turned, PRESSED, confirmation(), RELEASED)
        told = "The robot is still turned away (yaw 30°); press 0: Home"
        assert (told in pilot.text("StopBar")) is offered
