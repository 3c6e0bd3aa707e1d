"""Run the tests of the core and those that belong to what you changed, in under a minute.

`make quick`. Changed is what differs from where the branch left main, committed or not. The tests
nearest to it come first, then the core, then those of the same room; what has no time any more is
named. Left to `make test` are tests that need the real clock, a browser or other programs.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tools import ROOT

#: What everything else stands on.
CORE = [
    f"tests/{room}"
    for room in ("system", "protocol", "gate", "bus", "log", "timeline", "session", "host")
]
#: Seconds from the first test on, after which none begins; those that run have ten more to end.
LIMIT_S = 40.0
NOT_QUICK = ("real_clock", "peers", "namespaces", "browser", "tmux", "espeak", "alsa", "cpp")


def main() -> int:
    """The exit code: that of pytest; 0 if all passed that had time."""
    near, far = belonging(changed(ROOT), ROOT)
    files = list(dict.fromkeys([*near, *_tests(CORE, ROOT), *far]))
    sys.stdout.write(
        f"{len(near)} files of tests nearest to what you changed, {len(files)} in all\n"
    )
    limit = TimeLimit(LIMIT_S)
    options = ["-q", "-n", str(1 + (os.cpu_count() or 1)), "--dist", "loadfile"]
    options += ["--no-loadscope-reorder", "-m", " and ".join(f"not {mark}" for mark in NOT_QUICK)]
    code = pytest.main([*options, *files], plugins=[limit])
    if limit.reached and (missed := [file for file in files if file not in limit.begun]):
        sys.stdout.write(f"no time for {len(missed)} files: {' '.join(missed)}\n")
    return code


class TimeLimit:
    """Ends the run of pytest so long after its first test; knows whose tests have begun."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._until: float | None = None
        self._failed = False
        self.begun: set[str] = set()
        self.reached = False

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """A part of a test is over."""
        if self._until is None:
            self._until = time.monotonic() + self._seconds
        self.begun.add(report.nodeid.partition("::")[0])
        self._failed |= report.failed
        if time.monotonic() > self._until:
            self.reached = True
            pytest.exit(f"{self._seconds:.0f} s are over", returncode=int(self._failed))


def changed(root: Path) -> list[str]:
    """Files that differ from where this branch left main, and new ones that git does not know."""
    for main in ("origin/main", "main"):
        base = _git(root, "merge-base", "HEAD", main)
        if base:
            break
    known = _git(root, "diff", "--name-only", "--diff-filter=d", *(base or ["HEAD"]))
    return sorted({*known, *_git(root, "ls-files", "--others", "--exclude-standard")})


def _git(root: Path, *words: str) -> list[str]:
    done = subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, check=False)
    return done.stdout.split()


def belonging(paths: list[str], root: Path) -> tuple[list[str], list[str]]:
    """Files of tests that belong to these files: the nearest, and those of the same room."""
    tests = {name: (root / name).read_text(encoding="utf-8") for name in _tests(["tests"], root)}
    near, far = list[str](), list[str]()
    for path in paths:
        file = Path(path)
        if path in tests:
            near.append(path)
        elif path.endswith(".md"):
            near += [name for name in tests if name == "tests/test_docs.py"]
        elif path.endswith(".py"):
            module = path.removesuffix(".py").removeprefix("drivers/").replace("/", ".")
            near += [
                name
                for name, text in tests.items()
                if Path(name).stem == f"test_{file.stem}" or f"{module} import" in text
            ]
            far += [name for name in tests if name.startswith(tuple(_rooms(file)))]
    return list(dict.fromkeys(near)), list(dict.fromkeys(far))


def _rooms(file: Path) -> Iterator[str]:
    """How paths of tests begin that belong to the folder of `file`."""
    match file.parts:
        case ("woz_tui", room, *_, _):
            yield f"tests/{room}/"
        case ("drivers", "woz_drivers", driver, *_, _):
            yield from (f"tests/drivers/{driver}/", f"tests/drivers/test_{driver}")
        case ("drivers", package, *_, _):
            yield f"tests/drivers/{package}/"


def _tests(folders: list[str], root: Path) -> list[str]:
    found = (path for folder in folders for path in sorted((root / folder).rglob("test_*.py")))
    return [path.relative_to(root).as_posix() for path in found]


if __name__ == "__main__":
    sys.exit(main())
