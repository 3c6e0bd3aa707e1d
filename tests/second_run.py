"""A pytest plugin: a test marked `real_clock` that fails runs once more, alone, when all are done.

`.ci/test` loads it. A test that passes then is flaky: the last lines name it, and it does not make
the run red. Everything else that fails does, whatever comes of a second run: tests without the
mark, those marked `safety`, a worker that crashed, a file that cannot be collected.

Where `FLAKY_TESTS` names a file, as in `.ci/run`, a line with the day and the test's name is added
there, and the third line of one name makes the run red. The file is the one in the repository,
tests/flaky.txt: who reads the output of a run would forget to write down that a green one was
flaky, but a changed file is committed with the next change, and CI's cache carries it from one run
to the next until then.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import pytest

#: Where so many fail, something is broken: a run for each would only take long.
MOST = 20
#: A test that is flaky in so many runs of CI is a failure, until it is mended.
TOO_OFTEN = 3


def pytest_configure(config: pytest.Config) -> None:
    if not hasattr(config, "workerinput"):  # the first process hears of all failures
        config.pluginmanager.register(SecondRun(config))


class SecondRun:
    """Collects what fails, and runs once more what may fail by chance."""

    def __init__(self, config: pytest.Config) -> None:
        self._config = config
        self._by_chance: list[str] = []  # names, also twice: a test and its teardown may fail

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        # A crash of a worker is reported as a failed test without marks.
        if report.failed and "real_clock" in report.keywords and "safety" not in report.keywords:
            self._by_chance.append(report.nodeid)

    @pytest.hookimpl(wrapper=True, tryfirst=True)  # after the summary of the first run
    def pytest_sessionfinish(self, session: pytest.Session) -> Iterator[None]:
        yield
        names = list(dict.fromkeys(self._by_chance))
        if session.exitstatus != pytest.ExitCode.TESTS_FAILED or not 0 < len(names) <= MOST:
            return
        flaky = [name for name in names if self._passes_alone(name)]
        too_often = _write_down(flaky)
        self._tell("Failed twice", [name for name in names if name not in flaky])
        self._tell("Flaky: failed, then passed when run alone", flaky)
        self._tell(f"Flaky in {TOO_OFTEN} runs, a failure until it is mended", too_often)
        whole = not session.shouldfail  # `-x` leaves tests out
        others = session.testsfailed - len(self._by_chance)
        if whole and not others and flaky == names and not too_often:
            session.exitstatus = pytest.ExitCode.OK

    def _passes_alone(self, name: str) -> bool:
        """Run this test with the same options, without other tests and workers."""
        options = [
            option
            for option in self._config.invocation_params.args
            if option not in self._config.args  # files and tests
        ]
        command = [sys.executable, "-m", "pytest", *options]
        command += ["-n", "0", "-p", f"no:{__name__}", name]
        self._tell("Once more, alone", [name])
        folder = self._config.invocation_params.dir
        return subprocess.run(command, cwd=folder, check=False).returncode == 0

    def _tell(self, what: str, names: list[str]) -> None:
        reporter = self._config.pluginmanager.get_plugin("terminalreporter")
        if names and reporter:
            reporter.write_line(f"{what}: {len(names)}")
            for name in names:
                reporter.write_line(f"  {name}")
            reporter.flush()


def _write_down(flaky: list[str]) -> list[str]:
    """Add these to the file of flaky tests, if there is one; those that are there too often."""
    place = os.environ.get("FLAKY_TESTS")
    if not place:
        return []
    today = datetime.now(UTC).date()
    with Path(place).open("a") as file:
        file.writelines(f"{today} {name}\n" for name in flaky)
    lines = Path(place).read_text().splitlines()
    written = [line.partition(" ")[2] for line in lines if not line.startswith("#")]
    return [name for name in flaky if written.count(name) >= TOO_OFTEN]
