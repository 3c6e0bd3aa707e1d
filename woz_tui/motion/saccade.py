"""Saccade following: the eyes jump to where they shall look, the head comes after them.

The head is a low-pass in the space of joints towards the pose that looks there; the eyes make up
for whatever the head still lacks, so the gaze in space stays on its target all the way, and they
are back in the middle of the face when the head has arrived. Where joints end, the eyes keep the
rest, as far as they can turn.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from woz_tui.motion.easing import followed
from woz_tui.motion.kinematics import Chain
from woz_tui.motion.primaries import Moment, Wish
from woz_tui.motion.shapes import BodyShape

#: Time constant with which the head follows, in seconds.
FOLLOWS_S = 0.25
#: Where the eye position's ends (1 and -1) lie: degrees sideways, up and down, from straight
#: ahead of the pose in which the mode began.
SPAN = (60.0, 40.0)
#: No gaze goes further up or down than this, in degrees: there is no "sideways" at the zenith.
STEEPEST = 89.0


def direction(chain: Chain, joints: Mapping[str, float]) -> tuple[float, float]:
    """Where the head looks: yaw to its left, pitch upwards, in degrees."""
    _, (x, y, z) = chain.ray(joints)
    return math.degrees(math.atan2(y, x)), math.degrees(math.atan2(z, math.hypot(x, y)))


class Saccade:
    """The primary of the mode.

    Args:
        chain: Of the body.
        shape: How far the eyes may lead the head.
        pose: Where the joints are; straight ahead of it is the middle of the eye position.
        eyes: Where the eyes look on the face now; the head begins by following them.
    """

    token = 0
    name = "saccade"
    over = False
    wish: Wish | None = None

    def __init__(
        self,
        chain: Chain,
        shape: BodyShape,
        pose: Mapping[str, float],
        eyes: tuple[float, float],
    ) -> None:
        self._chain = chain
        self._lead = shape.saccade
        self._begun = dict(pose)
        self._pose = dict(pose)
        self._goal: Mapping[str, float] = self._begun
        self._ahead = direction(chain, pose)
        self._target = self._ahead
        if eyes != (0.0, 0.0):
            self._turn_to(eyes, self._lead)

    def look(self, x: float, y: float) -> None:
        """Look there, -1..1 of `SPAN`."""
        self._turn_to((x, y), SPAN)

    def step(self, moment: Moment) -> Mapping[str, float]:
        """Where the head has got to."""
        for joint, angle in self._goal.items():
            self._pose[joint] = followed(self._pose[joint], angle, FOLLOWS_S, moment.dt)
        return self._pose

    def eyes(self, joints: Mapping[str, float]) -> tuple[float, float]:
        """Where the eyes look on the face, -1..1, with the head at `joints`."""
        yaw, pitch = direction(self._chain, joints)
        across = (self._target[0] - yaw + 180.0) % 360.0 - 180.0
        return _unit(across / self._lead[0]), _unit((self._target[1] - pitch) / self._lead[1])

    def _turn_to(self, place: tuple[float, float], span: tuple[float, float]) -> None:
        yaw = (self._ahead[0] + place[0] * span[0] + 180.0) % 360.0 - 180.0
        pitch = min(STEEPEST, max(-STEEPEST, self._ahead[1] + place[1] * span[1]))
        self._target = (yaw, pitch)
        # From the pose of the beginning, so that the same place is the same pose each time.
        away = place != (0.0, 0.0)
        self._goal = self._chain.aim_along(yaw, pitch, self._begun).joints if away else self._begun


def _unit(value: float) -> float:
    return min(1.0, max(-1.0, value))
