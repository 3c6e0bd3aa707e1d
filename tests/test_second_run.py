"""Which failed tests get a second run, seen in runs of made-up tests."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.second_run import TOO_OFTEN

ROOT = Path(__file__).parents[1]
HEAD = """
import os
import pathlib
import pytest


def fail_at_first(name):
    place = pathlib.Path(name)
    if not place.exists():
        place.touch()
        pytest.fail("at first")


@pytest.fixture
def late():
    fail_at_first("late")


def test_passes():
    pass
"""
NAME = "test_it.py::test_by_chance"
#: What the output ends with.
FLAKY = f"Flaky: failed, then passed when run alone: 1\n  {NAME}\n"
BY_CHANCE = """
@pytest.mark.real_clock
def test_by_chance():
    fail_at_first("by chance")
"""
FIXTURE_BY_CHANCE = """
@pytest.mark.real_clock
def test_by_chance(late):
    pass
"""
SAFETY = """
@pytest.mark.safety
@pytest.mark.real_clock
def test_of_safety():
    fail_at_first("safety")
"""
WITHOUT_MARK = """
def test_without_mark():
    fail_at_first("without mark")
"""
TWICE = """
@pytest.mark.real_clock
def test_twice():
    pytest.fail("each time")
"""
CRASH = """
@pytest.mark.real_clock
def test_crash():
    place = pathlib.Path("crash")
    if not place.exists():
        place.touch()
        os._exit(1)
"""


def run(folder: Path, tests: str, *options: str, ledger: Path | None = None) -> tuple[int, str]:
    """The exit code of a run of these tests, and what it printed."""
    (folder / "pytest.ini").write_text("[pytest]\nmarkers =\n  real_clock\n  safety\n")
    (folder / "test_it.py").write_text(HEAD + tests)
    environment = os.environ | {
        "PYTHONPATH": str(ROOT),
        "PYTEST_ADDOPTS": "-p xdist.plugin",
        "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",  # for speed
        "FLAKY_TESTS": str(ledger or ""),
    }
    environment = {name: of for name, of in environment.items() if "PYTEST_XDIST" not in name}
    command = [sys.executable, "-m", "pytest", "-p", "tests.second_run", *options]
    done = subprocess.run(
        command, cwd=folder, env=environment, check=False, capture_output=True, text=True
    )
    return done.returncode, done.stdout


@pytest.mark.parametrize("options", [("-n", "2"), ("-m", "real_clock", "test_it.py")])
def test_who_fails_by_chance_is_flaky_and_named(tmp_path: Path, options: tuple[str, ...]) -> None:
    code, printed = run(tmp_path, BY_CHANCE, *options)
    assert code == 0
    assert printed.endswith(FLAKY)


def test_a_failed_fixture_counts_as_a_failed_test(tmp_path: Path) -> None:
    code, printed = run(tmp_path, FIXTURE_BY_CHANCE)
    assert code == 0
    assert printed.endswith(FLAKY)


@pytest.mark.parametrize("tests", [SAFETY, WITHOUT_MARK])
def test_without_the_mark_or_for_safety_there_is_no_second_run(tmp_path: Path, tests: str) -> None:
    code, printed = run(tmp_path, tests)
    assert code == 1
    assert "Once more" not in printed


def test_who_fails_twice_is_red(tmp_path: Path) -> None:
    code, printed = run(tmp_path, BY_CHANCE + TWICE)
    assert code == 1
    assert "Failed twice: 1\n  test_it.py::test_twice\n" in printed
    assert printed.endswith(FLAKY)


def test_a_crashed_worker_is_red_though_its_test_would_pass(tmp_path: Path) -> None:
    code, printed = run(tmp_path, CRASH + BY_CHANCE, "-n", "1")
    assert code == 1
    assert printed.endswith(FLAKY)


@pytest.mark.parametrize("options", [("-n", "1"), ("--continue-on-collection-errors",)])
def test_a_file_that_cannot_be_collected_is_red(tmp_path: Path, options: tuple[str, ...]) -> None:
    (tmp_path / "test_other.py").write_text("import nothing_of_this_name\n")
    code, _ = run(tmp_path, BY_CHANCE, *options)
    assert code != 0


def test_what_the_first_failure_left_out_has_not_passed(tmp_path: Path) -> None:
    code, printed = run(tmp_path, BY_CHANCE + TWICE, "-x")
    assert code == 1
    assert printed.endswith(FLAKY)


@pytest.mark.parametrize(("times", "expected"), [(TOO_OFTEN - 1, 0), (TOO_OFTEN, 1)])
def test_the_third_run_in_which_a_test_is_flaky_is_red(
    tmp_path: Path, times: int, expected: int
) -> None:
    ledger = tmp_path / "flaky.txt"
    ledger.write_text("# day, name\n" + f"2026-02-03 {NAME}\n" * (times - 1))
    code, printed = run(tmp_path, BY_CHANCE, ledger=ledger)
    assert code == expected
    assert printed.endswith(f"until it is mended: 1\n  {NAME}\n") is bool(expected)
    assert ledger.read_text().count(f" {NAME}\n") == times
