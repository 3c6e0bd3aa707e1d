"""What a robot file may say about servos, and the rules across settings."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from woz_drivers.dynamixel import DynamixelServos, Joint, Settings

from tests.drivers.servo_stand import HEAD
from woz_tui.core.driver import KINDS

GOOD = Settings(port="/dev/ttyUSB0", joints=dict(HEAD))


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
        ({"joints": {"pan": Joint(1, 10, -10)}}, "joints.pan.min", "not below max"),
        ({"joints": {"pan": Joint(1, 10, 20)}}, "joints.pan.home", "0 lies outside 10 to 20"),
        ({"joints": {"pan": Joint(1, -9, 9, rest=10)}}, "joints.pan.rest", "outside"),
        ({"joints": {"pan": Joint(1, -9, 9, direction=0)}}, "joints.pan.direction", "1 or -1"),
        ({"joints": {"pan": Joint(1, -9, 9, model="XL-99")}}, "joints.pan.model", "known: XL330"),
        ({"joints": {"pan": Joint(1, -9, 9, model="MX-28")}}, "joints.pan.model", "protocol 1"),
        ({"joints": {"a": Joint(1, -9, 9), "b": Joint(1, -9, 9)}}, "joints.b.id", "of 'a' already"),
        ({"joints": {"seconds": Joint(1, -9, 9)}}, "joints.seconds", "cannot be called"),
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
    def names(settings: Settings) -> set[str]:
        return {verb.name for verb in DynamixelServos.verbs(settings)}

    always = {"pose", "poses", "home", "torque"}
    assert names(GOOD) == {*always, "reboot"}
    assert names(replace(GOOD, protocol=1)) == always
    full = replace(GOOD, pan="pan", poses={"up": {"tilt": 1.0}})
    assert names(full) == {*always, "reboot", "play", "gaze", "nudge"}
    for verb in DynamixelServos.verbs(full):
        assert all(argument.kind in KINDS for argument in verb.arguments)
        assert verb.stream is (verb.name == "gaze")


def test_sensors_name_every_joint() -> None:
    sensors = DynamixelServos.sensors(GOOD)
    assert len(sensors) == len(set(sensors)) == 5 * len(HEAD)
    assert {"joint.pan", "setpoint.roll", "temperature.tilt"} <= set(sensors)
