"""What a robot file may say about a chain of servos, and what must agree in it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Annotated

from woz_drivers.dynamixel import control_tables
from woz_tui.drivers.fields import Doc, OneOf, Port, Range, Section, Sibling
from woz_tui.motion.body_shape import pose_problems, range_problems

#: The key beside the joints' names in a keyframe.
SECONDS = "seconds"
#: Baud rates that the SDK can set.
BAUDS = (
    9600,
    57600,
    115200,
    500000,
    1000000,
    2000000,
    3000000,
    4000000,
)


@dataclass(frozen=True, slots=True)
class ServoJointSettings:
    """One servo and how its numbers become a joint's degrees.

    `degrees = direction * (raw - zero) * degrees_per_step / gear`.
    """

    id: Annotated[int, Range(0, 252), Doc("the servo's id on the wire")]
    min: Annotated[float, Range(-3600, 3600, "deg"), Doc("lowest angle of the joint")]
    max: Annotated[float, Range(-3600, 3600, "deg"), Doc("highest angle of the joint")]
    model: Annotated[str, Doc("model such as XL330-M288; empty: whatever answers")] = ""
    zero: Annotated[int | None, Doc("the servo's raw position at 0 degrees; empty: its middle")] = (
        None
    )
    direction: Annotated[int, Range(-1, 1), Doc("1, or -1 if the servo turns the other way")] = 1
    gear: Annotated[float, Range(0.01, 100), Doc("turns of the servo for one of the joint")] = 1.0
    speed: Annotated[float, Range(0.1, 3000, "deg/s"), Doc("never faster than this")] = 120.0
    acceleration: Annotated[
        float | None, Range(1, 100_000, "deg/s2"), Doc("never a harder start or stop than this")
    ] = None
    home: Annotated[float, Range(-3600, 3600, "deg"), Doc("angle of the home pose")] = 0.0
    rest: Annotated[
        float | None, Range(-3600, 3600, "deg"), Doc("angle in which it may be left alone")
    ] = None


@dataclass(frozen=True, slots=True)
class ServoSettings(Section):
    """One serial port with servos behind it."""

    port: Annotated[str, Port(), Doc("the adapter; /dev/serial/by-id/... names stay the same")]
    joints: Annotated[dict[str, ServoJointSettings], Doc("the joints by name")]
    baud: Annotated[int, Range(9600, 4_000_000), Doc("speed of the wire")] = 1_000_000
    protocol: Annotated[int, Range(1, 2), Doc("2: X series; 1: MX, RX, AX")] = 2
    torque: Annotated[bool, Doc("hold the joints from the start, before any command")] = False
    rate: Annotated[float, Range(5, 200, "Hz"), Doc("setpoints a second")] = 50.0
    profile: Annotated[
        str, OneOf(("minimum-jerk", "trapezoid")), Doc("how a joint starts and stops")
    ] = "minimum-jerk"
    pan: Annotated[str, Doc("the joint that turns the head to the left (positive)")] = ""
    tilt: Annotated[str, Doc("the joint that lowers the head (positive)")] = ""
    watchdog: Annotated[
        int, Range(0, 2540, "ms"), Doc("servos stop by themselves after such a silence; 0: never")
    ] = 500
    return_delay: Annotated[
        int | None, Range(0, 508, "us"), Doc("a servo's pause before it answers; empty: as it is")
    ] = None
    reply_timeout: Annotated[
        float | None, Range(1, 500, "ms"), Doc("wait so long for an answer; empty: by the adapter")
    ] = None
    tolerance: Annotated[
        float, Range(0.5, 45, "deg"), Doc("so near to its goal a joint has arrived")
    ] = 5.0
    rest_on_close: Annotated[bool, Doc("take the rest pose before the torque goes off")] = True
    rest_speed: Annotated[float, Range(1, 500, "deg/s"), Doc("speed towards the rest pose")] = 30.0
    temperature_warning: Annotated[float, Range(20, 100, "C"), Doc("warn above")] = 60.0
    load_warning: Annotated[float, Range(1, 200, "%"), Doc("warn above")] = 85.0
    voltage_low: Annotated[float | None, Range(0, 60, "V"), Doc("warn below")] = None
    voltage_high: Annotated[float | None, Range(0, 60, "V"), Doc("warn above")] = None
    follows: Annotated[
        str, Sibling(), Doc("the body whose setpoints the joints follow; empty: they have verbs")
    ] = ""
    poses: Annotated[dict[str, dict[str, float]], Doc("named poses: joint names and degrees")] = (
        field(default_factory=dict)
    )
    moves: Annotated[
        dict[str, list[dict[str, float]]],
        Doc("named moves: keyframes of joint names, degrees and `seconds`"),
    ] = field(default_factory=dict)

    def problems(self) -> list[tuple[str, str]]:
        """What does not fit together: pairs of a setting's path and a sentence."""
        return [
            *self._port_problems(),
            *self._joint_problems(),
            *self._id_problems(),
            *self._role_problems(),
            *self._pose_and_move_problems(),
            *self._follow_problems(),
        ]

    def _port_problems(self) -> Iterator[tuple[str, str]]:
        if not self.port.strip():
            yield "port", "is empty; name the adapter, for example /dev/serial/by-id/usb-..."
        if self.baud not in BAUDS:
            yield "baud", f"{self.baud} is none of {', '.join(map(str, BAUDS))}"
        if not self.joints:
            yield "joints", "names no joint"
        if self.watchdog and self.watchdog < control_tables.WATCHDOG_UNIT_MS:
            yield "watchdog", f"is shorter than one unit of {control_tables.WATCHDOG_UNIT_MS} ms"
        elif self.watchdog and self.watchdog < 3000.0 / self.rate:
            yield "watchdog", f"{self.watchdog} ms is less than three ticks of {self.rate:g} Hz"
        if (
            self.voltage_low is not None
            and self.voltage_high is not None
            and self.voltage_low >= self.voltage_high
        ):
            yield "voltage_low", f"{self.voltage_low:g} V is not below voltage_high"

    def _joint_problems(self) -> Iterator[tuple[str, str]]:
        for name, joint in self.joints.items():
            path = f"joints.{name}"
            if name == SECONDS:
                yield path, f"a joint cannot be called {SECONDS!r}: keyframes use that word"
            if joint.direction == 0:
                yield f"{path}.direction", "is 0; it must be 1 or -1"
            yield from range_problems(path, joint, home=joint.home, rest=joint.rest)
            yield from self._model_problems(path, joint)

    def _model_problems(self, path: str, joint: ServoJointSettings) -> Iterator[tuple[str, str]]:
        if not joint.model:
            return
        model = control_tables.by_name(joint.model)
        if model is None:
            known = ", ".join(
                entry.name
                for entry in control_tables.MODELS
                if entry.table.protocol == self.protocol
            )
            yield f"{path}.model", f"{joint.model!r} is not known; known: {known}"
        elif model.table.protocol != self.protocol:
            yield (
                f"{path}.model",
                f"{model.name} speaks protocol {model.table.protocol}, but protocol is"
                f" {self.protocol}",
            )

    def _id_problems(self) -> Iterator[tuple[str, str]]:
        owners: dict[int, str] = {}
        for name, joint in self.joints.items():
            if joint.id in owners:
                yield f"joints.{name}.id", f"{joint.id} is the id of {owners[joint.id]!r} already"
            owners.setdefault(joint.id, name)

    def _role_problems(self) -> Iterator[tuple[str, str]]:
        for role, name in (("pan", self.pan), ("tilt", self.tilt)):
            if name and name not in self.joints:
                there = ", ".join(sorted(self.joints))
                yield role, f"no joint is called {name!r}; there are {there}"
        if self.pan and self.pan == self.tilt:
            yield "tilt", f"{self.tilt!r} is the pan joint already"

    def _pose_and_move_problems(self) -> Iterator[tuple[str, str]]:
        for name, pose in self.poses.items():
            yield from pose_problems(f"poses.{name}", pose, self.joints)
        for name, frames in self.moves.items():
            path = f"moves.{name}"
            if name in self.poses:
                yield path, f"{name!r} names a pose as well; `play` could not tell them apart"
            if not frames:
                yield path, "has no keyframe"
            for index, frame in enumerate(frames):
                place = f"{path}[{index}]"
                seconds = frame.get(SECONDS)
                if seconds is None:
                    yield place, f"says no {SECONDS}"
                elif not (math.isfinite(seconds) and seconds > 0):
                    yield f"{place}.{SECONDS}", f"{seconds:g} is not a positive time"
                angles = {key: value for key, value in frame.items() if key != SECONDS}
                yield from pose_problems(place, angles, self.joints)

    def _follow_problems(self) -> Iterator[tuple[str, str]]:
        if not self.follows:
            return
        for name in ("pan", "tilt", "poses", "moves"):
            if getattr(self, name):
                yield name, f"does nothing: the joints follow {self.follows!r}, which has the verbs"
