"""Breathing, cross-fades, compression and smoothing of a pose, before safety limits it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from woz_tui.motion.body_shape import BodyShape, JointShape
from woz_tui.motion.easing import GlidingValue, low_pass, smooth

# -- breathing ------------------------------------------------------------------------------------
# Breathing: a sine on top of whatever pose the body wants.
#
# Near a limit the pose gives way, so that the breath stays whole: a body that leans on its limit
# still breathes, it just stands the breath's amplitude away from it.

#: How fast breath begins, stops and changes its size, 1/s: by 95 % in 0.6 s.
GLIDES = 8.0


class Breathing:
    """Counts breaths and adds them to poses; angles in degrees, rates in Hz."""

    def __init__(self, shape: BodyShape) -> None:
        self._parts = [
            (name, share, shape.joints[name].min, shape.joints[name].max)
            for name, share in shape.breathing.items()
            if share
        ]
        self._phase = 0.0
        self._size = GlidingValue(0.0, GLIDES)

    @property
    def size(self) -> float:
        """Amplitude at the moment."""
        return self._size.value

    def hold(self) -> None:
        """Be without breath at once; it comes back gently."""
        self._size = GlidingValue(0.0, GLIDES)

    def step(self, dt: float, rate: float, amplitude: float) -> None:
        """Go on for `dt` seconds; `amplitude` is 0 for one who does not breathe."""
        self._phase = (self._phase + dt * rate) % 1.0
        self._size.step(amplitude, dt)

    def on(self, pose: Mapping[str, float]) -> dict[str, float]:
        """The pose with the breath of this moment."""
        result = dict(pose)
        size = self._size.value
        if size <= 0.0:
            return result
        wave = math.sin(2.0 * math.pi * self._phase)
        for name, share, low, high in self._parts:
            reach = min(abs(share) * size, (high - low) / 2.0)
            middle = min(high - reach, max(low + reach, pose[name]))
            result[name] = middle + math.copysign(reach, share) * wave
        return result


# --------------------------------------------------------------------------------------------------


class CrossFade:
    """Leads from what was to what is: the difference at the change dies away.

    So a change in the middle of a change needs no memory of who was there before, and nothing can
    jump however often minds are changed.
    """

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._offsets: dict[str, tuple[float, float]] = {}  # joint -> degrees, seconds since then

    def clear(self) -> None:
        """Nothing is left of what was."""
        self._offsets.clear()

    def begin(
        self, was: Mapping[str, float], now: Mapping[str, float], joints: Iterable[str]
    ) -> None:
        """Lead `joints` over from `was` to `now`; the others go on at once."""
        named = set(joints)
        for joint, angle in now.items():
            self._offsets.pop(joint, None)
            offset = was[joint] - angle
            if joint in named and self._seconds > 0.0 and abs(offset) > 1e-9:
                self._offsets[joint] = (offset, 0.0)

    def add(self, joint: str, offset: float) -> None:
        """Lead one more joint over, which stands `offset` degrees beside where it shall be."""
        if self._seconds > 0.0:
            self._offsets[joint] = (offset, 0.0)

    def more(self, joint: str, offset: float) -> None:
        """What is wanted of a joint has moved away by `-offset` degrees, on top of what is left."""
        left, since = self._offsets.get(joint, (0.0, 0.0))
        if left:
            left *= 1.0 - smooth(since / self._seconds)
        self.add(joint, left + offset)

    def over(self, pose: Mapping[str, float], dt: float) -> dict[str, float]:
        """The pose `dt` seconds later, with what is left of the past."""
        result = dict(pose)
        for joint, (offset, since) in list(self._offsets.items()):
            share = (since + dt) / self._seconds
            if share >= 1.0:
                del self._offsets[joint]
                continue
            self._offsets[joint] = (offset, since + dt)
            result[joint] += offset * (1.0 - smooth(share))
        return result


class PoseFilter:
    """Compression about the middle of each range, then smoothing, which keeps its own state."""

    def __init__(self, joints: Mapping[str, JointShape], pose: Mapping[str, float]) -> None:
        self._joints = joints
        self._middles = {name: (joint.min + joint.max) / 2.0 for name, joint in joints.items()}
        self._compression = 0.0
        self.smoothed = dict(pose)

    def restart(self, pose: Mapping[str, float]) -> None:
        """Go on from this pose (as it comes out)."""
        self.smoothed.update(pose)

    def undo(self, joint: str, angle: float) -> float:
        """What has to go in so that `angle` comes out in the end, as far as there is such."""
        left = 1.0 - self._compression
        if left < 1e-3:
            return self._middles[joint]
        middle = self._middles[joint]
        return self._joints[joint].within(middle + (angle - middle) / left)

    def step(
        self, pose: Mapping[str, float], compression: float, time_constant: float, dt: float
    ) -> dict[str, float]:
        """The pose that comes out; ranges are kept, whatever goes in."""
        self._compression = compression
        for name, joint in self._joints.items():
            angle = joint.within(pose[name])
            if compression:
                middle = self._middles[name]
                angle = middle + (1.0 - compression) * (angle - middle)
            self.smoothed[name] = low_pass(self.smoothed[name], angle, time_constant, dt)
        return self.smoothed
