"""`woz demo`: whichever robot is named, its experiment is there and takes what it begins with."""

from __future__ import annotations

import argparse
import re

import pytest

from woz_tui.cli import demo
from woz_tui.config.bundled_files import bundled_file, robot_files
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed


@pytest.mark.parametrize("robot", demo.DEMOS)
def test_a_demo_can_begin_as_it_would(robot: str) -> None:
    name, condition, participant = demo.DEMOS[robot]
    file = bundled_file(name)
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
    assert demo.run(parser.parse_args(["--robot", "eyepy"])) == 2
    assert "did you mean 'eyepi'?" in capsys.readouterr().err
    assert demo.run(parser.parse_args(["--robot", "xyz"])) == 2
    assert {"simulated", "ros"} <= {*re.split(r"[ ,\n]+", capsys.readouterr().err)}
    assert re.search(r"\bros\b", parser.format_help())


@pytest.mark.parametrize("robot", [*robot_files(None)])
@pytest.mark.parametrize("name", ["demo.yaml", "interview.yaml"])
def test_the_same_file_runs_on_every_robot(name: str, robot: str) -> None:
    file = bundled_file(name)
    assert file is not None
    own, other = load(file, installed()), load(file, installed(), robot=robot)
    for before in (action for panel in own.panels for action in panel.actions):
        after = other.action(before.name)
        assert after is not None
        done = [call.verb for call in after.calls]
        left_out = [each.what for each in after.left_out if "." not in each.what]
        assert sorted({*done, *left_out}) == sorted({call.verb for call in before.calls})


def test_a_camera_is_for_the_demo_of_the_engagement_model(
    capsys: pytest.CaptureFixture[str],
) -> None:
    parser = argparse.ArgumentParser()
    demo.add(parser)
    assert demo.run(parser.parse_args(["--robot", "pepper", "--camera"])) == 2
    assert "--robot guide" in capsys.readouterr().err
    file = bundled_file(demo.DEMOS[demo.WITH_CAMERA][0])
    assert file is not None
    experiment = load(file, installed(), robot=demo.CAMERA)
    assert [driver.type for driver in experiment.drivers] == ["simulated", "faces"]


def test_an_example_that_is_not_installed_is_none() -> None:
    assert bundled_file("nowhere.yaml") is None
