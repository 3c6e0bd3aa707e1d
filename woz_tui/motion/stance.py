"""The pose that people want: one angle for each joint, and the zoom on top of them.

It is what the joint controls and every gaze and pose write, what moves are played around, and
where the body returns to when a mode ends.
"""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.motion.safety import number
from woz_tui.motion.shapes import BodyShape, JointShape


class Stance:
    """The pose wanted, in degrees.

    `zoom` moves several joints together by shares of one angle; when the first of them reaches
    its limit the others stop too, so that they always move as one.
    """

    def __init__(self, shape: BodyShape, pose: Mapping[str, float]) -> None:
        self._joints = shape.joints
        self._shares = {name: share for name, share in shape.zoom.items() if share}
        #: The zoom's whole way to one side: half of the narrowest joint's range.
        self._reach = min(
            (
                (self._joints[name].max - self._joints[name].min) / 2 / abs(share)
                for name, share in self._shares.items()
            ),
            default=0.0,
        )
        self._base = {name: within(joint, pose[name]) for name, joint in self._joints.items()}
        self._zoom = 0.0
        self._pose = dict(self._base)

    @property
    def pose(self) -> Mapping[str, float]:
        """Every joint's angle. Do not change it."""
        return self._pose

    @property
    def zoom(self) -> float:
        """Place of the zoom's control, 0..1; the middle is none."""
        return (self._zoom + 1.0) / 2.0

    def place(self, joint: str) -> float:
        """Place of a joint's own control, 0 (its lowest angle) to 1."""
        shape = self._joints[joint]
        return (self._base[joint] - shape.min) / (shape.max - shape.min)

    def turn(self, joint: str, place: float) -> None:
        """Move a joint's own control."""
        shape = self._joints[joint]
        self._base[joint] = within(shape, shape.min + place * (shape.max - shape.min))
        self._settle()

    def turn_zoom(self, place: float) -> None:
        """Move the zoom's control."""
        self._zoom = 2.0 * place - 1.0
        self._settle()

    def take(self, angles: Mapping[str, float]) -> None:
        """Want these angles, zoom included; it gives way where it would not fit."""
        pose = {**self._pose, **angles}
        zoom = self._zoom if not self._shares else self._effective()
        low, high = self._room(pose, -1.0)
        self._zoom = min(high, max(low, zoom))
        for name, angle in pose.items():
            own = angle - self._zoom * self._reach * self._shares.get(name, 0.0)
            self._base[name] = within(self._joints[name], own)
        self._settle()

    def _settle(self) -> None:
        zoom = self._effective() * self._reach
        self._pose = {
            name: within(shape, self._base[name] + zoom * self._shares.get(name, 0.0))
            for name, shape in self._joints.items()
        }

    def _effective(self) -> float:
        """The zoom as far as every joint can follow it."""
        low, high = self._room(self._base, 1.0)
        return min(high, max(low, self._zoom))

    def _room(self, pose: Mapping[str, float], sign: float) -> tuple[float, float]:
        """Zooms, -1..1, that keep `pose + sign * zoom` inside all ranges; always about 0."""
        low, high = -1.0, 1.0
        for name, share in self._shares.items():
            shape, step = self._joints[name], sign * share * self._reach
            ends = ((shape.min - pose[name]) / step, (shape.max - pose[name]) / step)
            low, high = max(low, min(ends)), min(high, max(ends))
        return min(0.0, low), max(0.0, high)


def within(shape: JointShape, angle: float) -> float:
    """`angle` inside a joint's range."""
    return min(shape.max, max(shape.min, angle))


def found(shape: BodyShape, present: Mapping[str, float] | None) -> dict[str, float]:
    """Where the joints are, as far as that is known: those of the body, finite angles only."""
    angles = {name: number(angle) for name, angle in (present or {}).items()}
    return {name: a for name, a in angles.items() if name in shape.joints and a is not None}


def beginning(shape: BodyShape, present: Mapping[str, float] | None = None) -> dict[str, float]:
    """The pose to begin with: where the joints are, as far as that is known, else their start."""
    known = found(shape, present)
    return {
        name: within(joint, known.get(name, joint.home if joint.start is None else joint.start))
        for name, joint in shape.joints.items()
    }
