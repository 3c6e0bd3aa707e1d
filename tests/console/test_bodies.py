"""Bodies on the console's main screen and in their dialog."""

from __future__ import annotations

import os
import subprocess
import sys

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.console import bodies, scenes
from tests.console.piloting import ConsolePilot, piloted_console
from woz_tui.console.bodies.pane import pane_rows
from woz_tui.console.drawing.cells import Row, length
from woz_tui.console.drawing.glyphs import ASCII, UNICODE, Glyphs, PaintFrame
from woz_tui.console.drawing.theme import Appearance
from woz_tui.console.link.message_feed import Loss
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import WelcomeSettings

NOW = bodies.NOW
ROOMY, NARROW = (160, 50), (80, 24)
#: The eyes in half blocks and in braille.
LARGE, COMPACT = "▄█████▄", "⢀⣶⣷⣆"


def console_state(*messages: m.Message, robots: tuple[str, ...] = ("",)) -> ConsoleState:
    state = ConsoleState()
    state.apply([bodies.welcome(robots=robots), *messages], 0)
    return state


def text(rows: list[Row]) -> str:
    return "\n".join("".join(piece for piece, _ in row) for row in rows)


def pane(*messages: m.Message, size: tuple[int, int] = (50, 20), now: int = NOW) -> str:
    return text(pane_rows(console_state(*messages), PaintFrame(*size, now)))


def places(pilot: ConsolePilot) -> list[object]:
    parts = ("ActionPanels", "Meters", "BodyPane", "EventList", "OrderPane")
    return [pilot.console.query_one(name).region for name in parts]


@pytest.mark.toolkit("V1", "F1")
@pytest.mark.parametrize(
    ("size", "eyes"), [(ROOMY, LARGE), (NARROW, COMPACT), ((120, 30), COMPACT)]
)
async def test_the_face_is_on_the_main_screen(size: tuple[int, int], eyes: str) -> None:
    async with piloted_console(bodies.welcome(bodies.alive()), size=size) as pilot:
        shown = pilot.text("BodyPane")
        assert eyes in shown
        assert "happy 80 %" in shown
        assert eyes in pilot.drawn()


@pytest.mark.toolkit("V1")
@pytest.mark.parametrize("size", [ROOMY, NARROW, (80, 36), (120, 30)])
async def test_nothing_moves_about_while_the_robot_moves(size: tuple[int, int]) -> None:
    async with piloted_console(
        bodies.welcome([*scenes.sensors(), *bodies.alive()]), size=size
    ) as pilot:
        before = places(pilot)
        await pilot.tell(*bodies.joints({"pitch": 9.0, "middle": 80.0, "top": 3.0}, {}))
        await pilot.tell(*bodies.alive(mode="demo", move="dance", emotion="neutral"))
        await pilot.tell(m.DriverLost(driver="body", t=NOW), m.StopPressed(source="key", t=NOW))
        assert places(pilot) == before


async def test_a_session_without_a_body_has_no_room_for_one() -> None:
    async with piloted_console(size=NARROW) as pilot:
        assert not pilot.console.query_one("BodyPane").display
        meters = pilot.console.query_one("Meters").region
        assert meters.width == 39


@pytest.mark.toolkit("U1", "V1")
@pytest.mark.parametrize("size", [ROOMY, (96, 24)])
async def test_two_robots_stand_side_by_side(size: tuple[int, int]) -> None:
    robots = ("left.", "right.")
    state = [*bodies.alive("left.", emotion="angry"), *bodies.alive("right.", emotion="sad")]
    async with piloted_console(bodies.welcome(state, robots), size=size) as pilot:
        shown = pilot.text("BodyPane")
        title = shown.splitlines()[0]
        assert title.index("left") < title.index("right")
        assert shown.count(LARGE if size == ROOMY else COMPACT) == (4 if size == ROOMY else 2)
        assert "angry 80 %" in shown
        assert "sad 80 %" in shown


@pytest.mark.parametrize("width", [80, 84, 90, 96, 110, 119])
@pytest.mark.parametrize("robots", [("left.", "right."), ("",)], ids=["two", "one"])
async def test_bodies_give_way_to_meters_and_events(width: int, robots: tuple[str, ...]) -> None:
    state = [message for robot in robots for message in bodies.alive(robot)]
    async with piloted_console(bodies.welcome(state, robots), size=(width, 24)) as pilot:
        for part in ("Meters", "EventList"):
            assert pilot.console.query_one(part).region.width >= 32, part
        title = pilot.text("BodyPane").splitlines()[0]
        assert ("+1" in title) is (len(robots) == 2 and width < 96)


@pytest.mark.toolkit("V1")
async def test_the_views_follow_the_setpoints() -> None:
    async with piloted_console(bodies.welcome(bodies.alive()), size=ROOMY) as pilot:
        before = pilot.text("BodyPane")
        await pilot.tell(*bodies.joints({"pitch": -80.0, "middle": 5.0, "top": 5.0}, {}))
        assert pilot.text("BodyPane") != before


@pytest.mark.toolkit("V1")
def test_what_it_does_is_said_beside_the_face() -> None:
    shown = pane(*bodies.alive(mode="saccade", move="nod", personality="grumpy", blink_rate=20.0))
    for words in (
        "face",
        "move",
        "personality",
        "happy 80 %",
        "saccade",
        "nod",
        "grumpy",
        "0.53 Hz",
        "20/min",
        "2.13 Hz",
    ):
        assert words in shown
    assert "like grumpy" in pane(*bodies.alive(personality="grumpy", changed=True))
    demo = pane(*bodies.alive(mode="demo", move="demo"))  # breathes and blinks as scripted
    assert "breathes    no" in demo
    assert "blinks      no" in demo
    still = pane(*bodies.alive(breathing_on=False, blinking=False))
    assert "breathes    no" in still
    assert "blinks      no" in still


@pytest.mark.toolkit("G1")
def test_a_lost_body_is_grey_and_says_since_when() -> None:
    lost = m.DriverLost(driver="body", detail="gone", t=NOW)
    rows = pane_rows(console_state(*bodies.alive(), lost), PaintFrame(50, 20, NOW + 7_000_000))
    assert "~7 s old" in text(rows)
    looks = {look for row in rows for _, look in row}
    assert "stale" in looks
    assert not looks & {"strong", "run", "face-4"}
    assert LARGE in text(rows)


def test_joints_that_nobody_speaks_of_any_more_are_old() -> None:
    shown = pane(*bodies.alive(), now=NOW + 5_000_000)
    assert "~5 s old" in shown
    fresh = pane(*bodies.alive(), now=NOW + 500_000)
    assert "old" not in fresh


def test_a_lost_session_makes_everything_old() -> None:
    state = console_state(*bodies.alive())
    state.lose(Loss("closed"))
    assert "old" in text(pane_rows(state, PaintFrame(50, 20, NOW)))


def test_before_the_first_face_its_place_is_kept() -> None:
    empty, full = pane().splitlines(), pane(*bodies.alive()).splitlines()
    assert "no face yet" in "\n".join(empty)
    assert len(empty) == len(full)
    assert [line.index("mode") for line in empty if "mode" in line] == [
        line.index("mode") for line in full if "mode" in line
    ]


def test_a_body_without_a_face_shows_its_links() -> None:
    told = {**bodies.EYEPI, "face": None}
    welcome = msgspec.structs.replace(
        bodies.welcome(), settings=WelcomeSettings(outlines={"body": told})
    )
    state = ConsoleState()
    state.apply([welcome, *bodies.joints({"pitch": 0.0}, {})], 0)
    shown = text(pane_rows(state, PaintFrame(50, 20, NOW)))
    assert "side, front" in shown
    assert any("⠀" <= sign <= "⣿" for sign in shown)


@pytest.mark.toolkit("F5", "F3")
def test_brightness_is_seen_in_the_lights_colour() -> None:
    def look(brightness: float) -> set[str]:
        state = console_state(bodies.face(brightness=brightness))
        rows = pane_rows(state, PaintFrame(50, 20, NOW))
        return {look for row in rows for piece, look in row if "█" in piece}

    assert look(1.0) == {"face-4"}
    assert look(0.2) == {"face-1"}


@given(
    st.integers(13, 120),
    st.integers(2, 50),
    st.sampled_from([UNICODE, ASCII]),
    st.sampled_from([("",), ("left.", "right."), ("a.", "b.", "c.", "d.")]),
)
def test_the_pane_keeps_to_its_frame(
    width: int, height: int, glyphs: Glyphs, robots: tuple[str, ...]
) -> None:
    told = [message for robot in robots for message in bodies.alive(robot)]
    rows = pane_rows(console_state(*told, robots=robots), PaintFrame(width, height, NOW, glyphs))
    assert len(rows) == height
    assert all(length(row) == width for row in rows)
    assert glyphs is UNICODE or text(rows).isascii()


# -- the dialog -----------------------------------------------------------------------------------


@pytest.mark.toolkit("V1", "P5")
@pytest.mark.parametrize("size", [NARROW, ROOMY])
async def test_the_body_in_full_size_with_all_its_values(size: tuple[int, int]) -> None:
    async with piloted_console(bodies.welcome(bodies.alive()), size=size) as pilot:
        await pilot.press("semicolon")
        await pilot.until(lambda: "side, front" in pilot.drawn(), "the views")
        shown = pilot.drawn()
        assert LARGE in shown
        for words in ("personality", "upbeat", "valence", "+0.60", "compression", "25 %"):
            assert words in shown
        await pilot.tell(bodies.body_changed(breathing_on=True, breathing_rate=None, tempo=3.2))
        await pilot.until(lambda: "0.80 Hz" in pilot.drawn(), "a breath lasts four beats")
        assert "breathing on" not in pilot.drawn()
        await pilot.tell(bodies.body_changed(compression=0.5, odd_trait=3))
        await pilot.until(lambda: "50 %" in pilot.drawn(), "the new value")
        assert "odd trait" in pilot.drawn()


async def test_tab_turns_to_the_other_body_and_escape_stops() -> None:
    robots = ("left.", "right.")
    state = [message for robot in robots for message in bodies.alive(robot)]
    async with piloted_console(bodies.welcome(state, robots)) as pilot:
        await pilot.press("semicolon")
        await pilot.until(lambda: "left.body" in pilot.drawn(), "the first")
        await pilot.press("tab")
        await pilot.until(lambda: "right.body" in pilot.drawn(), "the second")
        await pilot.press("shift+tab")
        await pilot.until(lambda: "left.body" in pilot.drawn(), "the first again")
        await pilot.press("escape")
        assert pilot.console.dialog is None


async def test_without_a_body_the_dialog_says_so() -> None:
    async with piloted_console() as pilot:
        await pilot.press("semicolon")
        await pilot.until(lambda: "No robot of this session" in pilot.drawn(), "the sentence")


# -- other terminals ------------------------------------------------------------------------------


async def test_without_colours_and_in_ascii_the_face_is_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    look = Appearance(ASCII, "woz-16")
    async with piloted_console(bodies.welcome(bodies.alive()), size=ROOMY, look=look) as pilot:
        shown = pilot.text("BodyPane")
        assert shown.isascii()
        assert ".#####." in shown
        assert "O" in shown


def test_the_console_draws_bodies_without_numpy() -> None:
    code = (
        "import sys; import woz_tui.console.app, woz_tui.motion.kinematics; "
        "sys.exit('numpy' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], env={**os.environ}, check=False, timeout=60)
    assert done.returncode == 0
