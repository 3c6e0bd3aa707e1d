"""Following a body: its newest setpoints, as far as these servos may go along with them.

The body is one tick away at most and has bounded its setpoints already; whatever it says, the chain
bounds each one again by the servo's own limits right before it writes. A joint that begins to hold
is first brought to the body slowly; once it has met it, it goes along without any delay.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from woz_drivers.dynamixel.servo import Servo, ServoStatus
from woz_drivers.dynamixel.setpoint_planning import TargetFollower
from woz_drivers.dynamixel.settings import ServoSettings
from woz_tui.drivers.contract import DriverContext, DriverError
from woz_tui.motion.body_feeds import PRESENT, SETPOINTS, JointPositions, Setpoints
from woz_tui.motion.safety import Limits

#: Setpoints older than this are nobody's wish any more, in seconds: the joints hold.
STALE_S = 0.5
#: So near to the body's setpoint, in degrees, a joint has met it.
MET = 0.5


class BodyFollower:
    """The link to one body; belongs to the loop's thread but for what it is made with.

    Attributes:
        paused: The stop is pressed: nothing is followed.
    """

    def __init__(self, settings: ServoSettings, context: DriverContext) -> None:
        self.paused = False
        self._body = settings.follows
        self._speed = settings.rest_speed
        self._context = context
        self._setpoints = context.feed(SETPOINTS, of=settings.follows)
        self._present = context.feed(PRESENT)
        self._fresh: bool | None = None
        self._now: Setpoints | None = None

    def read_setpoints(self, now: float) -> None:
        """Take the newest setpoints; `now` is CLOCK_MONOTONIC in seconds. Says when they end."""
        newest = self._setpoints.latest().value
        fresh = isinstance(newest, Setpoints) and now - newest.t_us / 1e6 <= STALE_S
        self._now = newest if fresh and not self.paused else None
        if fresh is not self._fresh:
            if self._fresh:
                self._context.notice(
                    "warning",
                    f"{self._body} sends no setpoints any more; the joints hold their position",
                    "the log file of the robot process may have the reason",
                )
            elif self._fresh is False and fresh:
                self._context.notice(
                    "info", f"{self._body} is connected; the joints move to its pose"
                )
            self._fresh = fresh

    @property
    def still(self) -> bool:
        """Whether no fresh setpoints are there to follow."""
        return self._now is None

    @property
    def at_rest(self) -> bool | None:
        """Whether the body is where it may be left alone; None if it has not been sent there."""
        return self._now.at_rest if self._now is not None else None

    def setpoint_for(self, servo: Servo, elapsed: float) -> float:
        """Where the body wants the joint now; where it stands if the body says nothing."""
        target = self._target(servo)
        if target is None:
            servo.hold()  # whoever speaks next is met slowly
            return servo.setpoint
        if servo.met:
            return target
        if servo.follow is None:
            limits = servo.limits
            slow = Limits(
                limits.low, limits.high, min(self._speed, limits.speed), limits.acceleration
            )
            servo.follow = TargetFollower(slow, target)
        servo.follow.target = target
        moved = servo.follow.step(servo.setpoint, elapsed)
        if abs(moved - target) <= MET:
            servo.follow, servo.met = None, True
        return moved

    def _target(self, servo: Servo) -> float | None:
        wanted = self._now.joints.get(servo.name) if self._now is not None else None
        if wanted is None or not math.isfinite(wanted):
            return None
        return servo.limits.clamp(wanted)

    def zero(self, joint: str) -> float:
        """What the body adds to this joint's angles on their way here, in degrees."""
        newest = self._setpoints.latest().value
        return newest.zeros.get(joint, 0.0) if isinstance(newest, Setpoints) else 0.0

    def publish_lost(self, joints: Iterable[str], lost: DriverError, now: float) -> None:
        """Let the body know that no joint can be reached."""
        unable = dict.fromkeys(joints, (lost.what, lost.remedy))
        self._present.put(JointPositions(round(now * 1e6), {}, unable=unable))

    def publish_positions(self, servos: Iterable[Servo], now: float) -> None:
        """Let the body know where its joints are, which of them are held, and which cannot move.

        Of one that is not where it can be believed to be, it hears nothing.
        """
        known = list(servos)
        obstacles = {servo.name: servo.obstacle for servo in known}
        ready = [
            servo
            for servo in known
            if servo.status is ServoStatus.READY
            and (servo.calibration is None or servo.calibration.stray(servo.present) is None)
        ]
        self._present.put(
            JointPositions(
                round(now * 1e6),
                {servo.name: servo.present for servo in ready},
                frozenset(servo.name for servo in ready if servo.torque),
                {
                    name: (why.what, why.remedy)
                    for name, why in obstacles.items()
                    if why is not None
                },
            )
        )
