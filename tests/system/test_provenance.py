"""A log says which program recorded it, as git and the package index say it."""

from __future__ import annotations

import platform
import subprocess
from importlib import metadata
from pathlib import Path

import pytest

from woz_tui import __version__
from woz_tui.drivers import plugins
from woz_tui.system.provenance import software

ROOT = Path(__file__).parents[2]


def test_the_commit_is_the_one_that_git_names() -> None:
    told = software(plugins.GROUP)
    done = subprocess.run(
        ["git", "-C", ROOT, "rev-parse", "HEAD"], capture_output=True, text=True, check=False
    )
    if done.returncode:
        pytest.skip("these tests were not checked out with git")
    assert told["commit"] == done.stdout.strip()


def test_python_and_libraries_are_those_that_run() -> None:
    told = software(plugins.GROUP)
    assert (told["name"], told["version"]) == ("woz-tui", __version__)
    assert platform.python_version() in told["python"]
    libraries = dict(each.split() for each in told["libraries"].split(", "))
    assert libraries["pyserial"] == metadata.version("pyserial")
    assert libraries["dynamixel-sdk"] == metadata.version("dynamixel-sdk")
    assert "pytest" not in libraries
