"""A simulated Reachy Mini and its driver, both twenty times as fast as life."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from naoqi_simulator.robot_time import PacedTime
from robot_simulators.reachy_mini import ReachyMiniSimulator
from woz_drivers.lines import answer_times
from woz_drivers.reachy_mini import ReachyMini, ReachyMiniSettings, daemon_link, sounds
from woz_drivers.sound.wav import Wav
from woz_drivers.speech.settings import SynthesisSettings

from tests.fakes.sound import RATE, square
from woz_tui.drivers import confirmed_stop
from woz_tui.drivers.contract import Health
from woz_tui.protocol.messages import Json
from woz_tui.testing import PlainJob, RecordingContext, until

PACE = 20.0
#: What it says is there as recordings: no program is needed.
VOICE = SynthesisSettings(recordings={"Hello.": "gong.wav", "A long story.": "long.wav"})


@dataclass
class ReachyRig:
    """A driver and the robot at the other end of its wire."""

    driver: ReachyMini
    robot: ReachyMiniSimulator
    context: RecordingContext
    jobs: list[PlainJob] = field(default_factory=list)

    def job(self, verb: str, **args: Any) -> PlainJob:
        """A command with its defaults, as the bus gives it."""
        [offered] = [
            one for one in self.driver.offer(self.driver.settings).verbs if one.name == verb
        ]
        defaults = {one.name: one.default for one in offered.arguments if one.default is not None}
        self.jobs.append(PlainJob(verb, {**defaults, **args}))
        return self.jobs[-1]

    async def do(self, verb: str, **args: Any) -> Mapping[str, Json]:
        """Carry out a verb to its end."""
        return await self.driver.perform(self.job(verb, **args))

    def begin(self, verb: str, **args: Any) -> asyncio.Task[Mapping[str, Json]]:
        """Begin a verb."""
        return asyncio.ensure_future(self.driver.perform(self.job(verb, **args)))

    async def wait_connected(self) -> None:
        """Wait until the driver has found the robot."""
        await until(lambda: self.health is Health.CONNECTED)

    async def lost(self) -> None:
        """Wait until the driver has lost the robot."""
        await until(lambda: self.health is Health.LOST)

    @property
    def health(self) -> Health | None:
        """What the wizard sees."""
        return self.context.healths[-1][0] if self.context.healths else None

    @property
    def asked_to_move(self) -> bool:
        """Whether moves are under way."""
        return bool(self.robot._running())

    @property
    def why(self) -> str:
        """What the wizard reads beside it, with the remedy."""
        return " ".join(self.context.healths[-1][1:])

    def request_bodies(self, path: str) -> list[Any]:
        """Bodies of the requests to a path below /api, or of messages of that type."""
        return [body for name, body in self.robot.calls if name in (f"/api/{path}", path)]


@contextlib.asynccontextmanager
async def reachy(
    folder: Path, robot: ReachyMiniSimulator | None = None, **settings: Any
) -> AsyncIterator[ReachyRig]:
    """A driver that has found its robot."""
    async with robot or ReachyMiniSimulator(PacedTime(PACE)) as started:
        context = RecordingContext(folder)
        usual = {"pace": PACE, "rate": 20.0, "voice": VOICE}
        reachy_mini_settings = ReachyMiniSettings(started.address, **{**usual, **settings})
        driver = ReachyMini("reachy", reachy_mini_settings, context)
        await driver.open()
        reachy_rig = ReachyRig(driver, started, context)
        try:
            await reachy_rig.wait_connected()
            yield reachy_rig
        finally:
            await driver.close()


@pytest.fixture(autouse=True)
def busy_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a stop confirms is tested, not how soon on a machine that does other things."""
    monkeypatch.setattr(confirmed_stop, "STOP_S", 20.0)
    monkeypatch.setattr(answer_times, "_SLOW_MS", 10_000.0)
    monkeypatch.setattr(daemon_link, "QUICK_S", 10.0)
    monkeypatch.setattr(sounds, "QUICK_S", 10.0)


@pytest.fixture
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """A stop that is never confirmed is told of after a moment."""
    monkeypatch.setattr(confirmed_stop, "STOP_S", 0.3)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An experiment's folder with two sounds, of two seconds and of a minute."""
    for name, seconds in (("gong.wav", 2.0), ("long.wav", 60.0)):
        sound = Wav("S16_LE", RATE, 1, square(seconds, 0.5))
        (tmp_path / name).write_bytes(sound.to_bytes())
    return tmp_path


@pytest.fixture
async def rig(folder: Path) -> AsyncIterator[ReachyRig]:
    """A driver that has found its robot."""
    async with reachy(folder) as reachy_rig:
        yield reachy_rig
