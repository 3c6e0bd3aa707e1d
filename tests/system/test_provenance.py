"""A log says which program recorded it, as git and the package index say it."""

from __future__ import annotations

import json
import platform
import runpy
import shutil
import subprocess
from importlib import metadata
from pathlib import Path

import pytest

from woz_tui import __version__
from woz_tui.drivers import plugins
from woz_tui.system import provenance
from woz_tui.system.provenance import SOURCE_FILE, software, with_commit

ROOT = Path(__file__).parents[2]


def test_the_commit_is_the_one_that_git_names() -> None:
    told = software(plugins.GROUP)
    done = subprocess.run(
        ["git", "-C", ROOT, "rev-parse", "HEAD"], capture_output=True, text=True, check=False
    )
    if done.returncode:
        pytest.skip("these tests were not checked out with git")
    assert told["commit"] == done.stdout.strip()


def git(folder: Path, *words: str) -> str:
    who = ["-c", "user.name=A", "-c", "user.email=a@example.org"]
    done = subprocess.run(
        ["git", "-C", folder, *who, *words], capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


def copied(tmp_path: Path) -> Path:
    """A tree with the one module, which tells of the tree that it is in."""
    module = tmp_path / "woz_tui" / "system" / "provenance.py"
    module.parent.mkdir(parents=True)
    shutil.copy(provenance.__file__, module)
    (tmp_path / "drivers").mkdir()
    (tmp_path / "pyproject.toml").touch()
    return module


def told_by(module: Path) -> dict[str, str]:
    told: dict[str, str] = runpy.run_path(str(module))["source"]()
    return told


def test_a_checkout_says_whether_the_program_was_edited(tmp_path: Path) -> None:
    module = copied(tmp_path)
    git(tmp_path, "init", "-q")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-q", "-m", "first")
    commit = git(tmp_path, "rev-parse", "HEAD")
    assert told_by(module) == {"commit": commit, "dirty": "no"}

    (tmp_path / "study.yaml").touch()  # no part of the program
    assert told_by(module) == {"commit": commit, "dirty": "no"}
    (tmp_path / "drivers" / "lamp.py").touch()
    assert told_by(module) == {"commit": commit, "dirty": "yes"}
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-q", "-m", "second")
    assert told_by(module) == {"commit": git(tmp_path, "rev-parse", "HEAD"), "dirty": "no"}
    with module.open("a") as file:
        file.write("# one line more\n")
    assert told_by(module)["dirty"] == "yes"


def test_without_git_the_commit_is_known_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = copied(tmp_path)
    git(tmp_path, "init", "-q")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-q", "-m", "first")
    commit = git(tmp_path, "rev-parse", "HEAD")
    monkeypatch.setenv("PATH", str(tmp_path))
    assert told_by(module) == {"commit": commit}


@pytest.mark.parametrize(
    ("written", "told"),
    [
        (None, {}),
        ("", {}),
        ("[]", {}),
        (json.dumps({"commit": "1a2b3c4d", "dirty": "no"}), {"commit": "1a2b3c4d", "dirty": "no"}),
    ],
)
def test_a_package_says_of_which_commit_it_was_built(
    tmp_path: Path, written: str | None, told: dict[str, str]
) -> None:
    module = copied(tmp_path)
    if written is not None:
        (tmp_path / "woz_tui" / SOURCE_FILE).write_text(written)
    assert told_by(module) == told


def test_a_version_is_told_with_what_is_known_of_its_commit() -> None:
    assert with_commit("woz-tui 0.1.0", {}) == "woz-tui 0.1.0"
    assert with_commit("woz-tui 0.1.0", {"commit": "1a2b3c4d"}) == "woz-tui 0.1.0 (1a2b3c4)"
    told = {"commit": "1a2b3c4d", "dirty": "yes"}
    assert with_commit("woz-tui 0.1.0", told) == "woz-tui 0.1.0 (1a2b3c4, edited)"


def test_python_and_libraries_are_those_that_run() -> None:
    told = software(plugins.GROUP)
    assert (told["name"], told["version"]) == ("woz-tui", __version__)
    assert platform.python_version() in told["python"]
    libraries = dict(each.split() for each in told["libraries"].split(", "))
    assert libraries["pyserial"] == metadata.version("pyserial")
    assert libraries["dynamixel-sdk"] == metadata.version("dynamixel-sdk")
    assert "pytest" not in libraries
