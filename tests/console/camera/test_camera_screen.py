"""The camera's screen, without a terminal: what is drawn, said, asked for, and when."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

import numpy as np
import pytest

from tests.console import scenes
from tests.console.camera.filmed import Film, Pixels, noisy, room, shown
from tests.console.driving import Sitting, sitting
from woz_tui.console.camera.picture_requests import STALE_S
from woz_tui.console.camera.picture_widgets import HalfBlockView
from woz_tui.console.cells import Cells
from woz_tui.console.glyphs import ASCII
from woz_tui.console.screens.camera import CameraDialog
from woz_tui.console.theme import Appearance
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

    def __init__(self, seat: Sitting, film: Film) -> None:
        self.seat, self.film = seat, film
        self.given = 0
        self.why = ""
        seat.feed.answers[AskPicture] = self._answer  # type: ignore[assignment]

    def _answer(self, request: r.AnyRequest, ref: int) -> PictureShown:
        assert isinstance(request, AskPicture)
        told = {"driver": request.driver or "head", "cameras": ["head", "eye"]}
        if self.why:
            return PictureShown(ref=ref, why=self.why, **told)  # type: ignore[arg-type]
        self.given += 1
        t = scenes.NOW + self.seat.clock.now_us() - 200_000
        return shown(self.film(self.given), request, ref, number=self.given, t=t, **told)

    @property
    def asked(self) -> list[AskPicture]:
        return [one for one in self.seat.feed.asked if isinstance(one, AskPicture)]


@asynccontextmanager
async def watching(
    film: Film = lambda number: room(),
    *first: r.Welcome,
    size: tuple[int, int] = (80, 24),
    look: Appearance | None = None,
    pictures: str = "auto",
) -> AsyncIterator[tuple[Sitting, Robot]]:
    """A console whose camera screen has just been opened."""
    async with sitting(*first, size=size, look=look, pictures=pictures) as seat:
        robot = Robot(seat, film)
        await opened(seat)
        yield seat, robot


async def opened(seat: Sitting) -> None:
    """Open the screen."""
    seat.console.do("camera")
    await seat.until(lambda: bool(dialog(seat).query("#camera-words")), "the camera's screen")
    await seat.settle()


def dialog(seat: Sitting) -> CameraDialog:
    found = seat.console.dialog
    assert isinstance(found, CameraDialog)
    return found


def words(seat: Sitting) -> str:
    return dialog(seat).query_one("#camera-words", Cells).text


def blocks(seat: Sitting) -> HalfBlockView:
    return dialog(seat).query_one(HalfBlockView)


async def go_on(seat: Sitting, until: Callable[[], bool], what: str) -> None:
    """Let time pass until something has come true."""

    def later() -> bool:
        seat.clock.advance(0.05)
        return until()

    await seat.until(later, what)
    await seat.settle()


async def seen(seat: Sitting, robot: Robot, pictures: int) -> None:
    """So many pictures have been drawn, and painted."""
    await go_on(seat, lambda: len(robot.asked) > pictures, f"picture {pictures}")


def drawn(seat: Sitting) -> Pixels:
    """The picture as the screen's cells show it: the colours of every half block."""
    region = blocks(seat).content_region
    rows: list[list[tuple[int, ...]]] = []
    for y, strip in enumerate(seat.console.screen._compositor.render_strips()):
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
    async with watching(size=size) as (seat, robot):
        await seen(seat, robot, 2)
        cells = drawn(seat)
        rows, columns = cells.shape[:2]
        assert rows >= 0.75 * 2 * size[1], "as large as fits"
        assert columns / rows == pytest.approx(4 / 3, abs=0.05)
        y, x = np.arange(rows) * 120 // rows, np.arange(columns) * 160 // columns
        differ = np.abs(cells.astype(int) - room()[y][:, x])
        assert differ.mean() < 6
        assert np.percentile(differ, 90) < 16


async def test_it_says_how_old_the_picture_is_and_how_many_come() -> None:
    async with watching() as (seat, robot):
        await seen(seat, robot, 5)
        assert words(seat).startswith("head 1/2 · 0.")
        assert "s old · " in words(seat)
        assert "half blocks" in words(seat)
        # Which one it is, is shown in `test_watching`: here drawing takes as long as it takes.
        assert float(words(seat).split(" · ")[2].removesuffix("/s")) > 0.0


async def test_five_a_second_at_most_and_one_at_a_time() -> None:
    async with watching() as (seat, robot):
        await seen(seat, robot, 3)
        before, began = len(robot.asked), seat.clock.now_us()
        await seen(seat, robot, before + 5)
        assert seat.clock.now_us() - began >= 5 * 0.2 * SECOND - 50_000
        assert [one.after for one in robot.asked] == list(range(len(robot.asked)))


async def test_a_camera_that_falls_silent_is_stale_and_says_why() -> None:
    async with watching() as (seat, robot):
        await seen(seat, robot, 2)
        robot.why = "head sent no new picture within 1 s"
        await go_on(seat, lambda: "stale" in words(seat), "that it is stale")
        assert float(words(seat).split()[2]) >= STALE_S
        assert "head sent no new picture" in words(seat)
        await seat.tell(
            m.DriverLost(
                driver="head",
                detail="rpicam-vid ended",
                t=seat.console.state.now(seat.clock.now_us()),
            )
        )
        assert "head is lost: rpicam-vid ended" in words(seat)
        robot.why = ""
        await go_on(seat, lambda: "stale" not in words(seat), "a new picture")


async def test_a_refusal_is_shown_and_asked_again_later() -> None:
    async with sitting() as seat:
        reason = "no driver of this session has a camera"
        seat.feed.answers[AskPicture] = lambda asked, ref: r.Reply(ref=ref, ok=False, reason=reason)
        await opened(seat)
        await go_on(seat, lambda: reason in words(seat), "the reason")
        before = seat.clock.now_us()
        count = sum(isinstance(one, AskPicture) for one in seat.feed.asked)
        await go_on(
            seat,
            lambda: sum(isinstance(one, AskPicture) for one in seat.feed.asked) > count,
            "another question",
        )
        assert seat.clock.now_us() - before >= 0.8 * SECOND


async def test_tab_shows_the_next_camera() -> None:
    async with watching() as (seat, robot):
        await seen(seat, robot, 2)
        await seat.press("tab")
        await go_on(seat, lambda: words(seat).startswith("eye 2/2"), "the other camera")
        assert robot.asked[-1].driver == "eye"
        assert next(one for one in robot.asked if one.driver == "eye").after == 0
        await seat.press("tab")
        await go_on(seat, lambda: words(seat).startswith("head 1/2"), "the first one")


async def test_minus_makes_it_smaller_and_plus_larger() -> None:
    async with watching(size=(120, 40)) as (seat, robot):
        await seen(seat, robot, 1)
        sizes = [blocks(seat).canvas.size]
        for key in ("minus", "minus", "minus", "minus", "plus"):
            await seat.press(key)
            sizes.append(blocks(seat).canvas.size)
        assert sizes == [*sorted(sizes[:4], reverse=True), sizes[3], sizes[2]]
        await seen(seat, robot, len(robot.asked) + 4)
        assert (robot.asked[-1].width, robot.asked[-1].height) == sizes[-1]
        assert drawn(seat).shape[:2] == sizes[-1][::-1]


async def test_keys_go_on_playing_the_robot() -> None:
    async with watching() as (seat, robot):
        await seen(seat, robot, 1)
        await seat.press("h")
        assert seat.feed.last(r.AskAction) is not None
        await seat.press("escape")
        assert seat.feed.last(AskStop) is not None
        assert seat.console.dialog is None


async def test_enter_has_the_driver_make_a_file_where_it_can() -> None:
    verbs = {"head": ["gaze", "picture"], "eye": ["gaze"]}
    told = scenes.welcome()
    first = r.Welcome(**{**{f: getattr(told, f) for f in told.__struct_fields__}, "verbs": verbs})
    async with watching(lambda number: room(), first) as (seat, robot):
        await seen(seat, robot, 1)
        await seat.press("enter")
        asked = seat.feed.last(AskVerb)
        assert isinstance(asked, AskVerb)
        assert (asked.verb, asked.on, asked.key) == ("picture", "head", "enter")
        await seat.press("tab")
        await go_on(seat, lambda: words(seat).startswith("eye"), "the other camera")
        await seat.press("enter")
        assert seat.feed.last(AskVerb) is asked
        assert "cannot save pictures" in seat.text("StopBar")


async def test_under_another_dialog_nobody_asks() -> None:
    async with watching() as (seat, robot):
        await seen(seat, robot, 2)
        await seat.press("/")
        count = len(robot.asked)
        for _ in range(5):
            seat.clock.advance(0.5)
            await seat.pilot.pause(0.02)
        assert len(robot.asked) == count
        await seat.press("ctrl+q")
        await seen(seat, robot, count + 2)
        await seat.press("ctrl+q")
        count = len(robot.asked)
        for _ in range(5):
            seat.clock.advance(0.5)
            await seat.pilot.pause(0.02)
        assert len(robot.asked) == count, "the screen is closed"


async def test_a_damaged_picture_is_told() -> None:
    async with sitting() as seat:
        seat.feed.answers[AskPicture] = lambda asked, ref: PictureShown(  # type: ignore[assignment,return-value]
            ref=ref, driver="head", cameras=["head"], number=1, width=9, height=9, data="AAAA"
        )
        await opened(seat)
        await go_on(seat, lambda: "cannot be read" in words(seat), "that it is damaged")


async def test_signs_of_ascii_where_there_are_no_others() -> None:
    async with watching(look=Appearance(ASCII, "woz-16")) as (seat, robot):
        await seen(seat, robot, 4)
        text = seat.drawn()
        assert text.isascii()
        assert "signs" in words(seat)
        shades = {sign for line in text.splitlines()[3:18] for sign in line[25:55]}
        assert len(shades & set(" .:-=+*#%@")) >= 5


@pytest.mark.parametrize(
    ("pictures", "role", "says"),
    [("off", "wizard", "--pictures off"), ("auto", "replay", "A replay has no pictures")],
)
async def test_where_there_are_none_it_says_so(pictures: str, role: str, says: str) -> None:
    first = scenes.welcome(role=role)
    async with watching(lambda n: room(), first, pictures=pictures) as (seat, robot):
        for _ in range(5):
            await seat.pass_time(1.0)
        assert says in words(seat)
        assert robot.asked == []


async def test_a_lost_robot_process_and_back() -> None:
    async with watching(lambda number: noisy(room(), number)) as (seat, robot):
        await seen(seat, robot, 3)
        seat.feed.cut("gone")
        await seat.until(lambda: not isinstance(seat.console.dialog, CameraDialog), "the news")
        await seat.tell(scenes.welcome())
        await seat.until(lambda: isinstance(seat.console.dialog, CameraDialog), "the camera")
        await seen(seat, robot, len(robot.asked) + 3)
