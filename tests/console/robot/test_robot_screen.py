"""The robot's settings on the screen: what is read there."""

from __future__ import annotations

import asyncio

import pytest
from textual.events import Key

from tests.console.piloting import ConsolePilot, piloted_console
from tests.console.robot import pepper
from tests.console.robot.screen import choose, line, opened_robot_screen, verbs
from woz_tui.console.drawing.glyphs import ASCII
from woz_tui.console.drawing.theme import Appearance
from woz_tui.console.replay.commands import COMMANDS
from woz_tui.console.screens.robot import RobotDialog
from woz_tui.features.scripts.kinds import AskScript
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r


async def test_values_are_shown_and_unknown_ones_are_a_dash() -> None:
    async with opened_robot_screen() as pilot:
        assert line(pilot, "Motors on") == "Motors on on"
        assert line(pilot, "Arms keep off") == "Arms keep off 0.10 m"
        assert line(pilot, "Blinks") == "Blinks on"
        await pilot.press("end")
        assert line(pilot, "Shows") == "Shows -"
        assert line(pilot, "192.168.1.20").endswith("● this one")
        await pilot.tell(pepper.settings_shown(tablet="page"))
        assert line(pilot, "Shows") == "Shows page"


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
@pytest.mark.parametrize("glyphs", ["unicode", "ascii"])
async def test_a_difference_and_a_conflict_are_words(size: tuple[int, int], glyphs: str) -> None:
    look = {"look": Appearance(ASCII)} if glyphs == "ascii" else {}
    settings_shown = pepper.settings_shown(
        {"state": "interactive"}, ("Awareness is off.", "Life is off.")
    )
    async with opened_robot_screen(settings_shown, size=size, **look) as pilot:
        sign = "!" if glyphs == "ascii" else "▲"
        assert (
            line(pilot, "Autonomous life") == f"Autonomous life solitary {sign} wanted interactive"
        )
        drawn = pilot.drawn()
        assert f"{sign} Awareness is off." in drawn
        assert f"{sign} Life is off." in drawn
        assert "1 setting differs, 2 conflicts" in drawn
        if glyphs == "ascii":
            mine = pilot.console.screen.query_one("#drawing").region
            rows = [row[mine.x : mine.right] for row in drawn.splitlines()[mine.y : mine.bottom]]
            assert "".join(rows).isascii()


@pytest.mark.parametrize(
    ("conflicts", "told"),
    [
        (("One.",), "One."),
        (("One.", "Two.", "Three.", "Four."), "and 2 more"),
        (("This one is told at length. " * 20,), "at length"),
    ],
)
async def test_nothing_jumps_when_values_change(conflicts: tuple[str, ...], told: str) -> None:
    async with opened_robot_screen() as pilot:
        labels = ("Autonomous life", "Engagement", "Battery")
        before = [at(pilot, label) for label in labels]
        await pilot.tell(pepper.settings_shown({"volume": 0.2, "state": "disabled"}, conflicts))
        assert told in pilot.drawn()
        assert [at(pilot, label) for label in labels] == before


def at(pilot: ConsolePilot, label: str) -> tuple[int, int]:
    """Row and column of a label."""
    rows = pilot.drawn().splitlines()
    return next((row, text.index(label)) for row, text in enumerate(rows) if label in text)


async def test_other_keys_play_and_the_opening_key_closes() -> None:
    async with opened_robot_screen() as pilot:
        await pilot.press("h")
        asked = pilot.feed.last(r.AskAction)
        assert isinstance(asked, r.AskAction)
        assert asked.action == "Hello"
        assert pilot.console.keyboard.arrive("w"), "taken in the thread that reads the line"
        assert not pilot.console.keyboard.arrive("space"), "it belongs to the screen"
        assert pilot.feed.last(AskScript) is None
        await pilot.press("@")
        assert pilot.console.dialog is None


async def test_space_neither_takes_nor_lets_go_of_a_robot() -> None:
    async with opened_robot_screen() as pilot:
        for label in ("pepper.local", "Disconnect"):
            await choose(pilot, label)
            await pilot.press("space")
        assert verbs(pilot) == []


async def test_a_lost_robots_values_are_old() -> None:
    async with opened_robot_screen(
        pepper.settings_shown({"volume": 0.1}, ("They fight.",))
    ) as pilot:
        await pilot.tell(m.DriverLost(driver="pepper", detail="no answer", t=pepper.NOW))
        assert line(pilot, "Motors on") == "Motors on ~ on"
        drawn = pilot.drawn()
        assert "lost" in drawn
        assert "no answer" in drawn
        assert "wanted" not in drawn
        assert "They fight." not in drawn
        await pilot.tell(m.DriverConnected(driver="pepper", detail="NAOqi 2.5", t=pepper.NOW))
        assert line(pilot, "Motors on") == "Motors on on"


async def test_why_a_robot_is_not_there_is_told_whole() -> None:
    why = "127.0.0.1:9562 is there, but nothing listens on port 9562: NAOqi is still starting?"
    async with opened_robot_screen() as pilot:
        await pilot.tell(
            m.DriverLost(driver="pepper", detail=why, remedy="wait a minute", t=pepper.NOW)
        )
        place = pilot.console.screen.query_one("#drawing").region
        rows = [row[place.x : place.right].strip() for row in pilot.drawn().splitlines()]
        assert why in " ".join(rows)
        assert "wait a minute" in " ".join(rows)


async def test_tab_shows_the_next_robot_and_each_gets_its_own() -> None:
    first = pepper.welcome(
        pepper.settings_shown(driver="left", volume=0.1),
        pepper.settings_shown(driver="right", volume=0.9),
        drivers=("left", "right"),
    )
    async with opened_robot_screen(first=first) as pilot:
        assert "left 1 of 2" in pilot.drawn()
        await pilot.press("tab")
        assert "right 2 of 2" in pilot.drawn()
        await choose(pilot, "Volume")
        assert line(pilot, "Volume") == "Volume 0.90"
        await pilot.press("left")
        assert verbs(pilot) == [("volume", {"level": 0.85}, "right")]
        await pilot.press("shift+tab")
        assert "left 1 of 2" in pilot.drawn()


async def test_the_stop_closes_it_and_its_field() -> None:
    async with opened_robot_screen() as pilot:
        await choose(pilot, "Volume")
        await pilot.press("enter", "escape")
        await pilot.until(lambda: pilot.console.dialog is None)
        assert pilot.feed.last(r.AskStop) is not None


async def test_a_session_without_such_a_robot_says_so() -> None:
    async with piloted_console() as pilot:
        await pilot.press("@", "down", "right", "enter", "tab")
        drawn = pilot.drawn()
        assert "head, voice, face, range, microphone: no settings to change here" in drawn
        assert "^D says how each driver is" in drawn


async def test_the_swatch_has_the_colour_and_its_text() -> None:
    async with opened_robot_screen(size=(160, 50)) as pilot:
        cells = pilot.console.screen.query_one("#drawing")
        strips = [cells.render_line(y) for y in range(cells.size.height)]
        grounds = {
            segment.style.bgcolor.get_truecolor().hex
            for strip in strips
            for segment in strip
            if segment.style is not None and segment.style.bgcolor is not None
        }
        assert "#00ff80" in grounds
        assert line(pilot, "Colour") == "Colour #00ff80"


async def test_without_colours_there_is_no_swatch(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    async with opened_robot_screen(size=(160, 50)) as pilot:
        row = next(row for row in pilot.drawn().splitlines() if "#00ff80" in row)
        assert "Colour                     #00ff80" in row
        assert line(pilot, "Colour") == "Colour #00ff80"


async def test_a_difference_is_seen_on_the_main_screen() -> None:
    async with piloted_console(pepper.welcome(pepper.settings_shown())) as pilot:
        assert "differ" not in pilot.text("StatusLines")
        await pilot.tell(pepper.settings_shown({"volume": 0.1, "state": "disabled"}))
        assert "pepper: ▲ volume, autonomous life not as wanted" in pilot.text("StatusLines")
        await pilot.tell(pepper.settings_shown({"volume": 0.1}, ("They fight.",)))
        assert "pepper: ▲ volume not as wanted, 1 conflict" in pilot.text("StatusLines")
        many: dict[str, m.Json] = {
            "volume": 0.1,
            "state": "disabled",
            "engagement": "",
            "awake": False,
        }
        await pilot.tell(pepper.settings_shown(many, ("They fight.", "So do these.")))
        assert "pepper: ▲ 4 settings differ, 2 conflicts" in pilot.text("StatusLines")
        off = "the motors are off: nothing moves until the robot is woken up"
        await pilot.tell(pepper.settings_shown({"volume": 0.1}, (off,)))
        assert "pepper: ▲ volume not as wanted, the motors are off " in pilot.text("StatusLines")
        await pilot.tell(pepper.settings_shown(None, (off, "They fight.", "So do these.")))
        assert "pepper: ▲ the motors are off, 2 more " in pilot.text("StatusLines")
        await pilot.tell(pepper.settings_shown({"of another robot": 1}))
        assert "pepper: ▲ 1 setting differs " in pilot.text("StatusLines")
        await pilot.tell(m.DriverLost(driver="pepper", detail="no answer", t=pepper.NOW))
        assert "wanted" not in pilot.text("StatusLines")
        assert "differs" not in pilot.text("StatusLines")


async def test_in_a_replay_it_is_only_looked_at() -> None:
    telling = r.Replaying(t=pepper.NOW, length_us=2 * pepper.NOW, rate=1.0, paused=True)
    first = pepper.welcome(pepper.settings_shown({"volume": 0.5}))
    async with piloted_console(first, telling, size=(160, 50)) as pilot:
        await pilot.press("@")
        await choose(pilot, "Volume")
        own = pilot.console.keyboard.kept
        assert own == {"tab", "shift+tab", "up", "down"}, "the others move through the log"
        await pilot.press("right", "enter", "space")
        assert verbs(pilot) == [("nudge", {"yaw": -5.0}, "")], "as without the screen"
        assert line(pilot, "Volume") == "Volume 0.70 ▲ wanted 0.50"
        assert "Connection" not in pilot.drawn()


def test_a_replay_has_its_key() -> None:
    assert {item.name: item.keys[0].chord for item in COMMANDS}["robot"] == "@"


async def test_a_painting_may_come_at_any_moment_of_its_opening() -> None:
    async with piloted_console(pepper.welcome(pepper.settings_shown())) as pilot:
        pilot.console.do("robot")
        for _ in range(100):
            pilot.console.paint()
            pilot.console.post_message(Key("pagedown", None))
            await asyncio.sleep(0)
        await pilot.settle()
        assert pilot.console.is_running
        assert "Motors on" in pilot.drawn() or "Another address" in pilot.drawn()


@pytest.mark.parametrize(("size", "rows"), [((80, 24), 3), ((100, 36), 4)])
async def test_there_is_room_for_conflicts(size: tuple[int, int], rows: int) -> None:
    told = ("One.", "Two.", "Three.", "Four.", "Five.")
    async with opened_robot_screen(pepper.settings_shown(None, told[:rows]), size=size) as pilot:
        assert all(sentence in pilot.drawn() for sentence in told[:rows])
        before = at(pilot, "Autonomous life")
        await pilot.tell(pepper.settings_shown(None, told))
        assert f"and {len(told) - rows + 1} more" in pilot.drawn()
        assert at(pilot, "Autonomous life") == before


async def test_it_opens_where_there_is_something_to_do() -> None:
    async with opened_robot_screen() as pilot:
        assert chosen(pilot) == "Address"
        await choose(pilot, "Speed")
        assert await reopened(pilot) == "Speed", "the line of before"
        await pilot.tell(pepper.settings_shown({"volume": 0.1, "state": "disabled"}))
        assert await reopened(pilot) == "Autonomous life", "the first that differs"
        await pilot.tell(m.DriverLost(driver="pepper", detail="no answer", t=pepper.NOW))
        assert await reopened(pilot) == "192.168.1.20", "where a robot is taken"
        await pilot.tell(m.DriverConnected(driver="pepper", detail="NAOqi", t=pepper.NOW))
        await pilot.tell(pepper.settings_shown())
        assert await reopened(pilot) == "Autonomous life", "the line of before"
        await choose(pilot, "Disconnect")
        assert await reopened(pilot) == "Autonomous life", "where enter lets go of no robot"


async def reopened(pilot: ConsolePilot) -> str:
    """Close and open the screen; returns what is chosen then."""
    await pilot.press("@", "@")
    return chosen(pilot)


def chosen(pilot: ConsolePilot) -> str:
    """The label of the chosen line."""
    top = pilot.console.dialog
    assert isinstance(top, RobotDialog)
    label = top._lines()[top._line].setting.label
    assert f"▸ {label} " in pilot.drawn()
    return label
