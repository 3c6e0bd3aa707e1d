"""The robot file on the page of gamepads and Stream Decks can be used as it stands."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

from woz_drivers.hands.device_models import MODELS

from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "hands.md"


def test_its_robot_file_is_right(tmp_path: Path) -> None:
    [block] = re.findall(r"```yaml\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    robot = textwrap.indent(textwrap.dedent(block), "  ")
    actions = "{key: h, label: Hello, say: Hello}, {key: f13, label: Pedal, say: Pedal}"
    (tmp_path / "it.yaml").write_text(
        f"title: it\nrobot:\n{robot}\nscript: [Hello]\n"
        f"panels:\n  - title: P\n    actions: [{actions}]\n"
    )
    found = load(tmp_path / "it.yaml", installed())
    assert [driver.name for driver in found.drivers] == ["robot", "pad", "deck"]
    assert found.warnings == ()


def test_it_names_every_control_of_a_gamepad() -> None:
    table = PAGE.read_text("utf-8").partition("## Names of a gamepad's controls")[2]
    named = set(re.findall(r"`([a-z-]+)`", table))
    assert set(MODELS["gamepad"]) <= named
