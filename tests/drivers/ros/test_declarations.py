"""What a robot file declares: checked at its place, filled, and read out of messages."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.ros import doctor
from woz_drivers.ros.driver import Ros
from woz_drivers.ros.message_types import MessageTypes, parse_definitions
from woz_drivers.ros.templates import TemplateError, ValuePath, fill

from tests.drivers.ros.robots import read_robot_settings, settings, simulator
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Probe, Written
from woz_tui.drivers.plugins import installed

ROOT = Path(__file__).parents[3]


def verb(text: str) -> dict[str, str]:
    """What is wrong with a file of this one verb."""
    return read_robot_settings(f"verbs:\n  {text}")[1]


@pytest.mark.parametrize(
    ("declared", "place", "names"),
    [
        (
            'say: {publish: /tts, type: std_msgs/String, message: {text: "{text}"}}',
            "verbs.say.message.text",
            ["std_msgs/String", "data"],
        ),
        (
            'say: {publish: /tts, type: std_msgs/msg/String, message: {data: "{words}"}}',
            "verbs.say.message.data",
            ["words", "{text}"],
        ),
        (
            'volume: {publish: /v, type: std_msgs/UInt8, message: {data: "{level*100}"}}',
            "verbs.volume.message.data",
            ["whole number", ":whole"],
        ),
        (
            'gaze: {publish: /h, type: geometry_msgs/Vector3, message: {z: "{yaw:radian}"}}',
            "verbs.gaze.message",
            ["radian", "rad"],
        ),
        (
            "say: {publish: /tts, service: /say, type: std_msgs/String, message: {}}",
            "verbs.say",
            ["publish", "service"],
        ),
        (
            "play: {publish: /p, type: std_msgs/Int8, message: {data: '{move}'}, "
            "values: {move: {wave: 1, bow: low}}}",
            "verbs.play.message.data",
            ["low"],
        ),
        (
            "say: {publish: /tts, type: std_msgs/String, ends: {subscribe: /t, value: state}}",
            "verbs.say.ends.value",
            ["std_msgs/Bool", "data"],
        ),
        (
            "say: {publish: /tts, type: std_msgs/String, "
            "stop: {publish: /tts, type: std_msgs/String, message: {date: ''}}}",
            "verbs.say.stop.message.date",
            ["did you mean 'data'"],
        ),
        (
            "say: {publish: /tts, type: std_msgs/String, "
            "stop: {publish: /tts, type: std_msgs/String, message: {data: 'stop {text}'}}}",
            "verbs.say.stop.message",
            ["no arguments", "text"],
        ),
        ("say: {publish: my tts, type: std_msgs/String}", "verbs.say.publish", ["/robot/tts"]),
        ("drive: {publish: /cmd_vel, type: geometry_msgs/Twist}", "verbs.drive", ["beside"]),
        ("nudge: {publish: /h, type: std_msgs/Empty}", "verbs.nudge", ["gaze"]),
    ],
)
def test_a_verb_that_cannot_work_is_found_at_its_place(
    declared: str, place: str, names: list[str]
) -> None:
    wrong = verb(declared)
    assert [*wrong] == [place]
    assert all(name in wrong[place] for name in names), wrong


@pytest.mark.parametrize(
    ("declared", "place", "names"),
    [
        ("sensors: {d: {subscribe: /s, type: sensor_msgs/Range, value: rang}}", "value", ["range"]),
        ("sensors: {d: {subscribe: /s, type: sensor_msgs/LaserScan, value: ranges}}", "value", []),
        ("sensors: {d: {subscribe: /s, type: std_msgs/Float32MultiArray, value: 'data[0deg]'}}", "value", ["angles"]),  # noqa: E501
        ("sensors: {d: {subscribe: /s, type: sensor_msgs/LaserScan, value: 'ranges[0deg:9deg]'}}", "value", []),  # noqa: E501
        ("sensors: {d: {subscribe: /s, type: sensor_msgs/LaserScan, value: min(range_min)}}", "value", ["min()"]),  # noqa: E501
        ("sensors: {d: {subscribe: /o, type: nav_msgs/Odometry, value: twist.linear.x}}", "value", ["linear"]),  # noqa: E501
        ("sensors: {d: {subscribe: /o, type: nav_msgs/Odometry, value: 'twist('}}", "value", ["path"]),  # noqa: E501
    ],
)  # fmt: skip
def test_a_sensor_that_cannot_be_read_is_found_at_its_place(
    declared: str, place: str, names: list[str]
) -> None:
    wrong = read_robot_settings(declared)[1]
    assert [*wrong] == [f"sensors.d.{place}"]
    assert all(name in wrong[f"sensors.d.{place}"] for name in names), wrong


@pytest.mark.parametrize(
    "wrong",
    [
        "drive: {speed: 3}",
        "drive: {speed: 0}",
        "drive: {turn_speed: 400}",
        "drive: {type: geometry_msgs/Twst}",
        "address: http://robot",
        "address: robot:99999",
        "ros: 3",
        "joints: {pan: [40, -40]}",
        "verbs: {pose: {publish: /j, type: std_msgs/Empty}}",
    ],
)
def test_settings_that_make_no_sense_are_refused(wrong: str) -> None:
    made, problems = read_robot_settings(wrong)
    assert made is None
    assert problems


def test_a_stop_may_have_braces_of_its_own() -> None:
    stop = """stop: {publish: /t, type: std_msgs/String, message: {data: '{"cmd": "stop"}'}}"""
    assert verb(f"say: {{publish: /t, type: std_msgs/String, {stop}}}") == {}


def test_the_types_of_a_file_are_checked_like_the_standard_ones() -> None:
    text = 'play: {action: /g, type: a/action/Go, message: {nme: "{move}"}}'
    assert verb(text) == {}, "nobody knows the type"
    text += "\ntypes: {a/Go_Goal: {name: string}}"
    assert "did you mean 'name'" in verb(text)["verbs.play.message.nme"]


def test_a_verb_that_goes_on_after_a_stop_is_warned_of() -> None:
    of = settings("verbs: {say: {publish: /t, type: std_msgs/String, ends: {seconds: 2 s}}}")
    assert [path for path, _ in of.warnings()] == ["verbs.say"]
    own = settings("verbs: {bow: {service: /bow, type: std_srvs/Trigger}}")
    assert [path for path, _ in own.warnings()] == ["verbs.bow"]
    assert settings().warnings() == [], "a volume and a face need no stop, an action has one"


@pytest.mark.parametrize(
    ("template", "values", "message"),
    [
        ({"data": "{text}"}, {"text": "a {b}"}, {"data": "a {b}"}),
        ({"data": "<{text}>"}, {"text": "a"}, {"data": "<a>"}),
        ({"z": "{yaw:rad}", "y": "{-pitch:rad}"}, {"yaw": 180.0, "pitch": 90.0}, {"z": 3.141593, "y": -1.570796}),  # noqa: E501
        ({"z": "{yaw}", "y": "{pitch}"}, {"yaw": 1.0, "pitch": None}, {"z": 1.0}),
        ({"v": "{level*100:whole}"}, {"level": 0.256}, {"v": 26}),
        ({"t": "{seconds:duration}"}, {"seconds": 1.25}, {"t": {"secs": 1, "nsecs": 250000000}}),
        ({"n": "{joints:names}", "p": "{joints:rad}"}, {"joints": {"a": 180.0, "b": 0.0}}, {"n": ["a", "b"], "p": [3.141593, 0.0]}),  # noqa: E501
        ({"c": ["{color:red}", "{color:blue255}"]}, {"color": "#ff0080"}, {"c": [1.0, 128]}),
        ({"on": "{on}"}, {"on": True}, {"on": True}),
    ],
)  # fmt: skip
def test_a_message_is_filled_with_the_arguments(
    template: Any, values: dict[str, Any], message: Any
) -> None:
    assert fill(template, values) == message


def test_a_placeholder_that_is_none_is_refused() -> None:
    for wrong in ("{Text}", "{text", "{text:shout}", "{other}"):
        declared = f"say: {{publish: /t, type: std_msgs/String, message: {{data: '{wrong}'}}}}"
        assert len(verb(declared)) == 1


SCAN = {"ranges": [1.0, 2.0, 3.0, 0.5, None, 0.01], "range_min": 0.1, "range_max": 10.0}


@pytest.mark.parametrize(
    ("path", "message", "value"),
    [
        ("a.b", {"a": {"b": 2}}, 2),
        ("a.b", {"a": 3}, None),
        ("ranges[1]", SCAN, 2.0),
        ("ranges[9]", SCAN, None),
        ("min(ranges)", SCAN, 0.5),
        ("min(ranges[-2:2])", SCAN, 1.0),
        ("max(ranges[0:2])", SCAN, 2.0),
        ("mean(ranges[:2])", SCAN, 1.5),
        ("min(ranges[4:5])", SCAN, None),
        ("ranges[5]", SCAN, None),
        ("range", {"range": 9.0, "min_range": 0.1, "max_range": 4.0}, None),
        ("count(people)", {"people": [{}, {}]}, 2),
        ("position[name=tilt]", {"name": ["pan", "tilt"], "position": [0.1, 0.2]}, 0.2),
        ("position[name=roll]", {"name": ["pan"], "position": [0.1]}, None),
    ],
)
def test_a_value_is_found_in_a_message(path: str, message: Any, value: object) -> None:
    assert ValuePath.parse(path).of(message) == value


def scan(begins: float, person: float, count: int = 640, turn: int = 1) -> dict[str, Any]:
    """A scan all around, in degrees of its own frame: somebody at 1.2 m, walls at 4 m."""
    step = turn * math.tau / count
    at = round(math.radians(person - begins) / step) % count
    near = {(at + beside) % count for beside in range(-20, 21)}
    return {
        "angle_min": math.radians(begins),
        "angle_increment": step,
        "range_min": 0.15,
        "range_max": 12.0,
        "ranges": [1.2 if one in near else 4.0 for one in range(count)],
    }


@pytest.mark.parametrize("turn", [1, -1], ids=["to the left", "to the right"])
@pytest.mark.parametrize("begins", [-180.0, 0.0, -90.0, 37.0])
@pytest.mark.parametrize("mounted", [0.0, 90.0, -90.0, 180.0])
def test_a_direction_is_found_wherever_a_scanner_begins(
    begins: float, mounted: float, turn: int
) -> None:
    ahead = scan(begins, -mounted, turn=turn)
    nearest = {
        slice_: ValuePath.parse(f"min(ranges[{slice_}])", mounted).of(ahead)
        for slice_ in ("-15deg:15deg", "-15°:15°", "345 deg:375 deg", "30deg:150deg")
    }
    assert nearest == {
        "-15deg:15deg": 1.2,
        "-15°:15°": 1.2,
        "345 deg:375 deg": 1.2,
        "30deg:150deg": 4,
    }
    behind = scan(begins, 180.0 - mounted, turn=turn)
    assert ValuePath.parse("min(ranges[170deg:-170deg])", mounted).of(behind) == 1.2
    assert ValuePath.parse("ranges[180deg]", mounted).of(behind) == 1.2
    assert ValuePath.parse("max(ranges[-15.5deg:15.5deg])", mounted).of(behind) == 4.0
    assert ValuePath.parse("min(ranges[-180deg:180deg])", mounted).of(behind) == 1.2


def test_where_a_scanner_does_not_look_there_is_nothing() -> None:
    narrow = {**scan(-180.0, 0.0), "angle_min": -1.0, "angle_increment": 2.0 / 640}
    assert ValuePath.parse("min(ranges[-180deg:-90deg])").of(narrow) is None
    assert ValuePath.parse("ranges[90deg]").of(narrow) is None
    assert ValuePath.parse("min(ranges[0deg:1deg])").of({"ranges": [1.0, 2.0]}) is None


@pytest.mark.parametrize("value", ["min(ranges[-15deg:15])", "min(ranges[:15deg])", "ranges[deg]"])
def test_half_a_slice_by_angle_is_refused(value: str) -> None:
    with pytest.raises(TemplateError, match="-15deg:15deg"):
        ValuePath.parse(value)


def test_a_scan_that_is_counted_is_warned_of() -> None:
    """It is valid still."""
    line = "{subscribe: /scan, type: sensor_msgs/LaserScan, value: 'min(ranges[-15:15])'}"
    warnings = dict(settings(f"sensors: {{ahead: {line}}}").warnings())
    assert "min(ranges[-15deg:15deg])" in warnings["sensors.ahead.value"]
    assert not dict(settings().warnings()).get("sensors.ahead.value")


def test_definitions_of_a_robot_are_understood() -> None:
    text = """# A comment
Header header
int8 GOOD = 1
float64[3] data  # three
string<=20 name "none"
Point[] points
builtin_interfaces/Time stamp
================
MSG: std_msgs/Header
time stamp
================
MSG: shapes/Point
float64 x 0.5
"""
    types = MessageTypes(1, {})
    for name, fields in parse_definitions("shapes/msg/Line", text).items():
        types.learn(name, fields)
    assert types.fields("shapes/Line") == {
        "header": "std_msgs/Header",
        "data": "float64[3]",
        "name": "string",
        "points": "shapes/Point[]",
        "stamp": "time",
    }
    assert types.fields("shapes/msg/Point") == {"x": "float64"}


@pytest.mark.parametrize("name", ["turtlebot", "qtrobot", "tiago"])
def test_the_profiles_are_right(name: str, tmp_path: Path) -> None:
    robot = ROOT / "experiments" / "robots" / f"{name}.yaml"
    file = tmp_path / "experiment.yaml"
    actions = "[{key: h, label: H, say: Hello}]"
    file.write_text(f"title: T\nrobot: {robot}\npanels: [{{title: P, actions: {actions}}}]\n")
    assert load(file, installed()).warnings == ()


@pytest.mark.parametrize("name", ["turtlebot", "qtrobot", "tiago"])
async def test_a_profile_finds_all_that_it_names_on_its_simulated_robot(name: str) -> None:
    text = (ROOT / "experiments" / "robots" / f"{name}.yaml").read_text("utf-8")
    lines = text.partition("    type: ros\n")[2].splitlines()
    of = settings("\n".join(line.removeprefix("    ") for line in lines))
    async with simulator(of) as robot:
        findings = await doctor.examine(Probe(name, replace(of, address=robot.address)))
    assert [one for one in findings if one.level in ("warning", "error")] == []


def test_the_examples_of_the_manual_are_right() -> None:
    page = (ROOT / "docs" / "how-to" / "ros.md").read_text("utf-8")
    blocks = re.findall(r"^```yaml\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    inner = [block.partition("    type: ros\n")[2] or block for block in blocks]
    inner = ["\n".join(line.removeprefix("    ") for line in one.splitlines()) for one in inner]
    assert len(inner) == 3
    verbs, sensors, drive = (settings(one) for one in inner)
    assert [*verbs.verbs] == ["say", "play", "gaze", "lift"]
    assert [*sensors.sensors] == ["distance", "presence", "battery", "joint.pan"]
    assert drive.drive is not None


def test_an_argument_that_the_robot_is_not_told_is_warned_of() -> None:
    of = settings()
    written = Written("emotion", {"emotion": "happy", "intensity": 0.3}, Path())
    assert [finding.subject for finding in Ros.remarks(of, written)] == ["intensity"]
    written = Written("emotion", {"emotion": "happy", "intensity": 1.0}, Path())
    assert [*Ros.remarks(of, written)] == []
