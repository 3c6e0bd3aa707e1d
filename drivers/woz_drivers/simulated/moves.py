"""The gestures that `play` knows, as poses at fractions of their duration."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from woz_drivers.simulated.settings import Settings


@dataclass(frozen=True, slots=True)
class Move:
    """A gesture. `keys` are (fraction of the duration, degrees from home by role of the joint).

    The roles are yaw, pitch and hip; a robot without such a joint leaves it out.
    """

    seconds: float
    keys: tuple[tuple[float, Mapping[str, float]], ...] = ()


_HOME = {"yaw": 0.0, "pitch": 0.0, "hip": 0.0}

MOVES: Mapping[str, Move] = {
    "nod": Move(
        1.2,
        (
            (0.2, {"pitch": 18}),
            (0.45, {"pitch": -6}),
            (0.7, {"pitch": 14}),
            (1.0, {"pitch": 0}),
        ),
    ),
    "shake": Move(
        1.6,
        (
            (0.15, {"yaw": 22}),
            (0.4, {"yaw": -22}),
            (0.65, {"yaw": 18}),
            (0.85, {"yaw": -10}),
            (1.0, {"yaw": 0}),
        ),
    ),
    "dance": Move(
        6.0,
        (
            (0.12, {"yaw": 30, "pitch": 10, "hip": 10}),
            (0.25, {"yaw": -30, "pitch": -8, "hip": -8}),
            (0.37, {"yaw": 30, "pitch": 10, "hip": 10}),
            (0.5, {"yaw": -30, "pitch": -8, "hip": -8}),
            (0.65, {"yaw": 45, "pitch": 15, "hip": 12}),
            (0.8, {"yaw": -45, "pitch": -12, "hip": -10}),
            (0.9, {"yaw": 0, "pitch": 20, "hip": 15}),
            (1.0, _HOME),
        ),
    ),
    "wave": Move(
        2.4,
        (
            (0.2, {"yaw": 8, "hip": 6}),
            (0.4, {"yaw": -8, "hip": -6}),
            (0.6, {"yaw": 8, "hip": 6}),
            (0.8, {"yaw": -8, "hip": -6}),
            (1.0, _HOME),
        ),
    ),
    "bow": Move(
        2.6, ((0.4, {"hip": 24, "pitch": 20}), (0.6, {"hip": 24, "pitch": 20}), (1, _HOME))
    ),
    "point-left": Move(
        2.0, ((0.35, {"yaw": 50, "hip": 6}), (0.7, {"yaw": 50, "hip": 6}), (1.0, _HOME))
    ),
    "point-middle": Move(
        2.0, ((0.35, {"pitch": 14, "hip": 12}), (0.7, {"pitch": 14, "hip": 12}), (1.0, _HOME))
    ),
    "point-right": Move(
        2.0, ((0.35, {"yaw": -50, "hip": 6}), (0.7, {"yaw": -50, "hip": 6}), (1.0, _HOME))
    ),
    "look-around": Move(
        4.0,
        (
            (0.25, {"yaw": 55, "pitch": -8}),
            (0.5, {"yaw": 10, "pitch": 8}),
            (0.75, {"yaw": -55, "pitch": -8}),
            (1.0, _HOME),
        ),
    ),
}


def known(settings: Settings) -> dict[str, Move]:
    """Our gestures, and those that the robot file adds: these take their time and move nothing."""
    return dict(MOVES) | {name: Move(seconds) for name, seconds in settings.moves.items()}


def roles(settings: Settings) -> dict[str, str]:
    """Role of a joint -> its name, for those the robot has."""
    wanted = {
        "yaw": settings.yaw_joint,
        "pitch": settings.pitch_joint,
        "hip": settings.hip_joint,
        "roll": settings.hip_roll_joint,
    }
    return {role: name for role, name in wanted.items() if name in settings.joints}
