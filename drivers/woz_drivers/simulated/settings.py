"""The settings of the simulated robot; every one has a default."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from woz_drivers.simulated.faults import KINDS
from woz_tui.drivers.fields import Doc, OneOf, Range, Seconds, Section


@dataclass(frozen=True, slots=True)
class SimulatedJoint:
    """One joint: limits and home in degrees, speed in degrees per second."""

    low: Annotated[float, Range(-360, 360, "degrees"), Doc("lowest angle")] = -90.0
    high: Annotated[float, Range(-360, 360, "degrees"), Doc("highest angle")] = 90.0
    speed: Annotated[float, Range(1, 1000, "degrees/s"), Doc("fastest turn")] = 120.0
    home: Annotated[float, Range(-360, 360, "degrees"), Doc("angle of the home pose")] = 0.0

    def __post_init__(self) -> None:
        if not self.low <= self.home <= self.high:
            raise ValueError(
                f"low {self.low:g}, home {self.home:g} and high {self.high:g} must rise in this"
                " order"
            )


@dataclass(frozen=True, slots=True)
class ScheduledFault:
    """A break-down that comes by itself; the verb `fault` brings the same ones by hand."""

    kind: Annotated[str, OneOf(KINDS), Doc("what breaks")]
    after: Annotated[float, Seconds(), Doc("time from the start of the session")] = 0.0
    seconds: Annotated[float, Seconds(), Doc("how long it lasts")] = 5.0
    part: Annotated[str, Doc("a lane (voice, body ...) or a sensor; empty: everything")] = ""


def _joints() -> dict[str, SimulatedJoint]:
    return {
        "pan": SimulatedJoint(-90, 90, 180),
        "tilt": SimulatedJoint(-30, 40, 120),
        "hip": SimulatedJoint(-20, 30, 60),
    }


@dataclass(frozen=True, slots=True)
class SimulatedSettings(Section):
    """The robot, its pace, its visitor and its break-downs."""

    joints: Annotated[dict[str, SimulatedJoint], Doc("joints by name")] = field(
        default_factory=_joints
    )
    yaw_joint: Annotated[str, Doc("the joint that `gaze` and `nudge` turn sideways")] = "pan"
    pitch_joint: Annotated[str, Doc("the joint that `gaze` and `nudge` turn up and down")] = "tilt"
    hip_joint: Annotated[str, Doc("the joint that `hip` bends forward")] = "hip"
    hip_roll_joint: Annotated[str, Doc("the joint that `hip` bends sideways")] = "hip-roll"
    moves: Annotated[
        dict[str, float],
        Seconds(),
        Doc("further names for `play`, in seconds each"),
    ] = field(default_factory=dict)
    modes: Annotated[tuple[str, ...], Doc("what `mode` may be; the first holds at the start")] = (
        "normal",
        "demo",
        "tracking",
        "saccade",
    )
    emotions: Annotated[tuple[str, ...], Doc("what `emotion` may be")] = (
        "neutral",
        "sleepy",
        "angry",
        "sad",
        "happy",
        "amazed",
    )
    characters_per_second: Annotated[float, Range(1, 100), Doc("how fast it speaks")] = 14.0
    drive_speed: Annotated[float, Range(0.01, 5, "m/s"), Doc("how fast it drives")] = 0.3
    turn_speed: Annotated[float, Range(1, 720, "degrees/s"), Doc("how fast the base turns")] = 45.0
    voice_only: Annotated[bool, Doc("only voice and sound: another driver has the body")] = False
    torque: Annotated[bool, Doc("whether the motors are on at the start")] = True
    speed: Annotated[float, Range(0.1, 1000), Doc("speed of time: 2 is twice as fast")] = 1.0
    connect_after: Annotated[float, Seconds(), Doc("time until it is connected")] = 0.0
    visitor: Annotated[bool, Doc("whether a simulated person comes and goes")] = False
    seed: Annotated[int, Range(0, 2**31 - 1), Doc("seed of the simulated visitor")] = 7
    faults: Annotated[tuple[ScheduledFault, ...], Doc("planned faults")] = ()

    def __post_init__(self) -> None:
        if not self.modes or not self.emotions:
            raise ValueError("modes and emotions need at least one word each")

    def problems(self) -> list[tuple[str, str]]:
        """What does not fit together, as (path of the setting, what is wrong)."""
        usual = {
            **{"yaw_joint": "pan", "pitch_joint": "tilt"},
            **{"hip_joint": "hip", "hip_roll_joint": "hip-roll"},
        }
        return [
            (role, f"there is no joint {getattr(self, role)!r}")
            for role, name in usual.items()
            if getattr(self, role) not in self.joints and getattr(self, role) != name
        ]
