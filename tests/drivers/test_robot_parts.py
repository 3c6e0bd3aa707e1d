"""A robot of parts that is written from the base alone: a lamp on a turntable."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import pytest

from woz_tui.drivers import confirmed_stop, robot_parts
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverContext,
    DriverError,
    Job,
    Offer,
    RejectedError,
    Scope,
    StopReport,
)
from woz_tui.drivers.robot_parts import RobotOfParts, RobotPart
from woz_tui.drivers.robot_settings import RobotSetting
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.protocol.messages import Json, SettingsShown
from woz_tui.protocol.robot_outline import RobotOutline
from woz_tui.testing import PlainJob, RecordingContext

BRIGHTNESS = RobotSetting(
    *("Light", "brightness", "number", "0 dark, 1 full", "brightness", "level"), file="brightness"
)


@dataclass(frozen=True, slots=True)
class LampSettings:
    """One lamp."""

    brightness: Annotated[float | None, BRIGHTNESS.range, BRIGHTNESS.doc] = None


class LampLink:
    """The wire, on which the test sees what comes and says what answers."""

    def __init__(self) -> None:
        self.ready = False
        self.sent: list[str] = []
        self.stands = asyncio.Event()

    def need(self) -> None:
        """Raises `DeviceLostError` while it is not there."""
        if not self.ready:
            raise DeviceLostError("the lamp is not there")

    def start(self) -> None:
        """Begin to look for it."""
        self.sent.append("hello")

    async def close(self) -> None:
        """Let go of it."""
        self.ready = False
        self.sent.append("goodbye")


class Light(RobotPart[LampLink, LampSettings]):
    """Shines."""

    name = "light"
    SETTINGS = (BRIGHTNESS,)

    def __init__(self, link: LampLink, settings: LampSettings, context: DriverContext) -> None:
        super().__init__(link, settings, context)
        self._level = settings.brightness

    @classmethod
    def offer(cls, settings: LampSettings) -> Offer:
        return Offer(verbs=(BRIGHTNESS.changed_by("how bright it is", lane="light"),))

    async def perform(self, job: Job) -> Mapping[str, Json]:
        self._level = job.args["level"]
        self._link.sent.append(f"level {self._level}")
        return {"level": self._level}

    async def halt(self, scope: Scope) -> Sequence[asyncio.Future[Any]]:
        self._link.sent.append("steady")
        return ()

    async def connected(self) -> None:
        if self._level == 1.0:
            raise DriverError("the lamp is too hot for its full brightness", "let it cool")

    def shown(self) -> Mapping[str, Json]:
        return {"brightness": self._level}


class Turntable(RobotPart[LampLink, LampSettings]):
    """Turns, and confirms when it stands."""

    name = "motion"

    @classmethod
    def offer(cls, settings: LampSettings) -> Offer:
        return Offer(verbs=(common_verb("play", choices=("circle",)),))

    async def halt(self, scope: Scope) -> Sequence[asyncio.Future[Any]]:
        return (asyncio.ensure_future(self._link.stands.wait()),)

    def resume(self) -> None:
        self._link.sent.append("may turn")


class LampRobot(RobotOfParts[LampLink, LampSettings]):
    """A lamp on a turntable."""

    Settings = LampSettings
    summary = "a lamp on a turntable"
    PARTS: ClassVar[tuple[type[RobotPart[Any, Any]], ...]] = (Light, Turntable)
    called = "a lamp"

    def __init__(self, name: str, settings: LampSettings, context: DriverContext) -> None:
        link = LampLink()
        about = (link, settings, context)
        super().__init__(name, settings, context, link, [part(*about) for part in self.PARTS])
        self.link = link

    async def comes(self) -> None:
        """The lamp is there."""
        self.link.ready = True
        await self._connected()


class Wheels(RobotPart[LampLink, LampSettings]):
    """Carries it through the room."""

    name = "driving"

    @classmethod
    def offer(cls, settings: LampSettings) -> Offer:
        return Offer(verbs=(common_verb("drive"),))

    async def halt(self, scope: Scope) -> Sequence[asyncio.Future[Any]]:
        self._link.sent.append("brake")
        return ()


class RollingLampRobot(LampRobot):
    """The same on wheels."""

    PARTS = (Light, Turntable, Wheels)


@pytest.fixture
def context() -> RecordingContext:
    return RecordingContext()


@pytest.fixture
def robot(context: RecordingContext) -> LampRobot:
    return LampRobot("lamp", LampSettings(), context)


def test_what_it_offers_comes_from_its_parts_and_rows() -> None:
    assert [verb.name for verb in LampRobot.offer(LampSettings()).verbs] == ["brightness", "play"]
    outline = RobotOutline.read(LampRobot.offer(LampSettings()).outline)
    assert outline is not None and outline.moves == ["circle"] and not outline.camera
    [line] = outline.settings
    assert (line.verb, line.argument, line.high, line.help) == (
        *("brightness", "level", 1.0),
        "0 dark, 1 full",
    )


async def test_a_verb_goes_to_its_part_once_the_robot_is_there(
    robot: LampRobot, context: RecordingContext
) -> None:
    await robot.open()
    with pytest.raises(DeviceLostError, match="not there"):
        await robot.perform(PlainJob("brightness", {"level": 0.5}))
    with pytest.raises(RejectedError, match="a lamp cannot 'dance'"):
        await robot.perform(PlainJob("dance"))
    await robot.comes()
    assert await robot.perform(PlainJob("brightness", {"level": 0.5})) == {"level": 0.5}
    assert robot.link.sent == ["hello", "level 0.5"]
    assert context.shown[-1] == SettingsShown(values={"brightness": 0.5})


async def test_what_the_robot_does_not_take_is_told_and_costs_nothing_else(
    context: RecordingContext,
) -> None:
    robot = LampRobot("lamp", LampSettings(brightness=1.0), context)
    await robot.comes()
    assert context.notices == [
        ("warning", "the lamp is too hot for its full brightness", "let it cool")
    ]
    assert await robot.perform(PlainJob("brightness", {"level": 0.2}))


async def test_each_part_confirms_its_own_share_of_the_stop(
    robot: LampRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert await robot.stop(Scope.ALL) is None  # nothing is there that moves
    await robot.comes()
    assert await robot.stop(Scope.DRIVE) is None
    monkeypatch.setattr(confirmed_stop, "STOP_S", 0.1)
    assert await robot.stop(Scope.ALL) == StopReport(("light",), ("motion",))
    robot.link.stands.set()
    monkeypatch.setattr(confirmed_stop, "STOP_S", 5.0)
    assert await robot.stop(Scope.ALL) == StopReport(("light", "motion"))
    await robot.resume()
    assert robot.link.sent == ["steady", "steady", "may turn"]


async def test_a_stop_of_driving_reaches_what_drives_and_gives_no_other_stop_up(
    context: RecordingContext, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = RollingLampRobot("lamp", LampSettings(), context)
    await robot.comes()
    assert await robot.stop(Scope.DRIVE) == StopReport(("driving",))
    assert robot.link.sent == ["brake"]
    monkeypatch.setattr(confirmed_stop, "STOP_S", 5.0)
    robot.link.stands.set()
    everything = asyncio.ensure_future(robot.stop(Scope.ALL))
    await asyncio.sleep(0)  # it is under way
    assert await robot.stop(Scope.DRIVE) == StopReport(("driving",))
    assert await everything == StopReport(("driving", "light", "motion"))


async def test_nothing_is_done_after_the_end(robot: LampRobot) -> None:
    await robot.comes()
    await robot.close()
    await robot.close()
    assert robot.link.sent == ["goodbye"]
    with pytest.raises(DeviceLostError, match="is closed"):
        await robot.perform(PlainJob("brightness", {"level": 0.5}))


async def test_a_part_that_does_not_close_keeps_the_others_from_nothing(
    context: RecordingContext, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(robot_parts, "PARTS_CLOSE_S", 0.05)

    class StuckWheels(Wheels):
        async def close(self) -> None:
            await asyncio.Event().wait()

    class BrokenTurntable(Turntable):
        async def close(self) -> None:
            raise OSError("no such motor")

    class WornLampRobot(LampRobot):
        PARTS: ClassVar[tuple[type[RobotPart[Any, Any]], ...]] = (StuckWheels, BrokenTurntable)

    robot = WornLampRobot("lamp", LampSettings(), context)
    await robot.comes()
    await robot.close()
    assert robot.link.sent == ["goodbye"]
    assert "no such motor" in caplog.text
