"""What a robot file may declare about a verb, a sensor and a base."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Annotated, Any

from woz_tui.drivers.fields import Doc, OneOf, Pattern, Range, Seconds
from woz_tui.protocol.markup import ABILITIES

TWIST, TWIST_STAMPED = "geometry_msgs/Twist", "geometry_msgs/TwistStamped"

_TYPE = Pattern(r"\w+(/(msg|srv|action))?/\w+", "a type such as std_msgs/String")
_MIDDLE = re.compile(r"/(?:msg|srv|action)/")
#: What is sent with these types moves a base, whether its declaration says so or not.
DRIVING_TYPES = frozenset(
    {
        *(TWIST, TWIST_STAMPED, "ackermann_msgs/AckermannDrive"),
        *("ackermann_msgs/AckermannDriveStamped", "move_base_msgs/MoveBase"),
        *(
            f"nav2_msgs/{action}"
            for action in (
                *("AssistedTeleop", "BackUp", "DockRobot", "DriveOnHeading", "FollowPath"),
                *("FollowWaypoints", "NavigateThroughPoses", "NavigateToPose", "Spin"),
                *("UndockRobot", "FollowGPSWaypoints"),
            )
        ),
    }
)
NAME = Pattern(r"/?[A-Za-z_~]\w*(/\w+)*", "a name such as /robot/tts")


@dataclass(frozen=True, slots=True)
class ArgumentDeclaration:
    """An argument of a verb of the file's own, or narrower bounds of a common verb's."""

    kind: Annotated[
        str, OneOf(("text", "number", "whole", "flag", "seconds")), Doc("what it is")
    ] = "text"
    low: Annotated[float | None, Doc("from")] = None
    high: Annotated[float | None, Doc("to")] = None
    unit: Annotated[str, Doc("unit, as the wizard reads it")] = ""
    default: Annotated[Any, Doc("without one it must be given")] = None

    @property
    def range(self) -> Range | None:
        """Its bounds, if there are any."""
        if self.low is None and self.high is None:
            return None
        return Range(self.low, self.high, self.unit)


@dataclass(frozen=True, slots=True)
class EndDeclaration:
    """How the end of a command is known. Left out: an action's result, a service's answer; what is
    only published ends at once.
    """

    seconds: Annotated[float, Seconds(), Doc("it takes so long")] = 0.0
    per_character: Annotated[
        float, Seconds(), Doc("and so much more for each character of its text")
    ] = 0.0
    subscribe: Annotated[str, Doc("the topic that says when it ends")] = ""
    type_: Annotated[str, Doc("the type of that topic")] = "std_msgs/Bool"
    value: Annotated[str, Doc("the field that says it")] = "data"
    begun: Annotated[Any, Doc("its value while it goes on; none: any")] = None
    ended: Annotated[Any, Doc("its value at the end")] = False


@dataclass(frozen=True, slots=True)
class StopDeclaration:
    """What ends a command: a message, or a call of a service."""

    publish: Annotated[str, Doc("a topic")] = ""
    service: Annotated[str, Doc("or a service")] = ""
    type_: Annotated[str, _TYPE, Doc("its type")] = "std_msgs/Empty"
    message: Annotated[dict[str, Any], Doc("the message or request")] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class VerbDeclaration:
    """What a verb sends: one of `publish`, `service` and `action`."""

    type_: Annotated[str, _TYPE, Doc("its type: std_msgs/String")]
    publish: Annotated[str, Doc("a topic")] = ""
    service: Annotated[str, Doc("or a service")] = ""
    action: Annotated[str, Doc("or an action")] = ""
    message: Annotated[
        dict[str, Any], Doc("message, request or goal; {text} stands for the argument `text`")
    ] = field(default_factory=dict)
    values: Annotated[
        dict[str, dict[str, Any]],
        Doc("by argument: the words that may be given, and what is sent for each"),
    ] = field(default_factory=dict)
    arguments: Annotated[
        dict[str, ArgumentDeclaration],
        Doc("arguments of a verb of your own, the main one first; bounds of a common verb's"),
    ] = field(default_factory=dict)
    ends: Annotated[EndDeclaration, Doc("how its end is known")] = EndDeclaration()
    stop: Annotated[StopDeclaration | None, Doc("how it is stopped; an action is cancelled")] = None
    within: Annotated[float, Seconds(0.1, 3600), Doc("it may take so long at most")] = 60.0
    success: Annotated[str, Doc("field of the answer or result; false in it means: it failed")] = (
        "success"
    )
    lane: Annotated[str, Doc("commands of one lane wait for each other")] = ""
    drives: Annotated[
        bool,
        Doc(
            "it moves the robot through the room, and ends when the wizard's line is lost;"
            " so does what sends a Twist or a goal of navigation"
        ),
    ] = False
    help: Annotated[str, Doc("what it does, in a few words")] = ""
    markup: Annotated[
        tuple[Annotated[str, OneOf(tuple(ABILITIES))], ...],
        Doc("of `say`: markup that the robot's voice can do; the rest is taken out"),
    ] = ()

    @property
    def target(self) -> str:
        """The topic, service or action."""
        return self.publish or self.service or self.action

    @property
    def is_driving(self) -> bool:
        """Whether it moves the robot through the room: as declared, or by what it sends."""
        return self.drives or _MIDDLE.sub("/", self.type_) in DRIVING_TYPES

    @property
    def is_answered(self) -> bool:
        """Whether the robot itself says that it has ended."""
        return bool(self.service or self.action or self.ends.subscribe)

    @property
    def part(self) -> str:
        """The type of what is sent: of the message, the request or the goal."""
        return self.type_ + ("_Request" if self.service else "_Goal" if self.action else "")


@dataclass(frozen=True, slots=True)
class SensorDeclaration:
    """A value of a topic's messages as a reading."""

    subscribe: Annotated[str, Doc("the topic")]
    type_: Annotated[str, _TYPE, Doc("its type")]
    value: Annotated[
        str, Doc("where it is: range, twist.twist.linear.x, min(ranges[-15deg:15deg])")
    ] = "data"
    mounted: Annotated[
        float,
        Range(-360, 360, "deg"),
        Doc("of a scan: where the scanner's zero points, to the left from the robot's front"),
    ] = 0.0
    unit: Annotated[str, Doc("unit of the reading")] = ""
    scale: Annotated[float, Doc("the value is multiplied with this: 57.2958 makes degrees")] = 1.0
    low: Annotated[float | None, Doc("what is below is no value")] = None
    high: Annotated[float | None, Doc("what is above is no value")] = None
    throttle: Annotated[float, Seconds(0, 60), Doc("at most one reading in this time")] = 0.1
    every: Annotated[
        float, Seconds(0, 3600), Doc("time between two messages of a topic that says little")
    ] = 0.0


@dataclass(frozen=True, slots=True)
class DriveDeclaration:
    """A base that drives by velocities."""

    topic: Annotated[str, Doc("where velocities are published")] = "/cmd_vel"
    type_: Annotated[str, OneOf((TWIST, TWIST_STAMPED)), Doc("type of the topic")] = TWIST
    frame: Annotated[str, Doc("frame_id of a TwistStamped")] = "base_link"
    speed: Annotated[float, Range(0.01, 1.0, "m/s"), Doc("at which it drives")] = 0.15
    turn_speed: Annotated[float, Range(1, 120, "deg/s"), Doc("at which it turns")] = 45.0
    sideways: Annotated[bool, Doc("it can drive sideways")] = False
    odometry: Annotated[
        str, Doc("topic of nav_msgs/Odometry: a stop is confirmed when it says that it stands")
    ] = ""
