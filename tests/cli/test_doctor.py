"""`woz doctor`: every finding with a level and a way out, and an exit code to build on."""

from __future__ import annotations

import fcntl
import json
import os
import subprocess
import sys
import termios
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests.fakes.answering_terminal import answering

GOOD = """\
title: Greeting
robot: simulated
panels:
  - title: Speech
    actions:
      - {key: h, label: Hello, say: "Hello!"}
"""

BROKEN = GOOD.replace("say:", "sai:").replace("title: Greeting", "titel: Greeting")

#: A driver as a stranger would package it, whose checks do not work.
STRANGER = """\
from dataclasses import dataclass
from woz_tui.drivers.contract import PassiveDriver


@dataclass(frozen=True)
class Settings:
    pass


class Broken(PassiveDriver):
    Settings = Settings
    summary = "a driver whose checks do not work"

    @classmethod
    async def examine(cls, probe):
        raise RuntimeError("the vendor's library is missing")

"""


@dataclass(frozen=True)
class DoctorRun:
    """What one run of the doctor said."""

    code: int
    out: str
    err: str

    def findings(self) -> list[dict[str, str]]:
        findings: list[dict[str, str]] = json.loads(self.out)["findings"]
        return findings

    def find(self, section: str) -> list[dict[str, str]]:
        return [finding for finding in self.findings() if finding["section"].startswith(section)]


@pytest.fixture
def visit(tmp_path: Path) -> Callable[..., DoctorRun]:
    """Runs `woz doctor`, without a terminal unless one is given."""

    def run(*options: str, terminal: int | None = None, **environ: str) -> DoctorRun:
        def adopt_terminal() -> None:
            if terminal is not None:
                fcntl.ioctl(terminal, termios.TIOCSCTTY, 0)

        done = subprocess.run(
            [sys.executable, "-m", "woz_tui", "doctor", *options],
            cwd=tmp_path,
            env=_environment(tmp_path, environ),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            start_new_session=True,
            preexec_fn=adopt_terminal,
            pass_fds=() if terminal is None else (terminal,),
            timeout=90,
            text=True,
            check=False,
        )
        assert "Traceback" not in done.stderr
        return DoctorRun(done.returncode, done.stdout, done.stderr)

    return run


def _environment(folder: Path, extra: Mapping[str, str]) -> dict[str, str]:
    kept = {
        name: value
        for name, value in os.environ.items()
        if name not in {"TMUX", "STY", "NO_COLOR", "COLUMNS", "COLORTERM", "WOZ_SOCKET"}
    }
    return {**kept, "XDG_RUNTIME_DIR": str(folder), "LANG": "C.UTF-8", **extra}


def write(folder: Path, text: str) -> str:
    path = folder / "study.yaml"
    path.write_text(text)
    return str(path)


def test_without_a_file_the_machine_is_examined(visit: Callable[..., DoctorRun]) -> None:
    doctor_run = visit("--json")
    report: dict[str, Any] = json.loads(doctor_run.out)
    assert set(report) == {"errors", "warnings", "findings"}
    levels = [finding["level"] for finding in doctor_run.findings()]
    assert (report["errors"], report["warnings"]) == (
        levels.count("error"),
        levels.count("warning"),
    )
    assert doctor_run.code == (1 if report["errors"] else 0)
    subjects = {finding["subject"] for finding in doctor_run.findings()}
    assert subjects >= {"terminal", "python", "disk", "recordings", "date", "timing", "socket"}
    assert [finding["level"] for finding in doctor_run.find("Terminal")] == ["info"]


def test_the_recordings_folder_is_the_one_named(
    visit: Callable[..., DoctorRun], tmp_path: Path
) -> None:
    doctor_run = visit("--json", "--recordings", "/proc/nowhere")
    [recordings] = [one for one in doctor_run.findings() if one["subject"] == "recordings"]
    assert (recordings["level"], doctor_run.code) == ("error", 1)
    assert "--recordings" in recordings["remedy"]
    assert not list(tmp_path.glob("recordings*"))


def test_a_terminal_is_asked_what_it_can_do(visit: Callable[..., DoctorRun]) -> None:
    answers = {b"\x1b[?u": b"\x1b[?0u", b"\x1b[c": b"\x1b[?62c", b"\x1b[6n": b"\x1b[1;1R"}
    with answering(answers) as descriptor:
        doctor_run = visit("--json", terminal=descriptor, TERM="xterm-kitty")
    levels = {finding["subject"]: finding["level"] for finding in doctor_run.find("Terminal")}
    assert levels["keys"] == "ok"
    assert {"terminal", "characters", "colours", "size", "connection"} <= set(levels)


def test_a_good_file_has_its_drivers_examined(
    visit: Callable[..., DoctorRun], tmp_path: Path
) -> None:
    doctor_run = visit(write(tmp_path, GOOD), "--json")
    [about] = doctor_run.find("Experiment")
    assert about["level"] == "ok"
    assert "Greeting: 1 action, 1 driver" in about["text"]
    assert doctor_run.find("Driver")


def test_every_error_of_a_broken_file_is_told_with_its_place(
    visit: Callable[..., DoctorRun], tmp_path: Path
) -> None:
    doctor_run = visit(write(tmp_path, BROKEN), "--json")
    errors = [one for one in doctor_run.find("Experiment") if one["level"] == "error"]
    assert doctor_run.code == 1
    assert any("study.yaml:1:1" in one["subject"] for one in errors)
    assert any("study.yaml:6:" in one["subject"] for one in errors)
    assert not doctor_run.find("Driver")


def test_a_robot_file_is_examined_without_an_experiment(
    visit: Callable[..., DoctorRun], tmp_path: Path
) -> None:
    robot = tmp_path / "f1.yaml"
    robot.write_text("name: f1\ndrivers: {one: {type: simulated}}\n")
    doctor_run = visit("f1.yaml", "--json")
    [about] = doctor_run.find("Robot file")
    assert (about["level"], about["text"]) == ("ok", "1 driver")
    assert doctor_run.find("Driver one (simulated)")
    robot.write_text("name: f1\ndrivers: {one: {type: simulatet}}\n")
    [wrong] = visit("f1.yaml", "--json").find("Robot file")
    assert (wrong["level"], wrong["subject"]) == ("error", "f1.yaml:2:17")
    [refused] = visit("f1.yaml", "--robot", "nao", "--json").find("Robot file")
    assert refused["remedy"] == "woz doctor EXPERIMENT --robot nao"


def test_a_computer_that_no_driver_is_at_is_an_error(
    visit: Callable[..., DoctorRun], tmp_path: Path
) -> None:
    drivers = "{arm: {type: simulated, at: arm-pi}, head: {type: simulated}}"
    (tmp_path / "f1.yaml").write_text(f"name: f1\ndrivers: {drivers}\n")
    doctor_run = visit("f1.yaml", "--at", "armpi", "--json")
    [wrong] = doctor_run.find("Computer")
    assert (doctor_run.code, wrong["level"], wrong["remedy"]) == (1, "error", "there are arm-pi")
    assert not doctor_run.find("Driver")
    [elsewhere] = visit("f1.yaml", "--at", "arm-pi", "--json").find("Driver head")
    assert elsewhere["text"] == "its hardware is at the computer of the session"
    assert visit("--at", "arm-pi", "--json").code == 1


def test_a_missing_file_is_an_error_and_the_machine_is_examined_all_the_same(
    visit: Callable[..., DoctorRun],
) -> None:
    doctor_run = visit("nowhere.yaml", "--json")
    [missing] = doctor_run.find("Experiment")
    assert (missing["level"], doctor_run.code) == ("error", 1)
    assert "nowhere.yaml" in missing["subject"]
    assert doctor_run.find("Machine")


def test_a_strangers_driver_that_fails_its_own_checks_is_an_error(
    visit: Callable[..., DoctorRun], tmp_path: Path
) -> None:
    packages = tmp_path / "packages"
    (packages / "stranger-1.0.dist-info").mkdir(parents=True)
    (packages / "stranger.py").write_text(STRANGER)
    metadata = packages / "stranger-1.0.dist-info"
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: stranger\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text("[woz_tui.drivers]\nbroken = stranger:Broken\n")
    (tmp_path / "robot.yaml").write_text("name: Stranger\ndrivers: {arm: {type: broken}}\n")
    study = GOOD.replace("simulated", "robot.yaml").replace("say:", "mark:")
    doctor_run = visit(write(tmp_path, study), "--json", PYTHONPATH=str(packages))
    [finding] = doctor_run.find("Driver arm (broken)")
    assert (finding["level"], doctor_run.code) == ("error", 1)
    assert "the vendor's library is missing" in finding["text"]


def test_the_tables_keep_to_the_width_and_to_plain_text(visit: Callable[..., DoctorRun]) -> None:
    doctor_run = visit("--recordings", "/proc/nowhere", COLUMNS="60", NO_COLOR="1")
    assert "\x1b" not in doctor_run.out
    assert max(map(len, doctor_run.out.splitlines())) <= 60
    assert "✗" in doctor_run.out
    assert "2 errors" in doctor_run.out  # no room, no file


def test_a_screen_without_unicode_gets_plain_signs(visit: Callable[..., DoctorRun]) -> None:
    doctor_run = visit(PYTHONIOENCODING="ascii")
    assert doctor_run.out.isascii()
    assert "ok python" in doctor_run.out
