"""`.ci/test` and `.ci/bare`, with a stand-in for pytest."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
#: The exit status of pytest that found no test.
NONE = 5
PYTHON = """#!/bin/bash
case "$*" in
  *compileall*) exit 0 ;;
  *"not real_clock"*) exit {computing} ;;
  *) exit {timed} ;;
esac
"""
#: Keeps what it was asked, and which of two programs it finds.
NOTING_PYTHON = """#!/bin/bash
case "$*" in *compileall*) exit 0 ;; esac
echo "$*" >>asked
command -v aplay git >found
exit 0
"""


def checkout(folder: Path, python: str) -> None:
    """The scripts, and a program in the place of Python."""
    (folder / "tests" / "__pycache__").mkdir(parents=True)
    shutil.copytree(ROOT / ".ci", folder / ".ci")
    program(folder / ".venv" / "bin" / "python", python)


def program(path: Path, text: str) -> None:
    """A program at this path."""
    path.parent.mkdir(parents=True)
    path.write_text(text)
    path.chmod(0o755)


def write_tests(folder: Path, markers: dict[str, str]) -> None:
    """Files below `tests`, with the marker of their tests."""
    for name, marker in markers.items():
        file = folder / "tests" / name
        file.parent.mkdir(exist_ok=True)
        file.write_text(f"pytestmark = pytest.mark.{marker}\n")


def run(folder: Path, computing: int, timed: int, *options: str) -> int:
    """The script's status; pytest ends with these, for what does not need the real clock and for
    the rest.
    """
    checkout(folder, PYTHON.format(computing=computing, timed=timed))
    write_tests(folder, {"test_bus.py": "real_clock"})
    command = [str(folder / ".ci" / "test"), *options]
    return subprocess.run(command, capture_output=True, timeout=60, check=False).returncode


@pytest.mark.parametrize("statuses", [(0, 0), (0, NONE), (NONE, 0)])
def test_tests_of_one_sort_alone_are_enough(tmp_path: Path, statuses: tuple[int, int]) -> None:
    assert run(tmp_path, *statuses) == 0


@pytest.mark.parametrize("statuses", [(NONE, NONE), (1, 0), (0, 1), (NONE, 1), (2, NONE)])
def test_no_test_at_all_fails_as_a_failed_one_does(
    tmp_path: Path, statuses: tuple[int, int]
) -> None:
    assert run(tmp_path, *statuses, "-k", "typo") != 0


@pytest.mark.parametrize(("status", "passes"), [(0, True), (NONE, False), (1, False)])
def test_marked_tests_are_one_run(tmp_path: Path, status: int, passes: bool) -> None:
    assert (run(tmp_path, 1, status, "-m", "hypothesis") == 0) is passes


def test_bare_means_without_programs_that_not_every_machine_has(tmp_path: Path) -> None:
    checkout(tmp_path, NOTING_PYTHON)
    program(tmp_path / "bin" / "aplay", "#!/bin/sh\n")
    write_tests(
        tmp_path,
        {
            "drivers/test_speech.py": "asyncio",
            "cli/test_run.py": "asyncio",
            "host/test_process.py": "real_clock",
            "bus/test_bus.py": "real_clock",
        },
    )
    path = f"{tmp_path / 'bin'}:{os.environ['PATH']}"
    done = subprocess.run(
        [str(tmp_path / ".ci" / "bare"), "-x"],
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    assert "aplay is not installed: leaving out the tests marked 'alsa'" in done.stderr
    (found,) = (tmp_path / "found").read_text().splitlines()
    assert Path(found).name == "git"
    # Those on the real clock are a run of their own, which reads no other file.
    first, last = (tmp_path / "asked").read_text().splitlines()
    assert first.endswith(" tests/drivers tests/cli tests/host -x")
    assert last.endswith(" -x tests/host/test_process.py")


def test_the_rest_is_what_was_not_run_bare(tmp_path: Path) -> None:
    checkout(tmp_path, NOTING_PYTHON)
    write_tests(
        tmp_path,
        {
            "drivers/test_speech.py": "asyncio",
            "drivers/test_player.py": "alsa",
            "cli/test_host_start.py": "real_clock",
            "host/test_process.py": "asyncio",
            "bus/test_bus.py": "real_clock",
        },
    )
    told = subprocess.run(
        [str(tmp_path / ".ci" / "bare"), "--tested"],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    options = told.stdout.split()
    assert {Path(option.removeprefix("--ignore=")).name for option in options} == {
        *("test_speech.py", "test_host_start.py", "test_process.py")
    }
    subprocess.run([str(tmp_path / ".ci" / "test"), *options], timeout=60, check=True)
    asked = (tmp_path / "asked").read_text().splitlines()
    assert all(set(options) <= set(each.split()) for each in asked)
    # The run on the real clock is the last one: it reads no other file.
    assert asked[-1].endswith(" tests/bus/test_bus.py")
    assert "tests/cli/test_host_start.py" not in asked[-1].split()


def test_in_a_folder_without_tests_on_the_real_clock_there_is_one_run(tmp_path: Path) -> None:
    checkout(tmp_path, NOTING_PYTHON)
    write_tests(tmp_path, {"bus/test_bus.py": "asyncio", "host/test_host.py": "real_clock"})
    subprocess.run([str(tmp_path / ".ci" / "test"), "tests/bus"], timeout=60, check=True)
    (asked,) = (tmp_path / "asked").read_text().splitlines()
    assert "not real_clock" in asked and asked.endswith(" tests/bus")


def test_options_change_nothing_about_which_files_are_read(tmp_path: Path) -> None:
    checkout(tmp_path, NOTING_PYTHON)
    write_tests(tmp_path, {"test_bus.py": "real_clock"})
    command = [str(tmp_path / ".ci" / "test"), "-q", "--durations=0"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    assert "grep" not in done.stderr
    asked = (tmp_path / "asked").read_text().splitlines()
    assert asked[-1].endswith(" -q --durations=0 tests/test_bus.py")
