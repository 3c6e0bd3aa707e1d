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

from tests.network.other_computer import PATIENT, SILENCE_S, free_port
from woz_tui import cli
from woz_tui.cli import doctor
from woz_tui.drivers.contract import DeviceLostError, Health
from woz_tui.network import remote_driver
from woz_tui.network.driver_line import DriverRouter
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


@pytest.mark.real_clock
async def test_a_program_that_is_frozen_and_one_that_is_killed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(remote_driver, "LATE_S", 10.0)  # a busy machine holds commands back
    file, port, context = tmp_path / "robot.yaml", await free_port(), RecordingContext()
    file.write_text(ROBOT)
    remote = RemoteDriver(
        *("arm", SimulatedRobot.Settings(), context),
        local=SimulatedRobot,
        kind="simulated",
        router=DriverRouter(f"tcp://127.0.0.1:{port}", ["arm-pi"], silence_s=SILENCE_S),
        place="arm-pi",
    )
    code = "from woz_tui.cli import program; program()"
    words = ["drivers", "--serve", str(file), "--at", "arm-pi", f"tcp://127.0.0.1:{port}"]
    command, environ = [sys.executable, "-c", code, *words], {**os.environ, **PATIENT}
    say = PlainJob("say", {"text": "a long sentence " * 50})
    await remote.open()
    with subprocess.Popen(command, env=environ) as process:  # noqa: ASYNC220
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
