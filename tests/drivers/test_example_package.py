"""The example driver of drivers/README.md: installed as a stranger would, it is found and works."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from woz_tui.drivers.robot_verbs import COMMON_VERBS, main_argument

DRIVERS = Path(__file__).parents[2] / "drivers"
EXAMPLE = DRIVERS / "example"
README = DRIVERS / "README.md"

LOAD = """
import sys
from pathlib import Path
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed

catalogue = installed()
lamp = catalogue["lamp"]
assert lamp.__module__ == "woz_driver_lamp.lamp"
experiment = load(Path(sys.argv[1]), catalogue)
print(sys.modules[lamp.__module__].__file__)
print(experiment.drivers[0].settings.brightness)
print(*(verb.name for verb in experiment.drivers[0].offer.verbs))
print(*(action.label for panel in experiment.panels for action in panel.actions))
"""


def run(*arguments: str, path: Path | None = None, cwd: Path) -> str:
    environment = dict(os.environ)
    environment.pop("PYTEST_ADDOPTS", None)
    if path is not None:
        environment["PYTHONPATH"] = str(path)
    done = subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        text=True,
        timeout=100,
        env=environment,
        cwd=cwd,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example, built and installed into a folder of its own."""
    target = tmp_path_factory.mktemp("site")
    pip = ("-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-index")
    how = ("--no-deps", "--no-build-isolation", "--target", str(target))
    run(*pip, *how, str(EXAMPLE), cwd=target)
    return target


def test_it_is_found_and_an_experiment_can_use_it(site: Path, tmp_path: Path) -> None:
    told = run("-c", LOAD, str(EXAMPLE / "lamp.yaml"), path=site, cwd=tmp_path)
    file, brightness, verbs, labels = told.splitlines()
    assert Path(file).is_relative_to(site)
    assert (brightness, verbs, labels) == ("0.8", "glow", "Warm Dark")


def test_its_own_tests_pass_over_a_pseudo_terminal(site: Path, tmp_path: Path) -> None:
    plain = ("-q", "-p", "no:cacheprovider", "-p", "no:xdist")
    told = run(
        "-m",
        "pytest",
        *plain,
        "-c",
        str(EXAMPLE / "pyproject.toml"),
        str(EXAMPLE / "tests"),
        path=site,
        cwd=tmp_path,
    )
    assert re.search(r"\b32 passed in", told), told


def test_on_a_slow_machine_the_contract_has_more_patience(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    limit = "from woz_tui.testing.contract_checks import PROMPT_S; print(PROMPT_S)"
    assert float(run("-c", limit, cwd=tmp_path)) == 4.0, "as in all tests of this repository"
    monkeypatch.delenv("WOZ_CONTRACT_PATIENCE")
    assert float(run("-c", limit, cwd=tmp_path)) == 0.5


def blocks() -> list[tuple[str, str]]:
    """(language, text) of every code block of the README that is not a shell session."""
    found = re.findall(r"^```(\w+)\n(.*?)^```$", README.read_text(), re.MULTILINE | re.DOTALL)
    return [(language, text) for language, text in found if language != "console"]


def test_every_block_of_the_readme_stands_in_the_example() -> None:
    files = {
        "python": [*EXAMPLE.rglob("*.py")],
        "toml": [EXAMPLE / "pyproject.toml"],
        "yaml": [*EXAMPLE.glob("*.yaml")],
    }
    shown = blocks()
    assert len(shown) >= 10
    for language, text in shown:
        assert any(text in file.read_text() for file in files[language]), text


def test_the_readme_shows_every_method_of_the_example() -> None:
    shown = "\n".join(text for _, text in blocks())
    lamp = (EXAMPLE / "woz_driver_lamp" / "lamp.py").read_text()
    for line in re.findall(r"^    (?:async )?def .*$", lamp, re.MULTILINE):
        assert line in shown, line


def test_the_readme_lists_every_common_verb() -> None:
    table = dict(re.findall(r"^\| `(\w+)` \| `(\w+)`", README.read_text(), re.MULTILINE))
    assert table == {name: main_argument(name) for name in COMMON_VERBS}
