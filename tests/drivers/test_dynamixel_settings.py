"""What a robot file may say about servos, and the rules across settings."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.dynamixel import DynamixelServos, ServoJointSettings, ServoSettings, verbs

from tests.drivers.servo_rig import HEAD
from woz_tui.config.experiment import Experiment, ParallelCalls
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers.argument_check import ArgumentError, checked
from woz_tui.drivers.contract import KINDS
from woz_tui.protocol.messages import Json

GOOD = ServoSettings(port="/dev/ttyUSB0", joints=dict(HEAD))


def test_a_good_file_has_no_problems() -> None:
    good = replace(
        GOOD,
        pan="pan",
        tilt="tilt",
        poses={"up": {"tilt": 20.0}},
        moves={"nod": [{"tilt": 20.0, "seconds": 0.3}, {"tilt": 0.0, "seconds": 0.3}]},
    )
    assert good.problems() == []


@pytest.mark.parametrize(
    ("changes", "path", "text"),
    [
        ({"port": " "}, "port", "is empty"),
        ({"baud": 12345}, "baud", "none of"),
        ({"joints": {}}, "joints", "no joint"),
        ({"watchdog": 10}, "watchdog", "one unit"),
        ({"watchdog": 40, "rate": 50.0}, "watchdog", "three ticks"),
        ({"voltage_low": 12.0, "voltage_high": 5.0}, "voltage_low", "not below"),
        ({"joints": {"pan": ServoJointSettings(1, 10, -10)}}, "joints.pan.min", "not below max"),
        (
            {"joints": {"pan": ServoJointSettings(1, 10, 20)}},
            "joints.pan.home",
            "0 lies outside 10 to 20",
        ),
        ({"joints": {"pan": ServoJointSettings(1, -9, 9, rest=10)}}, "joints.pan.rest", "outside"),
        (
            {"joints": {"pan": ServoJointSettings(1, -9, 9, direction=0)}},
            "joints.pan.direction",
            "1 or -1",
        ),
        (
            {"joints": {"pan": ServoJointSettings(1, -9, 9, model="XL-99")}},
            "joints.pan.model",
            "known: XL330",
        ),
        (
            {"joints": {"pan": ServoJointSettings(1, -9, 9, model="MX-28")}},
            "joints.pan.model",
            "protocol 1",
        ),
        (
            {"joints": {"a": ServoJointSettings(1, -9, 9), "b": ServoJointSettings(1, -9, 9)}},
            "joints.b.id",
            "of 'a' already",
        ),
        (
            {"joints": {"seconds": ServoJointSettings(1, -9, 9)}},
            "joints.seconds",
            "cannot be called",
        ),
        ({"pan": "neck"}, "pan", "no joint is called 'neck'; there are pan, roll, tilt"),
        ({"pan": "pan", "tilt": "pan"}, "tilt", "pan joint already"),
        ({"poses": {"up": {"nose": 1.0}}}, "poses.up.nose", "no joint is called 'nose'"),
        ({"poses": {"up": {"tilt": 99.0}}}, "poses.up.tilt", "outside -40 to 30"),
        ({"moves": {"nod": []}}, "moves.nod", "no keyframe"),
        ({"moves": {"nod": [{"tilt": 1.0}]}}, "moves.nod[0]", "says no seconds"),
        ({"moves": {"nod": [{"tilt": 1.0, "seconds": 0.0}]}}, "moves.nod[0].seconds", "positive"),
        (
            {"moves": {"up": [{"tilt": 1.0, "seconds": 1.0}]}, "poses": {"up": {"tilt": 1.0}}},
            "moves.up",
            "names a pose as well",
        ),
    ],
)
def test_problems_have_a_path_and_a_reason(changes: dict[str, Any], path: str, text: str) -> None:
    found = dict(replace(GOOD, **changes).problems())
    assert path in found
    assert text in found[path]


def test_verbs_fit_the_settings() -> None:
    def names(settings: ServoSettings) -> set[str]:
        return {verb.name for verb in DynamixelServos.offer(settings).verbs}

    always = {"pose", "poses", "home", "torque"}
    assert names(GOOD) == {*always, "reboot"}
    assert names(replace(GOOD, protocol=1)) == always
    full = replace(GOOD, pan="pan", poses={"up": {"tilt": 1.0}})
    assert names(full) == {*always, "reboot", "play", "gaze", "nudge"}
    for verb in DynamixelServos.offer(full).verbs:
        assert all(argument.kind in KINDS for argument in verb.arguments)
        assert verb.stream is (verb.name == "gaze")


def test_play_scales_time_and_way_from_home() -> None:
    moves = {"nod": [{"tilt": 25.0, "seconds": 0.2}, {"tilt": 5.0, "seconds": 0.4}]}
    settings = replace(GOOD, moves=moves, poses={"up": {"tilt": -15.0}})
    frames = verbs.keyframes(settings, "play", {"move": "nod", "speed": 2.0, "amplitude": 0.5})
    # The home of tilt is 5 degrees.
    assert [(dict(f.joints), f.seconds) for f in frames] == [
        ({"tilt": 15.0}, 0.1),
        ({"tilt": 5.0}, 0.2),
    ]
    play = next(verb for verb in verbs.servo_verbs(settings) if verb.name == "play")
    (pose,) = verbs.keyframes(settings, "play", checked(play, {"move": "up"}))
    assert dict(pose.joints) == {"tilt": -15.0}
    wrongs: list[dict[str, Json]] = [
        {"speed": 0.0},
        {"speed": -1.0},
        {"amplitude": math.inf},
        {"move": 3},
    ]
    for hostile in wrongs:
        with pytest.raises(ArgumentError):
            checked(play, {"move": "nod", **hostile})


def test_sensors_name_every_joint() -> None:
    sensors = DynamixelServos.offer(GOOD).sensors
    assert len(sensors) == len(set(sensors)) == 5 * len(HEAD)
    assert {"joint.pan", "setpoint.roll", "temperature.tilt"} <= set(sensors)


EXPERIMENT = """
title: Head
robot:
  name: Head
  drivers:
    head:
      type: dynamixel
      port: /dev/serial/by-id/usb-FTDI
      baud: 57600
      joints:
        pan: {id: 11, min: -90, max: 90, model: XL330-M288, zero: 2100, direction: -1, speed: 200}
        tilt: {id: 12, min: -40, max: 30, rest: 20, acceleration: 800}
      pan: pan
      torque: on
      moves:
        nod: [{tilt: 20, seconds: 0.3}, {tilt: 0, seconds: 0.3}]
      poses: {up: {tilt: -10}}
panels:
  - title: Head
    actions:
      - {key: n, label: Nod, play: nod}
      - {key: p, label: Poses, poses: [{pan: 10, seconds: 1}, {pan: 0, seconds: 1}]}
"""


def loaded(folder: Path, text: str) -> Experiment:
    path = folder / "experiment.yaml"
    path.write_text(text)
    return load(path, {"dynamixel": DynamixelServos})


def test_a_robot_file_is_decoded_by_the_annotations(tmp_path: Path) -> None:
    spec = loaded(tmp_path, EXPERIMENT).driver("head")
    assert spec is not None
    made = spec.settings
    assert isinstance(made, ServoSettings)
    assert made.joints["pan"] == ServoJointSettings(
        id=11, min=-90, max=90, model="XL330-M288", zero=2100, direction=-1, speed=200
    )
    assert made.torque is True
    assert made.moves["nod"][1] == {"tilt": 0.0, "seconds": 0.3}


def test_poses_of_an_action_are_understood_as_the_file_gives_them(tmp_path: Path) -> None:
    experiment = loaded(tmp_path, EXPERIMENT)
    action = experiment.action("Poses")
    assert action is not None
    (step,) = action.steps
    assert isinstance(step, ParallelCalls)
    frames = verbs.keyframes(GOOD, "poses", step.calls[0].args)
    assert [(dict(frame.joints), frame.seconds) for frame in frames] == [
        ({"pan": 10.0}, 1.0),
        ({"pan": 0.0}, 1.0),
    ]


@pytest.mark.parametrize(
    ("right", "wrong", "where", "what"),
    [
        ("rest: 20", "rest: 200", "joints.tilt.rest", "outside -40 to 30"),
        ("up: {tilt", "up: {nose", "poses.up.nose", "no joint is called 'nose'"),
        ("id: 12", "id: 11", "joints.tilt.id", "11 is the id of 'pan' already"),
        ("57600", "fast", "baud", "a whole number"),
        ("play: nod", "play: nodd", "play", "nod"),
    ],
)
def test_mistakes_in_a_robot_file_are_pointed_at(
    tmp_path: Path, right: str, wrong: str, where: str, what: str
) -> None:
    with pytest.raises(ExperimentError) as failed:
        loaded(tmp_path, EXPERIMENT.replace(right, wrong))
    lines = [str(problem) for problem in failed.value.problems]
    assert any(where in line and what in line for line in lines), lines
