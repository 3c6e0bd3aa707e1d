"""The example robot files that no example experiment names, read with the drivers they are for."""

from __future__ import annotations

from pathlib import Path

import pytest

from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed

ROBOTS = Path(__file__).parents[2] / "experiments" / "robots"


@pytest.mark.parametrize("path", sorted(ROBOTS.glob("*.yaml")), ids=lambda path: path.stem)
def test_an_example_robot_is_read_without_a_warning(path: Path, tmp_path: Path) -> None:
    file = tmp_path / "e.yaml"
    file.write_text(
        f"title: T\nrobot: {path}\n"
        "panels: [{title: P, actions: [{key: a, label: A, mark: x}]}]\n"
    )
    experiment = load(file, installed())
    assert experiment.warnings == ()
    assert experiment.drivers


def test_eyepi_by_hand_plays_the_hardware_as_well(tmp_path: Path) -> None:
    experiment = (ROBOTS.parent / "eyepi.yaml").read_text(encoding="utf-8")
    assert "robot: robots/eyepi.yaml" in experiment
    file = tmp_path / "e.yaml"
    file.write_text(
        experiment.replace("robot: robots/eyepi.yaml", f"robot: {ROBOTS / 'eyepi-hardware.yaml'}"),
        encoding="utf-8",
    )
    assert load(file, installed()).warnings == ()
