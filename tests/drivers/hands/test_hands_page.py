"""The robot file on the page of gamepads and Stream Decks can be used as it stands."""

from __future__ import annotations

import re
import textwrap

from woz_drivers.hands.device_models import MODELS

from tools import ROOT
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed

PAGE = ROOT / "docs" / "how-to" / "hands.md"


def test_its_robot_file_is_right_in_the_demo() -> None:
    block, mouse = re.findall(r"```yaml\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    robot = textwrap.indent(textwrap.dedent(block), "  ") + textwrap.indent(mouse, "    ")
    demo = ROOT / "experiments" / "demo.yaml"
    [before, after] = re.split(r"^robot: .*\n", demo.read_text("utf-8"), flags=re.MULTILINE)
    experiment = load(demo, installed(), f"{before}robot:\n{robot}{after}".encode())
    assert [driver.name for driver in experiment.drivers] == ["robot", "pad", "deck", "mouse"]
    assert experiment.warnings == ()


def test_it_names_every_control_of_a_gamepad() -> None:
    table = PAGE.read_text("utf-8").partition("## Names of a gamepad's controls")[2]
    named = set(re.findall(r"`([a-z-]+)`", table))
    assert set(MODELS["gamepad"]) <= named


def test_it_names_every_control_of_the_other_devices() -> None:
    section = PAGE.read_text("utf-8").partition("## A 6-D mouse")[2]
    named = set(re.findall(r"`([a-z0-9-]+)`", section))
    for device in ("spacemouse", "wii-remote", "imu"):
        controls = {re.sub(r"^button-\d+$", "button-1", name) for name in MODELS[device]}
        assert controls <= named
