"""`process:` in robot files: which drivers run in a process of their own, and which together."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.network.installed_worker import installed_worker
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load_robot
from woz_tui.drivers.plugins import Catalogue, installed
from woz_tui.session.driver_manager import working_together


@pytest.fixture
def catalogue(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Catalogue:
    return installed_worker(tmp_path, monkeypatch)


def _read(tmp_path: Path, text: str, catalogue: Catalogue) -> list[str]:
    file = tmp_path / "robot.yaml"
    file.write_text(text)
    return [spec.process for spec in load_robot(file, catalogue)]


def test_drivers_of_others_have_a_process_of_their_own(
    tmp_path: Path, catalogue: Catalogue
) -> None:
    text = (
        "drivers:\n"
        "  arm: {type: worker}\n"
        "  leg: {type: worker, process: shared}\n"
        "  far: {type: worker, at: arm-pi}\n"
        "  body: {type: simulated}\n"
        "  base: {type: simulated, process: own}\n"
    )
    assert _read(tmp_path, text, catalogue) == ["own", "shared", "", "", "own"]


@pytest.mark.parametrize(
    ("process", "told"),
    [("mine", "write own or shared"), ("own, at: arm-pi", "take `process` or `at` away")],
)
def test_a_wrong_process_is_told(tmp_path: Path, process: str, told: str) -> None:
    text = f"drivers: {{arm: {{type: simulated, process: {process}}}}}\n"
    with pytest.raises(ExperimentError, match=told):
        _read(tmp_path, text, installed())


def test_drivers_that_share_feeds_share_a_process(tmp_path: Path, catalogue: Catalogue) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text(
        "drivers:\n"
        "  alone: {type: worker}\n"
        "  body: {type: simulated}\n"
        "  hand: {type: worker, beside: arm}\n"
        "  arm: {type: worker, beside: body}\n"
        "  far: {type: worker, at: arm-pi}\n"
    )
    groups = [
        sorted(spec.name for spec in group)
        for group in working_together(load_robot(file, catalogue))
    ]
    assert sorted(groups) == [["alone"], ["arm", "body", "hand"]]
