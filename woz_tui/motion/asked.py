"""The arguments of an input, read one by one and trusted in nothing.

The bus checks what comes through it, but scripts, panels and tests speak to an engine directly;
whatever they say, the outcome is a value that can be used or `Refused`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from woz_tui.core.messages import Json
from woz_tui.motion.shapes import JointShape
from woz_tui.motion.ticks import Refused

#: No movement may take longer than a day, in seconds.
LONGEST_S = 86_400.0
#: No more poses in one input than this.
MOST_POSES = 1000


def finite(value: object) -> float | None:
    """`value` as a finite number, or None if it is none (a flag is no number)."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def quoted(value: object) -> str:
    """`value` in a sentence, shortened."""
    try:
        text = repr(value)
    except Exception as error:  # noqa: BLE001 - a stranger's __repr__ or a number of 5000 digits
        text = f"<{type(value).__name__}: {type(error).__name__}>"
    return text if len(text) <= 60 else f"{text[:57]}..."


@dataclass(frozen=True, slots=True)
class Angles:
    """Joint angles that can be used, in degrees, and what differs from those asked for.

    `clamped` holds, by joint, the angle that was asked for; `left_out` why a joint is not moved.
    """

    joints: dict[str, float]
    clamped: dict[str, Json]
    left_out: dict[str, Json]

    def told(self) -> dict[str, Json]:
        """For an answer, as the servos' driver tells it."""
        sent: dict[str, Json] = {"joints": {k: round(v, 3) for k, v in self.joints.items()}}
        if self.clamped:
            sent["clamped"] = dict(self.clamped)
        if self.left_out:
            sent["left_out"] = dict(self.left_out)
        return sent


class Asked:
    """The arguments of one input of the verb `verb`; `takes` are the names it knows."""

    def __init__(self, verb: str, args: object, takes: Sequence[str]) -> None:
        if not isinstance(args, Mapping):
            raise Refused(f"{verb}: arguments are names and values, not {quoted(args)}")
        for name in args:
            if name not in takes:
                known = ", ".join(takes) or "no arguments"
                raise Refused(f"{verb} has no argument {quoted(name)}", f"it takes {known}")
        self._verb = verb
        self._args = args

    def given(self, name: str) -> bool:
        """Whether there is anything of this name."""
        return self._args.get(name) is not None

    def number(self, name: str, default: float | None = None) -> float:
        """A finite number. Without it, `default`, or `Refused` if there is none."""
        value = self._args.get(name)
        if value is None:
            if default is None:
                raise Refused(f"{self._verb} needs {name!r}")
            return default
        number = finite(value)
        if number is None:
            raise Refused(f"{self._verb}.{name} must be a finite number, not {quoted(value)}")
        return number

    def within(self, name: str, low: float, high: float, default: float | None = None) -> float:
        """A number between `low` and `high`; outside them it is refused."""
        number = self.number(name, default)
        if not low <= number <= high:
            raise Refused(f"{self._verb}.{name} must be {low:g} to {high:g}, not {number:g}")
        return number

    def seconds(self) -> float:
        """In how long; 0, the soonest, if it is missing, not a number or not above 0."""
        value = self._args.get("seconds")
        if value is None or (isinstance(value, float) and math.isnan(value)):
            return 0.0
        return soonest(self._verb, value)

    def choice(self, name: str, choices: Sequence[str], default: str | None = None) -> str:
        """One of `choices`."""
        value = self._args.get(name)
        if value is None and default is not None:
            return default
        if not isinstance(value, str) or value not in choices:
            raise Refused(
                f"{self._verb}.{name} cannot be {quoted(value)}",
                f"there are {', '.join(choice for choice in choices if choice) or 'none'}",
            )
        return value

    def flag(self, name: str) -> bool:
        """True or false."""
        value = self._args.get(name)
        if not isinstance(value, bool):
            raise Refused(f"{self._verb}.{name} must be true or false, not {quoted(value)}")
        return value

    def joints(self, shapes: Mapping[str, JointShape]) -> Angles:
        """Angles by joint, clamped to the joints' ranges."""
        return angles(f"{self._verb}.joints", self._args.get("joints"), shapes)

    def poses(self, shapes: Mapping[str, JointShape]) -> list[tuple[Angles, float]]:
        """Poses with the seconds each may take."""
        value = self._args.get("poses")
        if not isinstance(value, list | tuple) or not 0 < len(value) <= MOST_POSES:
            raise Refused(
                f"{self._verb}.poses must be a list of poses, not {quoted(value)}",
                f"1 to {MOST_POSES} of them, each with joints and seconds",
            )
        return [_pose(f"{self._verb}.poses[{i}]", pose, shapes) for i, pose in enumerate(value)]


def soonest(path: str, value: object) -> float:
    """Seconds that a movement may take; 0 for those below 0."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return 0.0
    number = finite(value)
    if number is None or number > LONGEST_S:
        raise Refused(
            f"{path}: {quoted(value)} is no time for a movement", f"at most {LONGEST_S:g} s"
        )
    return max(0.0, number)


def angles(path: str, value: object, shapes: Mapping[str, JointShape]) -> Angles:
    """What can be used of a mapping joint -> degrees; `Refused` if that is nothing."""
    if not isinstance(value, Mapping) or not value:
        raise Refused(f"{path} must name joints and degrees, not {quoted(value)}")
    taken = Angles({}, {}, {})
    for name, wish in value.items():
        shape = shapes.get(name) if isinstance(name, str) else None
        number = finite(wish)
        if shape is None:
            taken.left_out[str(name)[:60]] = "no such joint"
        elif number is None:
            taken.left_out[name] = f"not an angle: {quoted(wish)}"
        else:
            angle = min(shape.max, max(shape.min, number))
            taken.joints[name] = angle
            if angle != number:
                taken.clamped[name] = number
    if not taken.joints:
        reasons = "; ".join(f"{name}: {why}" for name, why in list(taken.left_out.items())[:3])
        raise Refused(f"{path} moves nothing ({reasons})", f"joints are {', '.join(shapes)}")
    return taken


def _pose(path: str, value: object, shapes: Mapping[str, JointShape]) -> tuple[Angles, float]:
    if not isinstance(value, Mapping):
        raise Refused(f"{path} must be a pose: joints and seconds, not {quoted(value)}")
    for name in value:
        if name not in ("joints", "seconds"):
            raise Refused(f"{path} has no {quoted(name)}", "a pose has joints and seconds")
    return angles(path, value.get("joints"), shapes), soonest(path, value.get("seconds"))
