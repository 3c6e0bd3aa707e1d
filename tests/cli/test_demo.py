"""`woz demo`: whichever robot is named, its experiment is there and takes what it begins with."""

from __future__ import annotations

import argparse
import re

import pytest

from woz_tui.cli import demo
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed


@pytest.mark.parametrize("robot", demo.DEMOS)
def test_a_demo_can_begin_as_it_would(robot: str) -> None:
    name, condition, participant = demo.DEMOS[robot]
    file = demo.demo_file(name)
    assert file is not None
    experiment = load(file, installed())
    if experiment.study.design is not None:  # who comes, and what they get, is asked at the start
        assert (condition, participant) == ("", "")
        return
    assert condition in (experiment.conditions or ("",))
    assert re.fullmatch(experiment.participant_pattern, participant)


def test_the_robot_is_chosen_on_the_command_line(capsys: pytest.CaptureFixture[str]) -> None:
    parser = argparse.ArgumentParser()
    demo.add(parser)
    assert parser.parse_args([]).robot == "simulated"
    assert parser.parse_args(["--robot", "eyepi"]).robot == "eyepi"
    with pytest.raises(SystemExit):
        parser.parse_args(["--robot", "hal"])
    assert "eyepi" in capsys.readouterr().err


def test_an_example_that_is_not_installed_is_none() -> None:
    assert demo.demo_file("nowhere.yaml") is None
