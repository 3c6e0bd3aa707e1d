"""Where a body's joints and eyes are in a pose, and which pose looks at something.

A chain is described in the pose with all joints at 0 degrees, where every joint's own axes are the
robot's (x forward, y left, z up): the product of exponentials without its matrices. Angles are
degrees outside, radians inside.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import msgspec

from woz_tui.motion.body_shape import AXES, BodyShape, JointShape, Vector
from woz_tui.protocol.messages import Json

#: A gaze that misses by more than this, in degrees, is said not to reach.
REACHED_DEG = 0.1
#: A point nearer to the eyes than this, in metres, is at the head itself.
AT_HEAD_M = 0.02

#: When a search has arrived, in radians, and how many steps it may take.
_EXACT = 1e-5
_STEPS = 40
#: A step that gains less than this share of the error gains nothing; so often in a row ends it.
_GAIN, _PATIENCE = 1e-2, 2
#: The gaze is led over this at most in one step, in radians.
_STRIDE = 0.7
#: Damping (squared, in radians): where it begins, how it changes, where a search gives up.
_DAMPING, _FIRMER, _LOOSER, _STIFF = 1e-3, 8.0, 0.25, 1e4
#: Further starts of a search that got stuck: shares of each joint's range, golden-ratio steps.
_STARTS, _GOLDEN = 16, (math.sqrt(5) - 1) / 2
_ORIGIN: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class ChainJoint:
    """One joint: `about` is the number of its axis (0 x, 1 y, 2 z), `sign` the axis' direction.

    `offset` in metres from the joint before; limits and home in degrees.
    """

    name: str
    about: int
    sign: float
    offset: Vector
    low: float
    high: float
    home: float


@dataclass(frozen=True, slots=True)
class Aim:
    """A pose that looks somewhere: degrees by joint, all in range.

    `error_deg` is the angle by which the gaze misses; `reachable` whether that is next to nothing.
    If not, it is the nearest pose that was found.
    """

    joints: Mapping[str, float]
    error_deg: float
    reachable: bool


@dataclass(frozen=True, slots=True)
class _ChainPose:
    """A pose worked out: joints' places and axes in space, the eyes, where they look."""

    places: Sequence[Vector]
    axes: Sequence[Vector]
    eyes: Vector
    gaze: Vector


@dataclass(frozen=True, slots=True)
class _GazeGoal:
    """A point, or a direction that is the same from everywhere (then `point` is None)."""

    point: Vector | None
    direction: Vector = _ORIGIN

    def seen_from(self, eyes: Vector) -> tuple[Vector, float]:
        """Direction and distance; a point at the eyes themselves has the direction 0."""
        if self.point is None:
            return self.direction, math.inf
        way = _minus(self.point, eyes)
        distance = math.hypot(*way)
        if distance < AT_HEAD_M:
            return _ORIGIN, distance
        return _times(way, 1 / distance), distance


class KinematicChain:
    """The joints of a body, one on the other, and its eyes on the last."""

    def __init__(self, shape: BodyShape) -> None:
        self._set([_link(name, one) for name, one in shape.joints.items()], shape)

    @classmethod
    def of_outline(cls, outline: Json) -> KinematicChain:
        """The chain of what `body_outline` made. `ValueError` if it is nothing of the kind."""
        try:
            read = msgspec.convert(outline, _Outline)
        except msgspec.ValidationError as error:
            raise ValueError(f"no outline of a body: {error}") from error
        chain = cls.__new__(cls)
        chain._set([_link(one.name, one) for one in read.joints], read)
        return chain

    def _set(self, links: Sequence[ChainJoint], head: BodyShape | _Outline) -> None:
        self.links = tuple(links)
        self._eyes = head.eyes
        self._view = AXES[head.view]

    def points(self, angles: Mapping[str, float]) -> tuple[Vector, ...]:
        """Base, each joint from the base up, and the eyes, in metres.

        Joints that `angles` leaves out stand at 0; angles out of range are taken as they are.
        """
        stance = self._stance(self._radians(angles))
        return (_ORIGIN, *stance.places, stance.eyes)

    def ray(self, angles: Mapping[str, float]) -> tuple[Vector, Vector]:
        """Where the eyes are, in metres, and the unit vector along which they look."""
        stance = self._stance(self._radians(angles))
        return stance.eyes, stance.gaze

    def aim_at(self, target: Vector, start: Mapping[str, float]) -> Aim:
        """The pose, found from `start`, that looks at a point in metres from the base.

        `ValueError` with a sentence for what is no point, and for one at the head itself.
        """
        if not all(math.isfinite(one) and abs(one) < 1e9 for one in target):
            raise ValueError(f"{_point_text(target)} is no point in space")
        goal = _GazeGoal((float(target[0]), float(target[1]), float(target[2])))
        eyes = self._stance(self._begin(start)).eyes
        if math.dist(eyes, target) < AT_HEAD_M:
            raise ValueError(
                f"{_point_text(target)} is at the head itself; give a point at least"
                f" {AT_HEAD_M * 100:g} cm away from the eyes"
            )
        return self._search(goal, start)

    def aim_along(self, yaw: float, pitch: float, start: Mapping[str, float]) -> Aim:
        """The pose, found from `start`, that looks `yaw` degrees to the left and `pitch` degrees
        up, whatever the place of the eyes. `ValueError` for what is no angle.
        """
        if not (math.isfinite(yaw) and math.isfinite(pitch)):
            raise ValueError(f"{yaw:g} / {pitch:g} degrees is no direction")
        across, up = math.radians(yaw), math.radians(pitch)
        level = math.cos(up)
        along = (level * math.cos(across), level * math.sin(across), math.sin(up))
        return self._search(_GazeGoal(None, along), start)

    # -- forward -------------------------------------------------------------------------------

    def _radians(self, angles: Mapping[str, float]) -> list[float]:
        return [math.radians(angles.get(link.name, 0.0)) for link in self.links]

    def _stance(self, angles: Sequence[float]) -> _ChainPose:
        turned: list[Vector] = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
        place = _ORIGIN
        places, axes = [], []
        for link, angle in zip(self.links, angles, strict=True):
            place = _plus(place, _turn(turned, link.offset))
            places.append(place)
            axes.append(_times(turned[link.about], link.sign))
            _rotate(turned, link.about, link.sign * angle)
        eyes = _plus(place, _turn(turned, self._eyes))
        return _ChainPose(places, axes, eyes, _turn(turned, self._view))

    # -- inverse -------------------------------------------------------------------------------

    def _search(self, goal: _GazeGoal, start: Mapping[str, float]) -> Aim:
        best: list[float] = []
        error = math.inf
        for angles in self._starts(start):
            found, missed = self._descend(goal, angles)
            if missed < error:
                best, error = found, missed
            if error <= math.radians(REACHED_DEG):
                break
        joints = {
            link.name: min(max(math.degrees(angle), link.low), link.high)
            for link, angle in zip(self.links, best, strict=True)
        }
        missed_deg = math.degrees(error)
        return Aim(joints, missed_deg, missed_deg <= REACHED_DEG)

    def _starts(self, start: Mapping[str, float]) -> Iterator[list[float]]:
        yield self._begin(start)
        yield self._begin({})
        for turn in range(_STARTS):
            yield [
                math.radians(link.low + (link.high - link.low) * share)
                for number, link in enumerate(self.links)
                for share in [(0.5 + turn * (number + 1) * _GOLDEN) % 1.0]
            ]

    def _begin(self, start: Mapping[str, float]) -> list[float]:
        """`start` in range; home where it says nothing or no number."""
        begin = []
        for link in self.links:
            angle = start.get(link.name, link.home)
            angle = angle if math.isfinite(angle) else link.home
            begin.append(math.radians(min(max(angle, link.low), link.high)))
        return begin

    def _descend(self, goal: _GazeGoal, angles: list[float]) -> tuple[list[float], float]:
        """Damped least squares with the damping of Levenberg and Marquardt, inside the limits."""
        stance = self._stance(angles)
        error = _missed(goal, stance)
        damping, idle = _DAMPING, 0
        for _ in range(_STEPS):
            if error <= _EXACT or idle >= _PATIENCE or damping > _STIFF:
                break
            tried = self._stepped(goal, stance, angles, damping)
            there = self._stance(tried)
            missed = _missed(goal, there)
            if missed >= error:
                damping *= _FIRMER
                continue
            idle = idle + 1 if missed > error * (1 - _GAIN) else 0
            angles, stance, error = tried, there, missed
            damping = max(damping * _LOOSER, 1e-9)
        return angles, error

    def _stepped(
        self, goal: _GazeGoal, stance: _ChainPose, angles: Sequence[float], damping: float
    ) -> list[float]:
        wanted, distance = goal.seen_from(stance.eyes)
        first, second = _across(stance.gaze, wanted)
        stride = min(_angle(stance.gaze, wanted), _STRIDE)
        rates = [
            _rate(axis, _minus(stance.eyes, place), wanted, distance)
            for axis, place in zip(stance.axes, stance.places, strict=True)
        ]
        columns = [(_dot(rate, first), _dot(rate, second)) for rate in rates]
        free = list(range(len(angles)))
        while True:
            step = _least_squares([columns[one] for one in free], stride, damping)
            pushing = [
                one
                for one, by in zip(free, step, strict=True)
                if self._at_limit(one, angles[one], by)
            ]
            if not pushing:
                break
            free = [one for one in free if one not in pushing]
        tried = list(angles)
        for one, by in zip(free, step, strict=True):
            link = self.links[one]
            low, high = math.radians(link.low), math.radians(link.high)
            tried[one] = min(max(angles[one] + by, low), high)
        return tried

    def _at_limit(self, one: int, angle: float, by: float) -> bool:
        link = self.links[one]
        return (by < 0 and angle <= math.radians(link.low)) or (
            by > 0 and angle >= math.radians(link.high)
        )


def body_outline(shape: BodyShape) -> dict[str, Json]:
    """What a console needs to draw the body; `KinematicChain.of_outline` is the inverse."""
    face = shape.face
    return {
        "joints": [
            {
                "name": name,
                "axis": joint.axis,
                "offset": list(joint.offset),
                "min": joint.min,
                "max": joint.max,
                "home": joint.home,
            }
            for name, joint in shape.joints.items()
        ],
        "eyes": list(shape.eyes),
        "view": shape.view,
        "face": None if face is None else {"width": face.width, "height": face.height},
    }


_Axis = Literal["x", "-x", "y", "-y", "z", "-z"]


class _OutlineJoint(msgspec.Struct):
    """A joint of an outline."""

    name: str
    axis: _Axis
    offset: Vector
    min: float
    max: float
    home: float


class _Outline(msgspec.Struct):
    """What of an outline makes a chain."""

    joints: list[_OutlineJoint]
    eyes: Vector
    view: _Axis


def _link(name: str, joint: JointShape | _OutlineJoint) -> ChainJoint:
    direction = AXES[joint.axis]
    about = next(number for number in range(3) if direction[number])
    return ChainJoint(name, about, direction[about], joint.offset, joint.min, joint.max, joint.home)


def _point_text(point: Sequence[float]) -> str:
    return "(" + ", ".join(f"{one:g}" for one in point) + ") m"


# -- a little geometry: faster than any package for three numbers ----------------------------------


def _plus(a: Vector, b: Vector) -> Vector:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def _minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def _times(a: Vector, by: float) -> Vector:
    return (a[0] * by, a[1] * by, a[2] * by)


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _angle(a: Vector, b: Vector) -> float:
    """Between two unit vectors; exact for small angles too."""
    return math.atan2(math.hypot(*cross(a, b)), _dot(a, b))


def _turn(turned: Sequence[Vector], v: Vector) -> Vector:
    """`v` in a frame whose axes point along `turned`, seen from outside."""
    x, y, z = turned
    return (
        x[0] * v[0] + y[0] * v[1] + z[0] * v[2],
        x[1] * v[0] + y[1] * v[1] + z[1] * v[2],
        x[2] * v[0] + y[2] * v[1] + z[2] * v[2],
    )


def _rotate(turned: list[Vector], about: int, angle: float) -> None:
    """Turn a frame about its own axis number `about`."""
    one, two = (about + 1) % 3, (about + 2) % 3
    cos, sin = math.cos(angle), math.sin(angle)
    a, b = turned[one], turned[two]
    turned[one] = _plus(_times(a, cos), _times(b, sin))
    turned[two] = _minus(_times(b, cos), _times(a, sin))


def _missed(goal: _GazeGoal, stance: _ChainPose) -> float:
    """The angle between gaze and goal; a head that is in the goal itself misses it wholly."""
    wanted, _ = goal.seen_from(stance.eyes)
    return math.pi if wanted == _ORIGIN else _angle(stance.gaze, wanted)


def _across(gaze: Vector, wanted: Vector) -> tuple[Vector, Vector]:
    """Two axes across the gaze; turning about the first leads it to `wanted`."""
    axis = cross(gaze, wanted)
    if math.hypot(*axis) < 1e-9:  # straight behind, or there already: any axis will do
        flattest = min(range(3), key=lambda number: abs(gaze[number]))
        axis = cross(gaze, list(AXES.values())[2 * flattest])
    first = _times(axis, 1 / math.hypot(*axis))
    return first, cross(gaze, first)


def _rate(axis: Vector, arm: Vector, wanted: Vector, distance: float) -> Vector:
    """How the gaze turns towards the goal if a joint turns about `axis`: it turns the gaze, and by
    moving the eyes on its `arm` it moves the goal's direction too.
    """
    moved = cross(axis, arm)
    return _plus(axis, _times(cross(wanted, moved), 1 / distance))


def _least_squares(
    columns: Sequence[tuple[float, float]], stride: float, damping: float
) -> list[float]:
    """The damped step that leads the gaze by `stride` about the first axis."""
    a = damping + sum(one[0] * one[0] for one in columns)
    b = sum(one[0] * one[1] for one in columns)
    c = damping + sum(one[1] * one[1] for one in columns)
    share = stride / (a * c - b * b)
    return [share * (c * one[0] - b * one[1]) for one in columns]
