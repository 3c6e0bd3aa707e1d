"""Drivers in a process of their own: used as those here, held up by nobody, named when lost."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from woz_drivers.simulated import SimulatedRobot

from tests.network.slow_import import Slow
from tests.network.worker import Worker, WorkerSettings, driver_process, worker
from woz_tui.drivers.contract import (
    DeviceLostError,
    Forecast,
    HandInput,
    Health,
    RejectedError,
    Scope,
    StopReport,
)
from woz_tui.network.child_line import ChildLine
from woz_tui.network.driver_process import PLACE, DriverProcess, ProcessDriver
from woz_tui.network.driver_server import OfferedDriver
from woz_tui.testing import DriverTests, PlainJob, RecordingContext, until

ROOT = Path(__file__).parents[2]
#: A process of a busy machine takes so long to begin.
BEGIN_S = 60.0

pytestmark = [pytest.mark.real_clock, pytest.mark.usefixtures("patient_network")]


@dataclass
class Worked:
    """A worker in a process, connected."""

    driver: ProcessDriver
    context: RecordingContext
    process: DriverProcess
    folder: Path

    async def healthy(self, health: Health) -> tuple[str, str]:
        """Wait until it is so; the words."""
        await until(lambda: self.context.healths[-1][0] is health, BEGIN_S)
        return self.context.healths[-1][1:]

    async def noted(self, what: str, times: int = 1, name: str = "arm") -> None:
        """Wait until that was done to it in its process."""
        await until(lambda: self.notes(name).count(what) >= times, BEGIN_S)

    def notes(self, name: str = "arm") -> list[str]:
        """What was done to it in its process."""
        file = self.folder / f"{name}.txt"
        return file.read_text().splitlines() if file.exists() else []

    async def line(self) -> ChildLine:
        """To its process."""
        line = await self.process.join(PLACE)
        await self.process.leave()
        assert isinstance(line, ChildLine)
        return line


def children_of(process: int) -> list[str]:
    """Process ids of its children."""
    return Path(f"/proc/{process}/task/{process}/children").read_text().split()


@contextlib.asynccontextmanager
async def working(folder: Path) -> AsyncIterator[Worked]:
    process, context = driver_process(folder, arm=WorkerSettings()), RecordingContext(folder)
    worked = Worked(worker(process, context), context, process, folder)
    await worked.driver.open()
    try:
        await worked.healthy(Health.CONNECTED)
        yield worked
    finally:
        await worked.driver.close()


# -- the contract ----------------------------------------------------------------------------------


@pytest.mark.safety
class TestRobotInAProcess(DriverTests):
    driver = SimulatedRobot
    settings = SimulatedRobot.Settings()
    own_process = True


# -- use -------------------------------------------------------------------------------------------


async def test_it_works_in_another_process_which_ends_with_it(tmp_path: Path) -> None:
    async with working(tmp_path) as arm:
        done = await arm.driver.perform(PlainJob("wave"))
        assert done["pid"] not in (os.getpid(), 0)
        assert await arm.driver.predict("lift", {}) == Forecast(1.5, ((0.5, "stroke", "lift"),))
        changes = await asyncio.to_thread(arm.driver.reread, WorkerSettings(), dry_run=True)
        assert changes == ["arm knows more"]
    assert arm.notes() == ["open", "close"]
    assert arm.context.notices[-1][1] == "it has waved enough"
    with pytest.raises(ProcessLookupError):
        os.kill(int(str(done["pid"])), 0)


async def test_it_is_connected_as_soon_as_it_is_heard(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    slow = "from woz_tui.network import driver_server\ndriver_server.HERE_S = 3600.0\n"
    (tmp_path / "sitecustomize.py").write_text(slow)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    async with working(tmp_path) as arm:
        await arm.healthy(Health.CONNECTED)


async def test_files_are_written_where_those_of_the_session_are(tmp_path: Path) -> None:
    async with working(tmp_path) as arm:
        await arm.driver.perform(PlainJob("write"))
        assert (arm.context.media / "heard.txt").read_text() == "hello"


async def test_hands_reach_it_and_a_refusal_comes_with_the_next_one(tmp_path: Path) -> None:
    async with working(tmp_path) as arm:
        arm.driver.take_hand(HandInput("con1", {"lever": 0.5}))
        await until(lambda: bool(arm.context.of("lever")))
        assert arm.context.latest("lever") == 0.5
        arm.driver.take_hand(HandInput("con2"))
        await until(lambda: bool(arm.driver._refused))
        with pytest.raises(RejectedError, match="con1 has it"):
            arm.driver.take_hand(HandInput("con2"))
        arm.driver.lose_hand("con1")
        await arm.noted("con1 let go")


async def test_drivers_of_one_process_share_feeds(tmp_path: Path) -> None:
    settings = {"arm": WorkerSettings(), "leg": WorkerSettings(beside="arm")}
    process = driver_process(tmp_path, **settings)
    contexts = {name: RecordingContext(tmp_path) for name in settings}
    drivers = {
        name: ProcessDriver(
            *(name, settings[name], contexts[name]), local=Worker, kind="worker", process=process
        )
        for name in settings
    }
    try:
        for name, driver in drivers.items():
            await driver.open()
            healths = contexts[name].healths
            await until(lambda told=healths: told[-1][0] is Health.CONNECTED, BEGIN_S)  # type: ignore[misc]
        first = await drivers["arm"].perform(PlainJob("wave"))
        second = await drivers["leg"].perform(PlainJob("wave"))
        assert (first["count"], second["count"]) == (1, 2)
        assert first["pid"] == second["pid"]
    finally:
        for driver in drivers.values():
            await driver.close()


async def test_an_error_that_nobody_waits_for_is_told_with_its_place(tmp_path: Path) -> None:
    async with working(tmp_path) as arm:
        await arm.driver.perform(PlainJob("break"))
        words = await arm.healthy(Health.FAULTED)
        assert "ZeroDivisionError: a wheel (worker.py:" in words[0]
        assert (await arm.driver.perform(PlainJob("wave")))["pid"]


# -- what goes wrong -------------------------------------------------------------------------------


async def test_one_whose_import_does_not_end_holds_up_nobody(tmp_path: Path) -> None:
    slow, context = OfferedDriver("slow", "slow", Slow, WorkerSettings()), RecordingContext()
    process = DriverProcess([slow], tmp_path)
    driver = ProcessDriver(
        *("slow", WorkerSettings(), context), local=Slow, kind="slow", process=process
    )
    async with working(tmp_path) as arm:
        await driver.open()
        assert (await arm.driver.perform(PlainJob("wave")))["pid"]
        assert context.healths == [(Health.CONNECTING, "its process begins", "")]
        with pytest.raises(DeviceLostError, match="its process cannot be reached"):
            await driver.perform(PlainJob("wave"))
        await driver.close()


@pytest.mark.safety
async def test_one_that_is_killed_is_lost_named_and_begun_anew(tmp_path: Path) -> None:
    async with working(tmp_path) as arm:
        job = PlainJob("lift")
        lifting = asyncio.create_task(arm.driver.perform(job))
        await until(lambda: bool(job.marks))
        (await arm.line()).kill()
        with pytest.raises(DeviceLostError, match="its process was ended by SIGKILL"):
            await lifting
        assert "SIGKILL" in (await arm.healthy(Health.LOST))[0]
        await arm.healthy(Health.CONNECTED)
        assert (await arm.driver.perform(PlainJob("wave")))["count"] == 1
    assert arm.notes() == ["open", "open", "close"]


@pytest.mark.safety
async def test_a_stop_is_confirmed_by_the_driver_itself(tmp_path: Path) -> None:
    async with working(tmp_path) as arm:
        assert await arm.driver.stop(Scope.ALL) == StopReport(confirmed=("arm",))
        assert arm.notes()[-1] == "stop all"


@pytest.mark.safety
async def test_one_that_does_not_hear_the_stop_is_ended_and_begins_stopped(
    tmp_path: Path,
) -> None:
    async with working(tmp_path) as arm:
        blocking = asyncio.create_task(arm.driver.perform(PlainJob("block", {"seconds": 1000.0})))
        await arm.noted("block")
        with pytest.raises(DeviceLostError, match=r"did not confirm the stop in time|not answer"):
            await arm.driver.stop(Scope.ALL)
        with pytest.raises(DeviceLostError):
            await blocking
        await arm.noted("open", times=2)
        assert arm.notes()[-2:] in (["stop all", "open"], ["open", "stop all"])
        await arm.healthy(Health.CONNECTED)
        await arm.driver.resume()


@pytest.mark.safety
async def test_a_stop_ends_the_process_of_one_that_has_been_lost_for_a_while(
    tmp_path: Path,
) -> None:
    async with working(tmp_path) as arm:
        blocking = asyncio.create_task(arm.driver.perform(PlainJob("block", {"seconds": 1000.0})))
        assert "does not answer" in (await arm.healthy(Health.LOST))[0]
        with pytest.raises(DeviceLostError):
            await blocking
        assert await arm.driver.stop(Scope.ALL) is None
        await until(lambda: "did not hear the stop" in arm.context.healths[-1][1], BEGIN_S)
        await arm.healthy(Health.CONNECTED)
        assert arm.notes().count("stop all") >= 1


@pytest.mark.safety
async def test_when_the_session_is_killed_its_drivers_stop_and_their_process_ends(
    tmp_path: Path,
) -> None:
    words = [sys.executable, "-m", "tests.network.worker_session", str(tmp_path)]
    with subprocess.Popen(words, cwd=ROOT) as session:  # noqa: ASYNC220
        await until((tmp_path / "lifts").exists, BEGIN_S)
        children = children_of(session.pid)
        session.send_signal(signal.SIGKILL)
    notes = tmp_path / "arm.txt"
    await until(lambda: "stop all" in notes.read_text(), BEGIN_S)
    await until(lambda: not any(Path(f"/proc/{child}").exists() for child in children), BEGIN_S)
    assert len(children) == 1
    assert notes.read_text().split("\n")[:2] == ["open", "stop all"]
    assert "close" not in notes.read_text()
