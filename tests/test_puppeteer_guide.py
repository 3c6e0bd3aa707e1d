"""The puppeteers' guide: its files load, its commands run, its tour leaves no control out."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
import yaml

from woz_tui.cli import main
from woz_tui.config.loading import load, load_robot
from woz_tui.drivers import plugins
from woz_tui.features.profiles.section import PROFILES

ROOT = Path(__file__).parents[1]
GUIDES = {
    name: (ROOT / "docs" / name).read_text(encoding="utf-8")
    for name in ("tutorials/puppeteer.md", "how-to/render.md")
}
GUIDE = GUIDES["tutorials/puppeteer.md"]
BLOCKS = re.findall(r"```yaml\n(.*?)```", GUIDE, re.DOTALL)
COMMANDS = [
    line.partition("#")[0].partition(">")[0].strip()
    for guide in GUIDES.values()
    for block in re.findall(r"```sh\n(.*?)```", guide, re.DOTALL)
    for line in block.splitlines()
    if line.startswith("woz render") and "--inputs" not in line and "--watch" not in line
]


@pytest.mark.toolkit("G7", "R6")
def test_its_robot_and_its_experiment_load(tmp_path: Path) -> None:
    robot, experiment, servos, profiles = BLOCKS
    catalogue = plugins.installed()
    (tmp_path / "robot.yaml").write_text(robot, encoding="utf-8")
    (tmp_path / "mine.yaml").write_text(f"{experiment}\n{profiles}", encoding="utf-8")
    made = load(tmp_path / "mine.yaml", catalogue)
    assert [action.key for action in made.panels[0].actions] == ["n", "l", "h", "e", "x"]
    assert PROFILES.of(made)["child"].controls == {"neck"}
    (tmp_path / "robot.yaml").write_text(f"{robot}    servos: servos\n{servos}", encoding="utf-8")
    specs = load_robot(tmp_path / "robot.yaml", catalogue)
    assert [spec.name for spec in specs] == ["body", "servos"]


@pytest.mark.parametrize("command", COMMANDS)
def test_its_commands_run(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: str
) -> None:
    monkeypatch.chdir(ROOT)
    assert main([*shlex.split(command)[1:], "--rate", "5"]) == 0
    assert capsys.readouterr().out


@pytest.mark.toolkit("K1")
def test_the_tour_covers_every_control_that_does_something() -> None:
    text = (ROOT / "experiments/midi/nanokontrol2.yaml").read_text(encoding="utf-8")
    controls = yaml.safe_load(text)["controls"]
    tour = GUIDE.partition("## The tour")[2]
    assert [name for name in controls if f"`{name}`" not in tour] == []
    assert set(re.findall(r"`((?:knob|slider|button)-\d+)`", tour)) <= set(controls)


def test_the_keys_of_the_tour_are_those_of_the_example() -> None:
    experiment = load(ROOT / "experiments/eyepi.yaml", plugins.installed())
    keys = {action.key for panel in experiment.panels for action in panel.actions}
    builtin = {"space", ".", "escape", "ctrl+r", "arrows"}
    rows = re.findall(
        r"^\|[^|]*\|[^|]*\| ([^|]*) \|", GUIDE.partition("## The tour")[2], re.MULTILINE
    )
    named = [key for row in rows for key in re.findall(r"`([^`]+)`", row)]
    assert len(named) > 40
    assert {
        key.lower() if key.startswith("F") and key[1:] else key for key in named
    } <= keys | builtin
