"""The base: velocities ten times a second while a command lasts, and zero when it ends."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Mapping
from typing import Any

from woz_drivers.ros.declarations import TWIST_STAMPED, DriveDeclaration
from woz_drivers.ros.rosbridge import Rosbridge
from woz_tui.drivers.argument_values import number
from woz_tui.drivers.contract import DriverError, Job, RejectedError
from woz_tui.protocol.messages import Json

#: From one velocity to the next, in seconds.
PERIOD_S = 0.1
#: A robot that does not answer a ping for so long gets no velocity any more, in seconds.
_SILENT_S = 0.3
#: Slower than this it stands: metres and radians a second.
_STILL = 0.01
#: After a drive it is waited for its standing still, in seconds.
_HALT_S = 2.0
#: A drive of so many seconds is long enough to be seen by its odometry.
_SEEN_S = 1.0


class VelocityDrive:
    """Drives one command at a time."""

    def __init__(self, robot: Rosbridge, declared: DriveDeclaration) -> None:
        self._robot = robot
        self._declared = declared
        #: Whether a command drives now.
        self.moving = False
        #: How often it was stopped: a drive of before publishes nothing behind the zero of a stop.
        self._stops = 0
        #: Whether its odometry says that it stands; None until it has said anything.
        self._still: bool | None = None
        #: Whether it has said, since the present drive began, that it moves.
        self._moved = False
        self._message_came = asyncio.Event()
        robot.advertise(declared.topic, declared.type_)
        if declared.odometry:
            robot.subscribe(declared.odometry, "nav_msgs/Odometry", self._measured, PERIOD_S / 2)

    @property
    def rolls_on(self) -> bool:
        """Whether its odometry says that it moves, though no command drives."""
        return self._still is False and not self.moving

    def seconds(self, args: Mapping[str, Any]) -> float:
        """How long the distance takes at the speed of the file. Raises `RejectedError`."""
        x, y, turn = (number(args, name) for name in ("x", "y", "turn"))
        declared = self._declared
        seconds = max(math.hypot(x, y) / declared.speed, abs(turn) / declared.turn_speed)
        if seconds == 0:
            raise RejectedError("no distance and no turn is given", "give x, y or turn")
        return seconds

    async def drive(self, job: Job) -> Mapping[str, Json]:
        """Drive by time: as long as the distance takes at the speed of the file."""
        declared = self._declared
        x, y, turn = (number(job.args, name) for name in ("x", "y", "turn"))
        seconds = self.seconds(job.args)
        job.expects(seconds)
        # All three end together: what is shorter goes slower.
        velocity = self._twist(x / seconds, y / seconds, math.radians(turn) / seconds)
        loop = asyncio.get_running_loop()
        # A robot that was silent for a while must not set off when it wakes from that.
        await self._robot.alive(_SILENT_S)
        end, stops = loop.time() + seconds, self._stops
        self.moving, self._moved = True, False
        try:
            while (left := end - loop.time()) > 0:
                if self._stops != stops:
                    raise DriverError("the drive was stopped")
                await self._robot.publish(declared.topic, velocity)
                await asyncio.sleep(min(PERIOD_S, left))
                await self._robot.alive(_SILENT_S)
        except BaseException:
            # Also what froze must find a zero behind what it still has to read.
            self._robot.later(self.zero())
            raise
        finally:
            self.moving = False
        await self.zero()
        if declared.odometry:
            await self._halted()
            if not self._moved and seconds >= _SEEN_S:
                raise DriverError(
                    f"{declared.odometry} says that the base has not moved",
                    "look at its motors, its brake and its emergency stop",
                )
            job.evidence("measured" if self._moved else "reported")
        return {"x": x, "y": y, "turn": turn, "seconds": round(seconds, 3)}

    async def _halted(self) -> None:
        try:
            await self.stands(_HALT_S)
        except TimeoutError:
            topic = self._declared.odometry
            text = (
                f"{topic} does not say so"
                if self._still is None
                else f"{topic} says that it moves on"
            )
            raise DriverError(f"the drive has ended, but {text}", "look at the robot") from None

    async def zero(self) -> None:
        """Publish a velocity of zero. Raises `DeviceLostError`."""
        await self._robot.publish(self._declared.topic, self._twist(0.0, 0.0, 0.0))

    async def stop(self) -> None:
        """Brake; return when the robot has been told, and says that it stands if it can."""
        self._stops += 1
        await self.zero()
        await self._robot.wait_until_processed()
        if self._declared.odometry:
            await self.stands(_HALT_S)

    async def stands(self, within: float) -> None:
        """Return when odometry that comes from now on says that it stands. Raises TimeoutError."""
        async with asyncio.timeout(within):
            self._still = None
            while not self._still:
                self._message_came.clear()
                await self._message_came.wait()

    def lost(self) -> None:
        """The robot is gone."""
        self._still = None

    def _measured(self, odometry: Mapping[str, Any]) -> None:
        twist = odometry.get("twist")
        speed = twist.get("twist") if isinstance(twist, dict) else None
        if not isinstance(speed, dict):
            raise ValueError("odometry without a speed")
        known = {
            f"{part}.{axis}": value
            for part in ("linear", "angular")
            if isinstance(axes := speed.get(part), dict)
            for axis, value in axes.items()
            if isinstance(value, int | float)
        }
        if any(abs(value) >= _STILL for value in known.values()):
            self._still = False
        else:
            # Of a way in which it cannot move, such as up, it may know nothing.
            needed = {"linear.x", "angular.z", *(["linear.y"] if self._declared.sideways else [])}
            self._still = True if needed <= {*known} else None
        self._moved |= self._still is False
        self._message_came.set()

    def _twist(self, x: float, y: float, turn: float) -> dict[str, Json]:
        zero: dict[str, Json] = {"x": 0.0, "y": 0.0, "z": 0.0}
        twist: dict[str, Json] = {
            "linear": {**zero, "x": round(x, 4), "y": round(y, 4)},
            "angular": {**zero, "z": round(turn, 4)},
        }
        if self._declared.type_ == TWIST_STAMPED:
            # The server fills the time in.
            return {"header": {"frame_id": self._declared.frame}, "twist": twist}
        return twist
