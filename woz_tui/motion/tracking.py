"""Object tracking: the head turns to what the camera sees, and the face tells how that feels.

Every picture says where its object is from where the head was when it was taken; the two together
are a place that stays when the head moves on. So the head approaches that place, and neither the
age of a picture nor the speed of the joints makes it swing.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

from woz_tui.motion.kinematics import Chain
from woz_tui.motion.setpoints import Seen
from woz_tui.motion.shapes import BodyShape, Vector

#: Without a sighting for longer than this, in seconds, joy does not grow any more.
_GAP_S = 0.5
#: The time constant of the way home, in seconds.
_HOME_S = 0.6
#: A joint's turn that moves the gaze by less than this share counts as this much: where the head
#: looks straight down, panning turns the picture and leads nowhere.
_LEAST_EFFECT = 0.2
_UP: Vector = (0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Tracked:
    """What tracking wants at one moment: every joint, in degrees and in range; what it feels.

    An empty `emotion` (and no `intensity`) leaves the face as it is. `homing`: nothing was seen
    for so long that it has given up.
    """

    joints: Mapping[str, float]
    emotion: str = ""
    intensity: float | None = None
    homing: bool = False


class Tracker:
    """Follows one object, from `begin` on. Times are seconds of any clock that runs forward."""

    def __init__(self, shape: BodyShape, chain: Chain) -> None:
        self._shape = shape
        self._settings = shape.tracking
        self._chain = chain
        self._home = {name: joint.home for name, joint in shape.joints.items()}
        self.begin(0.0, self._home)

    def begin(self, t: float, joints: Mapping[str, float]) -> None:
        """Start at `t` from the pose `joints`, in degrees, having seen nothing yet."""
        known = {name: angle for name, angle in joints.items() if math.isfinite(angle)}
        self._wanted = self._bounded({**self._home, **known})
        self._goal = dict(self._wanted)
        self._past: deque[tuple[float, Mapping[str, float]]] = deque()
        self._frame: int | None = None
        self._t = self._sighted = t
        self._joy: float | None = None

    def step(self, t: float, seen: Seen | None, joints: Mapping[str, float]) -> Tracked:
        """What is wanted at `t`, from what the camera saw last and where the joints are now.

        A picture counts once, by its `frame`. A camera that falls silent sees nothing.
        """
        elapsed = t - self._t
        elapsed = elapsed if math.isfinite(elapsed) and elapsed > 0 else 0.0
        self._t += elapsed
        self._remember(joints)
        unseen = self._t - self._sighted
        sighting = self._sighting(seen)
        if sighting is not None:
            if self._joy is None or unseen >= self._settings.sad_after:
                self._joy = 0.0
            self._sighted, unseen = self._t, 0.0
            self._turn_to(*sighting)
        if self._joy is not None and unseen <= _GAP_S:
            self._joy = min(1.0, self._joy + elapsed / self._settings.happy_in)
        return self._tracked(unseen, elapsed)

    def _tracked(self, unseen: float, elapsed: float) -> Tracked:
        sad, home = self._settings.sad_after, self._settings.home_after
        if unseen >= home:
            self._goal = dict(self._home)
            self._approach(elapsed / _HOME_S)
            return Tracked(dict(self._wanted), "neutral", 0.0, homing=True)
        self._approach(elapsed * self._settings.gain)
        if unseen >= sad:
            return Tracked(dict(self._wanted), "sad", (unseen - sad) / (home - sad))
        if self._joy is None:
            return Tracked(dict(self._wanted))
        return Tracked(dict(self._wanted), "happy", self._joy)

    # -- seeing --------------------------------------------------------------------------------

    def _sighting(self, seen: Seen | None) -> tuple[float, float] | None:
        """Where a new picture has the object: degrees to the left and up of its middle."""
        if seen is None or seen.frame == self._frame:
            return None
        self._frame = seen.frame
        if seen.x is None or seen.y is None or not math.isfinite(seen.x + seen.y):
            return None
        across, down = self._settings.field_of_view
        return -_angle(seen.x, across), -_angle(seen.y, down)

    def _remember(self, joints: Mapping[str, float]) -> None:
        """Keep the poses of as long as a picture is old."""
        now = {
            name: joints[name] if math.isfinite(joints.get(name, math.nan)) else wanted
            for name, wanted in self._wanted.items()
        }
        self._past.append((self._t, now))
        while len(self._past) > 1 and self._past[1][0] <= self._t - self._settings.latency:
            self._past.popleft()

    # -- turning -------------------------------------------------------------------------------

    def _turn_to(self, left: float, up: float) -> None:
        """The goal is the pose of the picture, turned by what it shows."""
        pose = dict(self._past[0][1])
        for role, angle in (("pan", left), ("nod", -up)):
            effect = self._effect(role, pose)
            if effect is not None:
                for joint, share in self._shape.roles[role].items():
                    pose[joint] += share * angle / effect
        self._goal = self._bounded(pose)

    def _effect(self, role: str, pose: Mapping[str, float]) -> float | None:
        """Degrees by which the gaze turns left (pan) or down (nod) for one degree of a role.

        None if the body has no such role. In a chain this is hardly ever 1: shares need not add up,
        axes may point either way, and the head may look down while it pans.
        """
        shares = self._shape.roles.get(role)
        if not shares:
            return None
        nudged = {name: angle + shares.get(name, 0.0) for name, angle in pose.items()}
        _, gaze = self._chain.ray(pose)
        _, moved = self._chain.ray(nudged)
        left = _across(gaze)
        axis = left if role == "pan" else _cross(left, gaze)
        effect = math.degrees(sum((b - a) * c for a, b, c in zip(gaze, moved, axis, strict=True)))
        return math.copysign(max(abs(effect), _LEAST_EFFECT), effect)

    def _approach(self, time_constants: float) -> None:
        share = 1 - math.exp(-time_constants)
        for name, goal in self._goal.items():
            self._wanted[name] += share * (goal - self._wanted[name])

    def _bounded(self, pose: Mapping[str, float]) -> dict[str, float]:
        return {
            name: min(max(pose[name], joint.min), joint.max)
            for name, joint in self._shape.joints.items()
        }


def _angle(place: float, width: float) -> float:
    """The angle at which something is seen that lies at `place` (-1..1) of a flat picture."""
    edge = math.tan(math.radians(width / 2))
    return math.degrees(math.atan(min(max(place, -1.0), 1.0) * edge))


def _across(gaze: Vector) -> Vector:
    """The unit vector to the left of where the eyes look, level."""
    left = _cross(_UP, gaze)
    length = math.hypot(*left)
    if length < 1e-6:  # straight up or down
        return (0.0, 1.0, 0.0)
    return (left[0] / length, left[1] / length, left[2] / length)


def _cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
