"""The example feature: installed as a stranger would, it is found and works."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

EXAMPLE = Path(__file__).parents[2] / "drivers" / "example_feature"


def run(*arguments: str, site: Path | None = None, cwd: Path) -> str:
    """What a Python says, with the packages that were installed into `site`."""
    environment = dict(os.environ)
    environment.pop("PYTEST_ADDOPTS", None)
    if site is not None:
        environment["PYTHONPATH"] = str(site)
    done = subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        text=True,
        timeout=200,
        env=environment,
        cwd=cwd,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_its_own_tests_pass_where_it_is_installed(tmp_path: Path) -> None:
    site = tmp_path / "site"
    pip = ("-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-index")
    how = ("--no-deps", "--no-build-isolation", "--target", str(site))
    run(*pip, *how, str(EXAMPLE), cwd=tmp_path)
    plain = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist")
    files = ("-c", str(EXAMPLE / "pyproject.toml"), str(EXAMPLE / "tests"))
    told = run(*plain, *files, site=site, cwd=tmp_path)
    assert re.search(r"\b6 passed in", told), told


def test_without_it_the_file_that_uses_it_is_told_so(tmp_path: Path) -> None:
    words = [sys.executable, "-m", "woz_tui", "check", str(EXAMPLE / "reminders.yaml")]
    done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode != 0
    assert "reminders" in done.stdout + done.stderr
