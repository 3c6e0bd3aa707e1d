"""`woz drivers`: what it says before it serves, and a real process that is killed and frozen."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from woz_drivers.simulated import SimulatedRobot

from tests.fakes.ports import free_port
from tests.fakes.terminal import FakeTerminal
from tests.network.installed_worker import installed_worker
from tests.network.other_computer import PATIENT, SILENCE_S
from tests.network.worker import Worker, WorkerSettings
from woz_tui import cli
from woz_tui.cli import doctor
from woz_tui.drivers.contract import DeviceLostError, Health
from woz_tui.network import remote_driver
from woz_tui.network.driver_router import DriverRouter
from woz_tui.network.remote_driver import RemoteDriver
from woz_tui.testing import PlainJob, RecordingContext, until

ROBOT = "drivers: {arm: {type: simulated, at: arm-pi}, leg: {type: simulated, at: leg-pi}}\n"


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["tcp://127.0.0.1:7447"], "at: NAME"),
        (["tcp://127.0.0.1:7447", "--at", "ear-pi"], "arm-pi, leg-pi"),
        (["robot.local:7447", "--at", "arm-pi"], "woz access new"),
        ([], "HOST:PORT"),
        (["--access", "robot.yaml"], "no access file"),
    ],
)
def test_what_is_wrong_is_told(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    told: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("robot.yaml").write_text(ROBOT)
    assert cli.main(["drivers", "--serve", "robot.yaml", *words]) == 1
    assert told in capsys.readouterr().err


def test_the_doctor_looks_at_the_drivers_of_the_computer_that_it_is_on(tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text(ROBOT)
    sections = {
        at: {each.title: each.findings for each in doctor.examine(file, tmp_path, at=at)}
        for at in ("", "arm-pi")
    }
    for at, places in (("", ["arm-pi", "leg-pi"]), ("arm-pi", ["", "leg-pi"])):
        found = sections[at]["Driver arm (simulated, at arm-pi)"]
        assert ("its hardware is at" in found[0].text) == ("arm-pi" in places)
        assert "leg-pi" in sections[at]["Driver leg (simulated, at leg-pi)"][0].remedy


def arm(port: int, context: RecordingContext) -> RemoteDriver:
    """The session's side of the arm."""
    return RemoteDriver(
        *("arm", SimulatedRobot.Settings(), context),
        local=SimulatedRobot,
        kind="simulated",
        router=DriverRouter(f"tcp://127.0.0.1:{port}", ["arm-pi"], silence_s=SILENCE_S),
        place="arm-pi",
    )


def offering(folder: Path, port: int) -> list[str]:
    """The command that offers the arm to it."""
    (folder / "robot.yaml").write_text(ROBOT)
    code = "from woz_tui.cli import program; program()"
    words = ["drivers", "--serve", str(folder / "robot.yaml"), "--at", "arm-pi"]
    return [sys.executable, "-c", code, *words, f"tcp://127.0.0.1:{port}"]


@pytest.mark.real_clock
async def test_it_outlives_its_terminal_and_a_second_one_finds_it(tmp_path: Path) -> None:
    port, context = free_port(), RecordingContext()
    command = offering(tmp_path, port)

    async def connected() -> None:
        """A session uses the arm, and ends."""
        remote = arm(port, context)
        context.healths.clear()
        await remote.open()
        try:
            await until(lambda: Health.CONNECTED in [each[0] for each in context.healths], 30)
        finally:
            await remote.close()

    with FakeTerminal(command, columns=120, env=PATIENT) as terminal:
        await connected()
        terminal.wait_text("has ended")
        terminal.close()
        await connected()  # its end is told to nobody
        await connected()
        second = subprocess.run(  # noqa: ASYNC221
            command, capture_output=True, text=True, timeout=60, check=False
        )
        assert second.returncode == 1
        assert f"kill {terminal.process.pid}" in second.stderr
        terminal.process.terminate()
        terminal.wait_exit()


@pytest.mark.real_clock
async def test_a_program_that_is_frozen_and_one_that_is_killed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(remote_driver, "LATE_S", 10.0)  # a busy machine holds commands back
    port, context = free_port(), RecordingContext()
    remote, say = arm(port, context), PlainJob("say", {"text": "a long sentence " * 50})
    await remote.open()
    environ = {**os.environ, **PATIENT}
    with subprocess.Popen(offering(tmp_path, port), env=environ) as process:  # noqa: ASYNC220
        try:
            for end in (signal.SIGSTOP, signal.SIGKILL):
                await until(lambda: context.healths[-1][0] is Health.CONNECTED, 30)
                saying = asyncio.create_task(remote.perform(say))
                await until(lambda: bool(say.expected), 30)
                os.kill(process.pid, end)
                with pytest.raises(DeviceLostError):
                    await saying
                await until(lambda: context.healths[-1][0] is Health.LOST)
                os.kill(process.pid, signal.SIGCONT)
                say.expected.clear()
        finally:
            process.kill()
            await remote.close()


@pytest.mark.real_clock
async def test_an_error_that_nobody_waits_for_is_told_to_the_session_and_on_this_computer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(remote_driver, "LATE_S", 10.0)  # a busy machine holds commands back
    port, context = free_port(), RecordingContext()
    installed_worker(tmp_path, monkeypatch)
    remote = RemoteDriver(
        *("arm", WorkerSettings(), context),
        local=Worker,
        kind="worker",
        router=DriverRouter(f"tcp://127.0.0.1:{port}", ["arm-pi"], silence_s=SILENCE_S),
        place="arm-pi",
    )
    command = offering(tmp_path, port)
    (tmp_path / "robot.yaml").write_text("drivers: {arm: {type: worker, at: arm-pi}}\n")
    environ = {**PATIENT, "PYTHONPATH": f"{PATIENT['PYTHONPATH']}:{tmp_path}"}
    await remote.open()
    try:
        with FakeTerminal(command, columns=120, env=environ) as terminal:
            await until(lambda: context.healths[-1][0] is Health.CONNECTED, 30)
            await remote.perform(PlainJob("break"))
            await until(lambda: context.healths[-1][0] is Health.FAULTED, 30)
            what, remedy = context.healths[-1][1:]
            assert "ZeroDivisionError: a wheel (worker.py:" in what
            assert "arm-pi" in remedy
            terminal.wait_text("Traceback")
    finally:
        await remote.close()
