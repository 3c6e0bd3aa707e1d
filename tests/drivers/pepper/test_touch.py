"""Fingers on the tablet: over the wire, and as every kind of tablet tells them."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.naoqi_robot.link import Methods, Unsubscribe
from woz_drivers.naoqi_robot.parts import Refusal
from woz_drivers.naoqi_robot.served_files import ServedFiles
from woz_drivers.naoqi_robot.settings import SensesSettings
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.pepper.tablet import SENSORS, TabletPart, Touch, TouchScale, place

from tests.drivers.pepper.part_rig import connected_part
from tests.drivers.pepper.test_senses_values import ANYTHING
from tests.drivers.published_messages import PublishedMessages
from tests.fakes.naoqi import StandIn, stand_in
from tests.fakes.virtual_time import LoopClock, run_virtual
from woz_tui.drivers.contract import DriverError
from woz_tui.protocol.messages import Notice, Reading


@pytest.mark.naoqi(
    "ALTabletService.onTouchDownRatio",
    "ALTabletService.onTouchMove",
    "ALTabletService.onTouchUp",
)
async def test_a_finger_is_told_where_it_comes_down_moves_and_leaves(
    tmp_path: Path, robot: StandIn
) -> None:
    async with connected_part(TabletPart, tmp_path, robot) as rig:
        await rig.published.state("touch.x", "ok")
        await robot.touch(0.25, 0.75)
        await rig.published.until(lambda: len(rig.published.values("touch.y")) >= 3)
        assert rig.published.values("touch.x") == [0.25] * 3
        assert rig.published.values("touch.y") == [0.75] * 3
        told = [one.text for one in rig.published.all(Reading) if one.sensor == "touch.x"]
        # libqi sends and hears each signal in its own time: within a moment they may be swapped.
        assert sorted(told) == ["down", "move", "up"]


async def test_a_lost_tablet_is_touched_again_when_it_is_back(tmp_path: Path, port: int) -> None:
    async with stand_in(port=port) as robot, connected_part(TabletPart, tmp_path, robot) as rig:
        robot.kill()
        await rig.published.state("touch.y", "stale")
        async with stand_in(port=port) as back:
            await rig.wait_connected(2)
            await rig.published.state("touch.y", "ok")
            await back.touch(0.5, 0.5)
            await rig.published.until(lambda: len(rig.published.values("touch.y")) >= 3)


async def test_touches_that_nobody_wants_are_not_listened_to(
    tmp_path: Path, robot: StandIn
) -> None:
    none = SensesSettings(touch=False)
    async with connected_part(TabletPart, tmp_path, robot, senses=none) as rig:
        await robot.touch(0.5, 0.5)
        await rig.do("tablet", what="hide")
        assert rig.published.values("touch.x") == []
    assert TabletPart.offer(PepperSettings(robots=(), senses=none)).sensors == ()
    assert TabletPart.offer(PepperSettings(robots=())).sensors == SENSORS


class TouchedRobot:
    """A robot with a tablet that tells what it is told to; `missing` signals it does not have."""

    ready = True
    local_host = "127.0.0.1"
    files: ServedFiles

    def __init__(self, *missing: str) -> None:
        self._missing = missing
        self.published: dict[str, Callable[..., None]] = {}
        self.ended = 0

    async def listen(self, service: str, signal: str, heard: Callable[..., None]) -> Unsubscribe:
        if signal in self._missing:
            raise DriverError(f"{service} has no signal {signal}")
        self.published[signal] = heard
        return self._end

    async def _end(self) -> None:
        self.ended += 1

    async def call(self, service: str, method: str, *args: Any, within: float = 2.0) -> Any:
        raise DriverError(f"{service}.{method}: not for fingers")

    async def ask(self, service: str, method: str, *args: Any) -> Any:
        raise DriverError(f"{service}.{method}: not for fingers")

    def guard(self, refused: Refusal) -> None:
        raise NotImplementedError

    def refused(self, what: str, *args: Any) -> DriverError | None:
        raise NotImplementedError

    def unwell(self, what: str, remedy: str = "") -> None:
        raise NotImplementedError

    async def serve(self, name: str, methods: Methods) -> Unsubscribe:
        raise DriverError(f"{name}: not for fingers")

    async def probe(self) -> None:
        """It is there."""


def _touched(
    folder: Path, script: Callable[[TouchedRobot], Any], *missing: str
) -> list[tuple[float | None, float | None, str]]:
    """What is told of a script of touches, in virtual time; nothing is left afterwards."""

    async def play() -> list[tuple[float | None, float | None, str]]:
        loop = asyncio.get_running_loop()
        published = PublishedMessages(folder, LoopClock(loop))
        robot = TouchedRobot(*missing)
        touch = Touch(robot, published.context)
        await touch.connected()
        await script(robot)
        await asyncio.sleep(1)
        await touch.close()
        assert robot.ended == len(robot.published)
        told = published.all(Reading)
        x, y = ([one for one in told if one.sensor == sensor] for sensor in SENSORS)
        assert [one.text for one in x] == [one.text for one in y]
        return [(a.value, b.value, a.text) for a, b in zip(x, y, strict=True)]

    return run_virtual(play())


def test_a_finger_that_comes_down_is_an_event_with_words(tmp_path: Path) -> None:
    async def scene() -> list[str]:
        published = PublishedMessages(tmp_path, LoopClock(asyncio.get_running_loop()))
        robot = TouchedRobot()
        touch = Touch(robot, published.context)
        await touch.connected()
        for point in ((0.1, 0.1), (0.5, 0.5), (0.9, 0.5), (0.5, 0.9)):
            robot.published["onTouchDownRatio"](*point, "webview")
            robot.published["onTouchUp"](100.0, 100.0)
            await asyncio.sleep(1)
        for _ in range(20):  # somebody drums
            robot.published["onTouchDownRatio"](0.9, 0.9, "webview")
            await asyncio.sleep(0.05)
        await touch.close()
        notices = published.all(Notice)
        assert {(one.level, one.tells) for one in notices} == {("info", SENSORS)}
        return [one.text.partition("touched ")[2] for one in notices]

    assert run_virtual(scene()) == [
        *("at the upper left", "at the middle", "at the middle right", "at the lower middle"),
        *["at the lower right"] * 2,
    ]


async def _swipe(robot: TouchedRobot, moves: int, every: float, size: tuple[float, float]) -> None:
    """A finger that goes from left to right."""
    across, down = size
    robot.published["onTouchDownRatio"](0.1, 0.5, "webview")
    robot.published["onTouchDown"](0.1 * across, 0.5 * down)
    for step in range(1, moves + 1):
        await asyncio.sleep(every)
        robot.published["onTouchMove"]((0.1 + 0.8 * step / moves) * across, 0.5 * down)
    robot.published["onTouchUp"](0.9 * across, 0.5 * down)


@pytest.mark.parametrize("size", [(1280.0, 800.0), (1707.0, 1067.0), (1600.0, 1080.0)])
def test_moves_are_thinned_and_the_last_one_is_never_lost(
    tmp_path: Path, size: tuple[float, float]
) -> None:
    told = _touched(tmp_path, lambda robot: _swipe(robot, 100, 0.01, size))
    assert told[0] == (0.1, 0.5, "down")
    assert told[-2] == (0.9, 0.5, "move")
    assert told[-1] == (0.9, 0.5, "up")
    moves = [one for one in told if one[2] == "move"]
    assert 10 <= len(moves) <= 12
    across = [x for x, _, _ in moves if x is not None]
    assert across == sorted(across)


def test_a_move_that_is_held_back_is_told_in_its_time(tmp_path: Path) -> None:
    async def script(robot: TouchedRobot) -> None:
        robot.published["onTouchMove"](128.0, 80.0)
        robot.published["onTouchMove"](256.0, 80.0)
        robot.published["onTouchMove"](384.0, 80.0)

    assert _touched(tmp_path, script) == [(0.1, 0.1, "move"), (0.3, 0.1, "move")]


def test_a_tablet_without_shares_tells_by_pixels(tmp_path: Path) -> None:
    async def script(robot: TouchedRobot) -> None:
        robot.published["onTouchDown"](640.0, 400.0)
        robot.published["onTouchUp"](1707.0, 1067.0)

    told = _touched(tmp_path, script, "onTouchDownRatio", "onTouchMove")
    assert told == [(0.5, 0.5, "down"), (1.0, 1.0, "up")]


def test_a_tablet_that_tells_nothing_is_stale(tmp_path: Path) -> None:
    async def play() -> list[str]:
        published = PublishedMessages(tmp_path, LoopClock(asyncio.get_running_loop()))
        names = ("onTouchDownRatio", "onTouchDown", "onTouchMove", "onTouchUp")
        await Touch(TouchedRobot(*names), published.context).connected()
        return published.states("touch.x")

    assert run_virtual(play()) == ["stale"]


def test_a_tablet_that_tells_thousands_of_touches_fills_no_log(tmp_path: Path) -> None:
    async def play() -> tuple[int, list[str], int]:
        published = PublishedMessages(tmp_path, LoopClock(asyncio.get_running_loop()))
        robot = TouchedRobot()
        touch = Touch(robot, published.context)
        await touch.connected()
        for _ in range(5000):
            robot.published["onTouchDownRatio"](0.5, 0.5)
        told = len(published.values("touch.x"))
        await asyncio.sleep(1.5)
        robot.published["onTouchDownRatio"](0.5, 0.5)
        await touch.close()
        return told, published.states("touch.x"), len(published.values("touch.x")) - told

    told, states, later = run_virtual(play())
    assert 50 < told < 500
    assert states == ["ok", "stale", "ok"]
    assert later == 1


@given(
    st.lists(st.tuples(st.sampled_from(["Down", "DownRatio", "Move", "Up"]), ANYTHING, ANYTHING))
)
def test_no_touch_raises_and_each_is_on_the_screen(
    tmp_path_factory: pytest.TempPathFactory, touches: list[tuple[str, Any, Any]]
) -> None:
    async def script(robot: TouchedRobot) -> None:
        for kind, x, y in touches:
            robot.published[f"onTouch{kind}"](x, y)
        robot.published["onTouchDown"]()

    for x, y, _ in _touched(tmp_path_factory.getbasetemp(), script):
        assert x is not None
        assert y is not None
        assert 0 <= x <= 1
        assert 0 <= y <= 1


def test_pixels_near_an_edge_teach_nothing() -> None:
    scale = TouchScale()
    scale.learn((0.001, 0.5), (900.0, 400.0))
    assert scale.share((640.0, 400.0)) == (0.5, 0.5)
    scale.learn((0.5, 0.5), (853.5, 533.5))
    assert scale.share((853.5, 533.5)) == (0.5, 0.5)


def test_shares_are_shares_until_there_are_pixels() -> None:
    scale = TouchScale()
    assert scale.share((0.5, 1.0)) == (0.5, 1.0)
    assert scale.share((640.0, 1.0)) == (0.5, 1.0 / 800)
    assert scale.share((0.5, 0.5)) == (0.5 / 1280, 0.5 / 800)


def test_what_is_no_place() -> None:
    assert place(1, 2.5) == (1.0, 2.5)
    assert place(float("nan"), 1) is None
    assert place("1", 1) is None
