"""Looks over an engine's shoulder: is every tick one that servos may get?"""

from __future__ import annotations

import math

from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.engine_io import Tick
from woz_tui.motion.safety import LONGEST_S


class Watch:
    """Sees to it that no tick of a body is what it must not be."""

    def __init__(self, shape: BodyShape, first: Tick) -> None:
        self._shape = shape
        self._last = first

    def check(self, tick: Tick) -> None:
        """In range, finite, no faster than allowed since the tick before, of which no more time
        counts than a process that stood still may catch up with; nothing missing.
        """
        elapsed = min(max(0.0, tick.t - self._last.t), LONGEST_S)
        assert math.isfinite(tick.t)
        assert tick.joints.keys() == self._shape.joints.keys()
        for name, joint in self._shape.joints.items():
            angle = tick.joints[name]
            assert joint.min - 1e-9 <= angle <= joint.max + 1e-9
            assert math.isfinite(tick.wanted[name])
            step = abs(angle - self._last.joints[name])
            assert step <= joint.speed * elapsed + 1e-6
        assert 0.0 <= tick.intensity <= 1.0
        assert 0.0 <= tick.brightness <= 1.0
        self._last = tick
