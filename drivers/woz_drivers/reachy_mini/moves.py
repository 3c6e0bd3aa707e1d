"""Moves and emotions of the driver's own, and where recorded ones are.

The daemon's emotions are a data set that the robot downloads, and a robot in a laboratory's network
may never have been able to. These need nothing but the robot.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from woz_drivers.reachy_mini.pose import HOME, Pose
from woz_tui.drivers.contract import RejectedError

#: The vendor's data sets, by the names that this driver gives them.
LIBRARIES: Mapping[str, str] = {
    "dances": "pollen-robotics/reachy-mini-dances-library",
    "emotions": "pollen-robotics/reachy-mini-emotions-library",
}


def data_set_and_name(move: str) -> tuple[str, str]:
    """Where a recorded move is: `dances/NAME`, `emotions/NAME` or `OWNER/DATA-SET/NAME`.

    Raises `RejectedError`.
    """
    parts = move.split("/")
    if all(parts):
        match parts:
            case [library, name] if library in LIBRARIES:
                return LIBRARIES[library], name
            case [owner, data_set, name]:
                return f"{owner}/{data_set}", name
    raise RejectedError(
        f"{move!r} is no recorded move",
        "write dances/NAME, emotions/NAME or OWNER/DATA-SET/NAME",
    )


@dataclass(frozen=True, slots=True)
class PoseFrame:
    """A pose that is reached after `seconds`, as differences from another one: degrees, mm."""

    seconds: float
    joints: Pose

    def after(self, base: Pose, amplitude: float) -> dict[str, float]:
        """The pose, with `base` as the other one; 1 is as written."""
        return {name: base[name] + amplitude * by for name, by in self.joints.items()}


def _swing(joint: str, seconds: float, *places: float) -> tuple[PoseFrame, ...]:
    return tuple(PoseFrame(seconds, {joint: place}) for place in places)


def _both(outwards: float) -> dict[str, float]:
    return {"left-antenna": outwards, "right-antenna": outwards}


_BACK: Pose = dict.fromkeys(HOME, 0.0)


def _point(side: float) -> tuple[PoseFrame, ...]:
    there = {"pan": 50.0 * side, "body": 25.0 * abs(side) * side, "forward": 15.0, "tilt": 4.0}
    antenna = "right-antenna" if side < 0 else "left-antenna"
    nods = [PoseFrame(0.25, {**there, "tilt": tilt, antenna: 60.0}) for tilt in (14.0, 2.0, 10.0)]
    return (PoseFrame(0.8, {**there, antenna: 60.0}), *nods, PoseFrame(0.9, _BACK))


_SWAYS = tuple(
    PoseFrame(0.45, {"body": 20 * side, "roll": 14 * side, "lift": lift, antenna: 60, other: 0})
    for side, lift, antenna, other in (
        (1, 10, "left-antenna", "right-antenna"),
        (0, -14, "right-antenna", "left-antenna"),
        (-1, 10, "right-antenna", "left-antenna"),
        (0, -14, "left-antenna", "right-antenna"),
    )
)

#: Moves by name; each begins and ends at the pose that was held before.
MOVES: Mapping[str, Sequence[PoseFrame]] = {
    "nod": _swing("tilt", 0.28, 16, -4, 14, 0),
    "shake": (*_swing("pan", 0.3, 20, -20, 16), PoseFrame(0.35, {"pan": 0})),
    "wave": (
        PoseFrame(0.4, {"roll": 10, "right-antenna": 70, "lift": 5}),
        *_swing("right-antenna", 0.22, 20, 70, 20, 70),
        PoseFrame(0.5, _BACK),
    ),
    "bow": (
        PoseFrame(0.9, {"tilt": 26, "forward": 15, "lift": -15, **_both(35)}),
        PoseFrame(0.5, {"tilt": 26, "forward": 15, "lift": -15, **_both(35)}),
        PoseFrame(0.9, _BACK),
    ),
    "dance": (*_SWAYS * 3, PoseFrame(0.7, _BACK)),
    "look-around": (
        PoseFrame(1.1, {"pan": 45, "tilt": -6}),
        PoseFrame(0.6, {"pan": 45, "tilt": -6}),
        PoseFrame(1.6, {"pan": -45, "tilt": -4}),
        PoseFrame(0.6, {"pan": -45, "tilt": -4}),
        PoseFrame(1.1, _BACK),
    ),
    "point-left": _point(1),
    "point-middle": _point(0),
    "point-right": _point(-1),
}

# -- emotions --------------------------------------------------------------------------------------
# An emotion leaves alone where the robot looks: pan, body and, but for its gesture, tilt.


def _shows(
    seconds: float,
    *gesture: Pose,
    lift: float = 0,
    roll: float = 0,
    out: float = 0,
    forward: float = 0,
) -> tuple[PoseFrame, ...]:
    """A gesture of some frames, then the posture that stays; differences from home."""
    posture = {
        "lift": lift,
        "roll": roll,
        "forward": forward,
        "side": 0.0,
        "tilt": 0.0,
        **_both(out),
    }
    frames = [PoseFrame(seconds, {**posture, **frame}) for frame in gesture]
    return (*frames, PoseFrame(seconds, posture))


#: Frames by emotion; the last one is kept. `tilt` counts from where it looks, the rest from home.
EMOTIONS: Mapping[str, Sequence[PoseFrame]] = {
    "neutral": _shows(0.6),
    "happy": _shows(0.25, _both(45), _both(0), _both(45), _both(0), lift=10, roll=6, out=25),
    "friendly": _shows(0.5, {"tilt": 8}, roll=12, lift=4, out=20),
    "amazed": _shows(0.3, {"tilt": -12, "lift": 14}, lift=12, out=-10, forward=-6),
    "sad": _shows(0.9, {"tilt": 18}, lift=-22, out=110, roll=-5),
    "angry": _shows(0.25, {"tilt": 8}, {"tilt": -2}, lift=-8, out=60, forward=14),
    "sleepy": _shows(1.4, {"tilt": 16}, lift=-26, out=150, roll=8),
}
