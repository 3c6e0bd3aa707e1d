"""Where the joints really are before servos hold them."""

from __future__ import annotations

from collections.abc import Mapping

from woz_drivers.body.settings import Settings
from woz_tui.core.driver import Outlet
from woz_tui.motion.modes import Mode
from woz_tui.motion.setpoints import PRESENT, Present, State

#: A hand has moved a limp joint when it is so many degrees from where it was last found.
MOVED = 2.0
#: Older news of the servos count no more, in seconds.
FRESH_S = 0.5
#: So long after an input the body goes by what was asked of it, in seconds.
BUSY_S = 3.0


class Joining:
    """Says when the engine must begin anew at the pose in which the servos are.

    While no joint is held, hands may move them; the engine then goes on from where they were left.
    What is asked of the body in the meantime, to rehearse it, is not disturbed.
    """

    def __init__(self, settings: Settings, outlet: Outlet) -> None:
        self._zero = {name: joint.zero for name, joint in settings.joints.items()}
        self._feed = outlet.feed(PRESENT, of=settings.servos)
        self._serial = 0
        self._found: Mapping[str, float] = {}
        self._busy_until = float("-inf")

    def touched(self, now: float) -> None:
        """Somebody has asked something of the body."""
        self._busy_until = now + BUSY_S

    def place(self, now: float, state: State) -> Mapping[str, float] | None:
        """The joints' angles, in the body's degrees, if the engine is to begin at them."""
        newest = self._feed.latest()
        present = newest.value
        if newest.serial == self._serial or not isinstance(present, Present):
            return None
        self._serial = newest.serial
        if now - present.t_us / 1e6 > FRESH_S:
            return None
        joints = {
            name: angle - self._zero[name]
            for name, angle in present.joints.items()
            if name in self._zero
        }
        busy = now < self._busy_until or state.move or state.mode != Mode.NORMAL.value
        if present.held or busy or not self._moved(joints):
            return None
        self._found = {**self._found, **joints}
        return joints

    def _moved(self, joints: Mapping[str, float]) -> bool:
        return any(
            name not in self._found or abs(angle - self._found[name]) > MOVED
            for name, angle in joints.items()
        )
