"""`at:` in robot files: a driver whose hardware is at another computer of the robot."""

from __future__ import annotations

from pathlib import Path

import pytest

from woz_tui.config.experiment import DriverPlace
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load, load_robot
from woz_tui.config.reload_changes import compare
from woz_tui.drivers.plugins import installed


def _read(tmp_path: Path, text: str) -> list[DriverPlace | None]:
    file = tmp_path / "robot.yaml"
    file.write_text(text)
    return [spec.at for spec in load_robot(file, installed())]


def test_a_driver_is_at_another_computer(tmp_path: Path) -> None:
    assert _read(
        tmp_path,
        "drivers:\n"
        "  arm: {type: simulated, at: arm-pi}\n"
        "  face: {type: simulated, at: {name: face-pi, listen: '10.0.0.1:7448'}}\n"
        "  voice: {type: simulated}\n",
    ) == [DriverPlace("arm-pi"), DriverPlace("face-pi", "10.0.0.1:7448"), None]


@pytest.mark.parametrize(
    ("at", "told"),
    [
        ("arm/pi", "is no name of a computer"),
        ("{listen: '0.0.0.0:7447'}", "name"),
        ("{name: arm-pi, listen: 7447}", "is no address"),
        ("{name: arm-pi, listen: 'tcp://0.0.0.0:7447'}", "without certificates"),
        ("{name: arm-pi, port: 3}", "port"),
    ],
)
def test_a_wrong_place_is_told(tmp_path: Path, at: str, told: str) -> None:
    with pytest.raises(ExperimentError, match=told):
        _read(tmp_path, f"drivers: {{arm: {{type: simulated, at: {at}}}}}\n")


def test_drivers_that_hand_each_other_values_are_at_the_same_computer(tmp_path: Path) -> None:
    text = (
        "drivers:\n"
        "  body: {type: simulated, at: arm-pi}\n"
        "  led: {type: led-face, port: /dev/led, follows: body}\n"
    )
    with pytest.raises(ExperimentError, match="same `at:`"):
        _read(tmp_path, text)


def test_another_computer_is_no_change_for_a_running_session(tmp_path: Path) -> None:
    read = []
    for at in ("arm-pi", "other-pi"):
        file = tmp_path / "e.yaml"
        file.write_text(
            f"title: T\nrobot: {{drivers: {{arm: {{type: simulated, at: {at}}}}}}}\n"
            "panels: [{title: P, actions: [{key: a, label: A, say: A}]}]\n"
        )
        read.append(load(file, installed()))
    changes = compare(*read)
    assert changes.drivers
    assert "another computer" in changes.drivers[0]
