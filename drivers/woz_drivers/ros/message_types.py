"""Types of ROS messages: which fields each has, and whether a message fits its type.

The servers only log a message that does not fit and drop it; whoever sent it never hears of it. So
it is compared here before it is sent: with the types that the robot has, those that the robot file
gives, and the standard ones below, so that `woz check` can do it without a robot.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Mapping
from typing import Any

from woz_drivers.ros.laser_scans import ANGLES
from woz_drivers.ros.templates import ValuePath

#: Field by field as in the packages common_msgs of ROS 1 (noetic) and common_interfaces of ROS 2
#: (kilted). `1:` and `2:` before a field: only there.
_STANDARD = """
std_msgs/Empty:
std_msgs/Bool: bool data
std_msgs/String: string data
std_msgs/Int8: int8 data
std_msgs/Int16: int16 data
std_msgs/Int32: int32 data
std_msgs/Int64: int64 data
std_msgs/UInt8: uint8 data
std_msgs/UInt16: uint16 data
std_msgs/UInt32: uint32 data
std_msgs/Float32: float32 data
std_msgs/Float64: float64 data
std_msgs/ColorRGBA: float32 r, float32 g, float32 b, float32 a
std_msgs/Header: 1:uint32 seq, time stamp, string frame_id
std_msgs/MultiArrayDimension: string label, uint32 size, uint32 stride
std_msgs/MultiArrayLayout: std_msgs/MultiArrayDimension[] dim, uint32 data_offset
std_msgs/Float64MultiArray: std_msgs/MultiArrayLayout layout, float64[] data
std_msgs/Float32MultiArray: std_msgs/MultiArrayLayout layout, float32[] data
std_srvs/Empty_Request:
std_srvs/Empty_Response:
std_srvs/Trigger_Request:
std_srvs/Trigger_Response: bool success, string message
std_srvs/SetBool_Request: bool data
std_srvs/SetBool_Response: bool success, string message
geometry_msgs/Vector3: float64 x, float64 y, float64 z
geometry_msgs/Point: float64 x, float64 y, float64 z
geometry_msgs/PointStamped: std_msgs/Header header, geometry_msgs/Point point
geometry_msgs/Quaternion: float64 x, float64 y, float64 z, float64 w
geometry_msgs/Pose: geometry_msgs/Point position, geometry_msgs/Quaternion orientation
geometry_msgs/Pose2D: float64 x, float64 y, float64 theta
geometry_msgs/PoseStamped: std_msgs/Header header, geometry_msgs/Pose pose
geometry_msgs/PoseWithCovariance: geometry_msgs/Pose pose, float64[36] covariance
geometry_msgs/Twist: geometry_msgs/Vector3 linear, geometry_msgs/Vector3 angular
geometry_msgs/TwistStamped: std_msgs/Header header, geometry_msgs/Twist twist
geometry_msgs/TwistWithCovariance: geometry_msgs/Twist twist, float64[36] covariance
nav_msgs/Odometry: std_msgs/Header header, string child_frame_id, \
geometry_msgs/PoseWithCovariance pose, geometry_msgs/TwistWithCovariance twist
sensor_msgs/Range: std_msgs/Header header, uint8 radiation_type, float32 field_of_view, \
float32 min_range, float32 max_range, float32 range, 2:float32 variance
sensor_msgs/LaserScan: std_msgs/Header header, float32 angle_min, float32 angle_max, \
float32 angle_increment, float32 time_increment, float32 scan_time, float32 range_min, \
float32 range_max, float32[] ranges, float32[] intensities
sensor_msgs/JointState: std_msgs/Header header, string[] name, float64[] position, \
float64[] velocity, float64[] effort
sensor_msgs/BatteryState: std_msgs/Header header, float32 voltage, 2:float32 temperature, \
float32 current, float32 charge, float32 capacity, float32 design_capacity, float32 percentage, \
uint8 power_supply_status, uint8 power_supply_health, uint8 power_supply_technology, bool present, \
float32[] cell_voltage, 2:float32[] cell_temperature, string location, string serial_number
sensor_msgs/Temperature: std_msgs/Header header, float64 temperature, float64 variance
trajectory_msgs/JointTrajectoryPoint: float64[] positions, float64[] velocities, \
float64[] accelerations, float64[] effort, duration time_from_start
trajectory_msgs/JointTrajectory: std_msgs/Header header, string[] joint_names, \
trajectory_msgs/JointTrajectoryPoint[] points
actionlib_msgs/GoalID: time stamp, string id
actionlib_msgs/GoalStatus: actionlib_msgs/GoalID goal_id, uint8 status, string text
actionlib_msgs/GoalStatusArray: std_msgs/Header header, actionlib_msgs/GoalStatus[] status_list
"""

_WHOLE = {*("byte", "char", "octet")} | {
    f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)
}
_FLOATS = {"float32", "float64", "float", "double"}
_FLAGS = {"bool", "boolean"}
_TEXTS = {"string", "wstring"}
_TIMES = {"time", "duration"}
PRIMITIVES = frozenset(_WHOLE | _FLOATS | _FLAGS | _TEXTS | _TIMES)

Fields = Mapping[str, str]


def plain(name: str) -> str:
    """`std_msgs/String` for `std_msgs/msg/String`: the form without the middle word."""
    package, _, last = name.partition("/")[0], *name.rpartition("/")[1:]
    if name in ("builtin_interfaces/msg/Time", "builtin_interfaces/Time"):
        return "time"
    if name in ("builtin_interfaces/msg/Duration", "builtin_interfaces/Duration"):
        return "duration"
    return f"{package}/{last}" if "/" in name else name


def wire_name(name: str, ros: int, kind: str) -> str:
    """The name as the server wants it: ROS 2 has `msg`, `srv` or `action` in its middle."""
    package, last = plain(name).split("/")
    return f"{package}/{kind}/{last}" if ros == 2 else f"{package}/{last}"


def parse_definitions(name: str, text: str) -> dict[str, Fields]:
    """Fields of a type and of those within it, from the text of its definition, as `gendeps --cat`
    writes it and rosapi gives it.
    """
    found: dict[str, Fields] = {}
    for block in re.split(r"^=+\s*$", text, flags=re.MULTILINE):
        head = re.match(r"\s*MSG:\s*(\S+)", block)
        owner = plain(head[1]) if head else plain(name)
        fields: dict[str, str] = {}
        for line in block.splitlines():
            parts = line.partition("#")[0].split()
            if len(parts) < 2 or parts[0] == "MSG:" or "=" in "".join(parts[1:3])[:80]:
                continue
            fields[parts[1]] = _qualified(parts[0], owner)
        found[owner] = fields
    return found


def _qualified(kind: str, owner: str) -> str:
    """The type of a field in full: its own package's types are written without it."""
    base, bracket, rest = kind.partition("[")
    base = re.sub(r"<=\d+$", "", base)
    if base == "Header":
        base = "std_msgs/Header"
    base = plain(base)
    if base not in PRIMITIVES and "/" not in base:
        base = f"{owner.partition('/')[0]}/{base}"
    return base + bracket + rest


class MessageTypes:
    """All types that are known, for one version of ROS."""

    def __init__(self, ros: int, own: Mapping[str, Fields]) -> None:
        self._types: dict[str, Fields] = {}
        for line in _STANDARD.split("\n")[1:-1]:
            name, _, written = line.partition(":")
            fields = (
                field.strip().rpartition(":") for field in written.split(",") if field.strip()
            )
            self._types[name] = {
                text.split()[1]: text.split()[0]
                for version, _, text in fields
                if version in ("", str(ros))
            }
        for name, given in own.items():
            self.learn(
                name, {field: _qualified(kind, plain(name)) for field, kind in given.items()}
            )

    def learn(self, name: str, fields: Fields) -> None:
        """The robot's own word counts more than the table."""
        self._types[plain(name)] = fields

    def fields(self, name: str) -> Fields | None:
        """Fields with their types in order; None for a type that is not known."""
        return self._types.get(plain(name))

    # -- messages ------------------------------------------------------------------------------

    def misfits(self, message: Any, kind: str, path: str = "") -> Iterator[tuple[str, str]]:
        """Where a message does not fit its type: paths and sentences. Nothing for unknown types."""
        base, bracket, _ = kind.partition("[")
        if bracket:
            if not isinstance(message, list):
                # Bytes may be a text: base64.
                if not (isinstance(message, str) and base in ("uint8", "char")):
                    yield path, f"takes a list ({kind}), not {message!r}"
                return
            for at, item in enumerate(message):
                yield from self.misfits(item, base, f"{path}[{at}]")
        elif base in PRIMITIVES:
            sentence = _misfit(message, base)
            if sentence:
                yield path, sentence
        else:
            yield from self._misfits_of(message, plain(base), path)

    def _misfits_of(self, message: Any, kind: str, path: str) -> Iterator[tuple[str, str]]:
        fields = self._types.get(kind)
        if fields is None:
            return
        if not isinstance(message, dict):
            yield path, f"takes a mapping of the fields of {kind}, not {message!r}"
            return
        for name, value in message.items():
            inner = f"{path}.{name}" if path else name
            if name in fields:
                yield from self.misfits(value, fields[name], inner)
            else:
                yield inner, f"{kind} has no field {name!r}{_near(name, fields)}"

    # -- values --------------------------------------------------------------------------------

    def path_misfit(self, path: ValuePath, kind: str) -> str:
        """What is wrong with a path to a value of this type; empty if nothing, or if the type is
        not known.
        """
        found = plain(kind)
        for step in path.steps:
            base, listed, _ = found.partition("[")
            fields = self._types.get(plain(base))
            if listed:
                return f"{step['name']!r} is within a list: say which entry, such as [0]"
            if fields is None:
                return f"{base} has no field {step['name']!r}" if base in PRIMITIVES else ""
            missing = [name for name in (step["name"], step["key"]) if name and name not in fields]
            if missing:
                return f"{plain(base)} has no field {missing[0]!r}{_near(missing[0], fields)}"
            if (step["from"] or step["toward"]) and not {*ANGLES} <= {*fields}:
                return f"{plain(base)} does not say at which angles its entries are"
            found = fields[step["name"]]
            if step["at"] or step["key"] or step["toward"]:
                found = found.partition("[")[0]
        return self._end_misfit(path.function, found)

    def _end_misfit(self, function: str, kind: str) -> str:
        """What is wrong with the type at the end of a path."""
        many = "[" in kind
        if function:
            return "" if many else f"{function}() needs a list, and this is {kind}"
        if many or kind not in PRIMITIVES:
            return f"leads to {kind}, which is no single value{_near('', self._types.get(kind))}"
        return ""


def _near(name: str, fields: Fields | None) -> str:
    if fields is None:
        return ""
    near = difflib.get_close_matches(name, fields, 1)
    return f"; did you mean {near[0]!r}?" if near else f"; it has {', '.join(fields) or 'none'}"


def _misfit(value: Any, kind: str) -> str:
    """What is wrong with a value of a primitive type, as the servers judge it."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if kind in _WHOLE and isinstance(value, float):
        return f"takes a whole number ({kind}), not {value!r}: write {{name:whole}}"
    fits = {
        **dict.fromkeys(_WHOLE | _FLOATS, number),
        **dict.fromkeys(_FLAGS, isinstance(value, bool)),
        **dict.fromkeys(_TEXTS, isinstance(value, str)),
        **dict.fromkeys(_TIMES, value == "now" or _is_time(value)),
    }[kind]
    words = {"time": "{secs: 0, nsecs: 0} or now", "duration": "{name:duration}"}
    return "" if fits else f"takes {words.get(kind, kind)}, not {value!r}"


def _is_time(value: Any) -> bool:
    return isinstance(value, dict) and {*value} <= {"secs", "nsecs", "sec", "nanosec"}
