"""The camera's screen, without a terminal: what is drawn, said, asked for, and when."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

import numpy as np
import pytest

from tests.console import scenes
from tests.console.camera.camera_pictures import Film, Pixels, noisy, picture_shown, room_picture
from tests.console.piloting import ConsolePilot, piloted_console
from woz_tui.console.camera.picture_requests import STALE_S
from woz_tui.console.camera.picture_widgets import HalfBlockView
from woz_tui.console.drawing.cells import Cells
from woz_tui.console.drawing.glyphs import ASCII
from woz_tui.console.drawing.theme import Appearance
from woz_tui.console.screens.camera import CameraDialog
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.camera_pictures import PictureShown
from woz_tui.protocol.requests import AskPicture, AskStop, AskVerb

SECOND = 1_000_000


@pytest.fixture(autouse=True)
def _millions_of_colours(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLORTERM", "truecolor")
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)


class Robot:
    """Answers for two cameras; `age_us` old pictures, as long as `film` gives any."""

    def __init__(self, pilot: ConsolePilot, film: Film) -> None:
        self.seat, self.film = pilot, film
        self.given = 0
        self.why = ""
        pilot.feed.answers[AskPicture] = self._answer  # type: ignore[assignment]

    def _answer(self, request: r.Request, ref: int) -> PictureShown:
        assert isinstance(request, AskPicture)
        told = {"driver": request.driver or "head", "cameras": ["head", "eye"]}
        if self.why:
            return PictureShown(ref=ref, why=self.why, **told)  # type: ignore[arg-type]
        self.given += 1
        t = scenes.NOW + self.seat.clock.now_us() - 200_000
        return picture_shown(self.film(self.given), request, ref, number=self.given, t=t, **told)

    @property
    def asked(self) -> list[AskPicture]:
        return [one for one in self.seat.feed.asked if isinstance(one, AskPicture)]


@asynccontextmanager
async def watching(
    film: Film = lambda number: room_picture(),
    *first: r.Welcome,
    size: tuple[int, int] = (80, 24),
    look: Appearance | None = None,
    pictures: str = "auto",
) -> AsyncIterator[tuple[ConsolePilot, Robot]]:
    """A console whose camera screen has just been opened."""
    async with piloted_console(*first, size=size, look=look, pictures=pictures) as pilot:
        robot = Robot(pilot, film)
        await open_camera_screen(pilot)
        yield pilot, robot


async def open_camera_screen(pilot: ConsolePilot) -> None:
    """Open the screen."""
    pilot.console.do("camera")
    await pilot.until(lambda: bool(dialog(pilot).query("#camera-words")), "the camera's screen")
    await pilot.settle()


def dialog(pilot: ConsolePilot) -> CameraDialog:
    found = pilot.console.dialog
    assert isinstance(found, CameraDialog)
    return found


def words(pilot: ConsolePilot) -> str:
    return dialog(pilot).query_one("#camera-words", Cells).text


def blocks(pilot: ConsolePilot) -> HalfBlockView:
    return dialog(pilot).query_one(HalfBlockView)


async def go_on(pilot: ConsolePilot, until: Callable[[], bool], what: str) -> None:
    """Let time pass until something has come true."""

    def later() -> bool:
        pilot.clock.advance(0.05)
        return until()

    await pilot.until(later, what)
    await pilot.settle()


async def pictures_drawn(pilot: ConsolePilot, robot: Robot, pictures: int) -> None:
    """So many pictures have been drawn, and painted."""
    await go_on(pilot, lambda: len(robot.asked) > pictures, f"picture {pictures}")


def drawn_pixels(pilot: ConsolePilot) -> Pixels:
    """The picture as the screen's cells show it: the colours of every half block."""
    region = blocks(pilot).content_region
    rows: list[list[tuple[int, ...]]] = []
    for y, strip in enumerate(pilot.console.screen._compositor.render_strips()):
        if not region.y <= y < region.bottom:
            continue
        upper, lower = [], []
        for segment in strip.crop(region.x, region.right):
            assert segment.style is not None
            color, ground = segment.style.color, segment.style.bgcolor
            assert ground is not None
            for sign in segment.text:
                lower.append(tuple(ground.get_truecolor()))
                upper.append(tuple(color.get_truecolor()) if sign == "▀" and color else lower[-1])
        rows += [upper, lower]
    return np.array(rows, np.uint8)


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_the_cells_show_what_the_camera_sees(size: tuple[int, int]) -> None:
    async with watching(size=size) as (pilot, robot):
        await pictures_drawn(pilot, robot, 2)
        cells = drawn_pixels(pilot)
        rows, columns = cells.shape[:2]
        assert rows >= 0.75 * 2 * size[1], "as large as fits"
        assert columns / rows == pytest.approx(4 / 3, abs=0.05)
        y, x = np.arange(rows) * 120 // rows, np.arange(columns) * 160 // columns
        differ = np.abs(cells.astype(int) - room_picture()[y][:, x])
        assert differ.mean() < 6
        assert np.percentile(differ, 90) < 16


async def test_it_says_how_old_the_picture_is_and_how_many_come() -> None:
    async with watching() as (pilot, robot):
        await pictures_drawn(pilot, robot, 5)
        assert words(pilot).startswith("head 1/2 · 0.")
        assert "s old · " in words(pilot)
        assert "half blocks" in words(pilot)
        # `test_picture_requests` shows which one it is: here drawing takes as long as it takes.
        assert float(words(pilot).split(" · ")[2].removesuffix("/s")) > 0.0


async def test_five_a_second_at_most_and_one_at_a_time() -> None:
    async with watching() as (pilot, robot):
        await pictures_drawn(pilot, robot, 3)
        before, began = len(robot.asked), pilot.clock.now_us()
        await pictures_drawn(pilot, robot, before + 5)
        assert pilot.clock.now_us() - began >= 5 * 0.2 * SECOND - 50_000
        assert [one.after for one in robot.asked] == list(range(len(robot.asked)))


async def test_a_camera_that_falls_silent_is_stale_and_says_why() -> None:
    async with watching() as (pilot, robot):
        await pictures_drawn(pilot, robot, 2)
        robot.why = "head sent no new picture within 1 s"
        await go_on(pilot, lambda: "stale" in words(pilot), "that it is stale")
        assert float(words(pilot).split()[2]) >= STALE_S
        assert "head sent no new picture" in words(pilot)
        await pilot.tell(
            m.DriverLost(
                driver="head",
                detail="rpicam-vid ended",
                t=pilot.console.state.now(pilot.clock.now_us()),
            )
        )
        assert "head is lost: rpicam-vid ended" in words(pilot)
        robot.why = ""
        await go_on(pilot, lambda: "stale" not in words(pilot), "a new picture")


async def test_a_refusal_is_shown_and_asked_again_later() -> None:
    async with piloted_console() as pilot:
        reason = "no driver of this session has a camera"
        pilot.feed.answers[AskPicture] = lambda asked, ref: r.Reply(
            ref=ref, ok=False, reason=reason
        )
        await open_camera_screen(pilot)
        await go_on(pilot, lambda: reason in words(pilot), "the reason")
        before = pilot.clock.now_us()
        count = sum(isinstance(one, AskPicture) for one in pilot.feed.asked)
        await go_on(
            pilot,
            lambda: sum(isinstance(one, AskPicture) for one in pilot.feed.asked) > count,
            "another question",
        )
        assert pilot.clock.now_us() - before >= 0.8 * SECOND


async def test_tab_shows_the_next_camera() -> None:
    async with watching() as (pilot, robot):
        await pictures_drawn(pilot, robot, 2)
        await pilot.press("tab")
        await go_on(pilot, lambda: words(pilot).startswith("eye 2/2"), "the other camera")
        assert robot.asked[-1].driver == "eye"
        assert next(one for one in robot.asked if one.driver == "eye").after == 0
        await pilot.press("tab")
        await go_on(pilot, lambda: words(pilot).startswith("head 1/2"), "the first one")


async def test_minus_makes_it_smaller_and_plus_larger() -> None:
    async with watching(size=(120, 40)) as (pilot, robot):
        await pictures_drawn(pilot, robot, 1)
        sizes = [blocks(pilot).canvas.size]
        for key in ("minus", "minus", "minus", "minus", "plus"):
            await pilot.press(key)
            sizes.append(blocks(pilot).canvas.size)
        assert sizes == [*sorted(sizes[:4], reverse=True), sizes[3], sizes[2]]
        await pictures_drawn(pilot, robot, len(robot.asked) + 4)
        assert (robot.asked[-1].width, robot.asked[-1].height) == sizes[-1]
        assert drawn_pixels(pilot).shape[:2] == sizes[-1][::-1]


async def test_keys_go_on_playing_the_robot() -> None:
    async with watching() as (pilot, robot):
        await pictures_drawn(pilot, robot, 1)
        await pilot.press("h")
        assert pilot.feed.last(r.AskAction) is not None
        await pilot.press("escape")
        assert pilot.feed.last(AskStop) is not None
        assert pilot.console.dialog is None


async def test_enter_has_the_driver_make_a_file_where_it_can() -> None:
    verbs = {"head": ["gaze", "picture"], "eye": ["gaze"]}
    welcome = scenes.welcome()
    first = r.Welcome(
        **{**{f: getattr(welcome, f) for f in welcome.__struct_fields__}, "verbs": verbs}
    )
    async with watching(lambda number: room_picture(), first) as (pilot, robot):
        await pictures_drawn(pilot, robot, 1)
        await pilot.press("enter")
        asked = pilot.feed.last(AskVerb)
        assert isinstance(asked, AskVerb)
        assert (asked.verb, asked.on, asked.key) == ("picture", "head", "enter")
        await pilot.press("tab")
        await go_on(pilot, lambda: words(pilot).startswith("eye"), "the other camera")
        await pilot.press("enter")
        assert pilot.feed.last(AskVerb) is asked
        assert "cannot save pictures" in pilot.text("StopBar")


async def test_under_another_dialog_nobody_asks() -> None:
    async with watching() as (pilot, robot):
        await pictures_drawn(pilot, robot, 2)
        await pilot.press("/")
        count = len(robot.asked)
        for _ in range(5):
            pilot.clock.advance(0.5)
            await pilot.pilot.pause(0.02)
        assert len(robot.asked) == count
        await pilot.press("ctrl+q")
        await pictures_drawn(pilot, robot, count + 2)
        await pilot.press("ctrl+q")
        count = len(robot.asked)
        for _ in range(5):
            pilot.clock.advance(0.5)
            await pilot.pilot.pause(0.02)
        assert len(robot.asked) == count, "the screen is closed"


async def test_a_damaged_picture_is_told() -> None:
    async with piloted_console() as pilot:
        pilot.feed.answers[AskPicture] = lambda asked, ref: PictureShown(  # type: ignore[assignment,return-value]
            ref=ref, driver="head", cameras=["head"], number=1, width=9, height=9, data="AAAA"
        )
        await open_camera_screen(pilot)
        await go_on(pilot, lambda: "cannot be read" in words(pilot), "that it is damaged")


async def test_signs_of_ascii_where_there_are_no_others() -> None:
    async with watching(look=Appearance(ASCII, "woz-16")) as (pilot, robot):
        await pictures_drawn(pilot, robot, 4)
        text = pilot.drawn()
        assert text.isascii()
        assert "signs" in words(pilot)
        shades = {sign for line in text.splitlines()[3:18] for sign in line[25:55]}
        assert len(shades & set(" .:-=+*#%@")) >= 5


@pytest.mark.parametrize(
    ("pictures", "role", "says"),
    [("off", "wizard", "--pictures off"), ("auto", "replay", "A replay has no pictures")],
)
async def test_where_there_are_none_it_says_so(pictures: str, role: str, says: str) -> None:
    first = scenes.welcome(role=role)
    async with watching(lambda n: room_picture(), first, pictures=pictures) as (pilot, robot):
        for _ in range(5):
            await pilot.pass_time(1.0)
        assert says in words(pilot)
        assert robot.asked == []


async def test_a_lost_robot_process_and_back() -> None:
    async with watching(lambda number: noisy(room_picture(), number)) as (pilot, robot):
        await pictures_drawn(pilot, robot, 3)
        pilot.feed.cut("gone")
        await pilot.until(lambda: not isinstance(pilot.console.dialog, CameraDialog), "the news")
        await pilot.tell(scenes.welcome())
        await pilot.until(lambda: isinstance(pilot.console.dialog, CameraDialog), "the camera")
        await pictures_drawn(pilot, robot, len(robot.asked) + 3)
