"""Breathing: a sine on top of whatever pose the body wants.

Near a limit the pose gives way, so that the breath stays whole: a body that leans on its limit
still breathes, it just stands the breath's amplitude away from it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from woz_tui.motion.gliding import Gliding
from woz_tui.motion.shapes import BodyShape

#: How fast breath begins, stops and changes its size, 1/s: by 95 % in 0.6 s.
GLIDES = 8.0


class Breath:
    """Counts breaths and adds them to poses; angles in degrees, rates in Hz."""

    def __init__(self, shape: BodyShape) -> None:
        self._parts = [
            (name, share, shape.joints[name].min, shape.joints[name].max)
            for name, share in shape.breathing.items()
            if share
        ]
        self._phase = 0.0
        self._size = Gliding(0.0, GLIDES)

    @property
    def size(self) -> float:
        """Amplitude at the moment."""
        return self._size.value

    def hold(self) -> None:
        """Be without breath at once; it comes back gently."""
        self._size = Gliding(0.0, GLIDES)

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
