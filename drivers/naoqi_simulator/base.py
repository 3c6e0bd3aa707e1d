"""ALMotion, the base: driving, stopping, distances kept from obstacles."""

from __future__ import annotations

import math
from typing import Any

from naoqi_simulator.motion import JointsService
from naoqi_simulator.service_table import CallRefusedError, offers
from naoqi_simulator.world import SimulatedWorld

#: NAOqi's own figures for MaxVelXY (m/s) and MaxVelTheta (rad/s) on Pepper, when nothing is set.
SPEED_M_S, SPEED_RAD_S = 0.35, 1.0
#: Distances kept when nothing else was set, in metres.
ORTHOGONAL_M, TANGENTIAL_M = 0.4, 0.1
_FOR_EVER = 1e9


class MotionService(JointsService):
    """All of ALMotion."""

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__(world)
        self.orthogonal, self.tangential = ORTHOGONAL_M, TANGENTIAL_M
        self.protection = {"All": True, "Move": True, "Arms": True, "LArm": True, "RArm": True}

    @offers("moveTo(fff)b")
    async def move_to(self, x: float, y: float, turn: float) -> bool:
        """Drive by x, y (m) and turn (rad); False if it did not get there."""
        if self._world.faults.there("says-no") or not self._body.awake:
            return False
        self._world.going.end("move")
        seconds = max(math.hypot(x, y) / SPEED_M_S, abs(turn) / SPEED_RAD_S)
        share = self._free(x, y)
        if seconds <= 0 or share <= 0:
            return share > 0
        self._body.drive(x / seconds, y / seconds, turn / seconds, seconds * share)
        arrived = await self._world.going.last("move", seconds * share, "moveTo")
        if arrived or not self._world.going.of("move"):
            self._body.halt()
        return arrived and share >= 1

    @offers("moveTo(ffff)b")
    async def move_to_with_time(self, x: float, y: float, turn: float, _time: float) -> bool:
        """As moveTo(fff); Pepper does not use the time."""
        return await self.move_to(x, y, turn)

    @offers("moveTo(fffm)b")
    async def move_to_with_config(self, x: float, y: float, turn: float, _config: Any) -> bool:
        """As moveTo(fff); the configuration is not simulated."""
        return await self.move_to(x, y, turn)

    @offers("move(fff)v")
    async def move(self, x: float, y: float, turn: float) -> None:
        """Drive with these speeds (m/s, m/s, rad/s) until stopped."""
        if self._body.awake and not self._world.faults.there("says-no"):
            self._world.going.end("move")
            self._body.drive(x, y, turn, _FOR_EVER)

    @offers("moveToward(fff)v")
    async def move_toward(self, x: float, y: float, turn: float) -> None:
        """As move, in shares of the full speed."""
        for share in (x, y, turn):
            if not -1 <= share <= 1:
                raise CallRefusedError("ALMotion::moveToward\n\tvelocities must be within [-1, 1]")
        await self.move(x * SPEED_M_S, y * SPEED_M_S, turn * SPEED_RAD_S)

    @offers("moveIsActive()b")
    def move_is_active(self) -> bool:
        """Whether the base is on its way."""
        return any(self._body.velocity())

    @offers("stopMove()v")
    def stop_move(self) -> None:
        """The base stops; joints and animations go on."""
        self._world.going.end("move")
        self._body.halt()

    @offers("killMove()v")
    def kill_move(self) -> None:
        """As stopMove, less gently."""
        self.stop_move()

    @offers("killAll()v")
    def kill_all(self) -> None:
        """All movements end where they are."""
        self._end_all()

    @offers("killTasksUsingResources([s])v")
    def kill_tasks_using_resources(self, resources: list[str]) -> None:
        """End what moves these joints or chains; animations and postures move all of them."""
        joints = set(self._joints("killTasksUsingResources", resources))
        for span in self._world.going.of("joints", "posture", "animation"):
            if span.kind != "joints" or joints & set(span.about.split(",")):
                self._world.going.end(span.kind, about=span.about)
        self._body.hold(joints)

    @offers("waitUntilMoveIsFinished()v")
    async def wait_until_move_is_finished(self) -> None:
        """Return when the base stands."""
        while self.move_is_active():
            await self._world.time.sleep(0.05)

    @offers("getRobotVelocity()[f]")
    def get_robot_velocity(self) -> list[float]:
        """m/s, m/s, rad/s."""
        return list(self._body.velocity())

    @offers("getRobotPosition(b)[f]")
    def get_robot_position(self, _sensors: bool) -> list[float]:
        """m, m, rad from where it was switched on."""
        return list(self._body.pose())

    @offers("setOrthogonalSecurityDistance(f)v")
    def set_orthogonal(self, metres: float) -> None:
        """Distance kept from what it drives towards."""
        self.orthogonal = _distance("setOrthogonalSecurityDistance", metres)

    @offers("getOrthogonalSecurityDistance()f")
    def get_orthogonal(self) -> float:
        """In metres."""
        return self.orthogonal

    @offers("setTangentialSecurityDistance(f)v")
    def set_tangential(self, metres: float) -> None:
        """Distance kept from what it drives along."""
        self.tangential = _distance("setTangentialSecurityDistance", metres)

    @offers("getTangentialSecurityDistance()f")
    def get_tangential(self) -> float:
        """In metres."""
        return self.tangential

    @offers("setExternalCollisionProtectionEnabled(sb)v")
    def set_protection(self, name: str, on: bool) -> None:
        """All, Move, Arms, LArm or RArm."""
        if name not in self.protection:
            raise CallRefusedError(
                f"ALMotion::setExternalCollisionProtectionEnabled\n\t{name} is not a valid name"
            )
        for one in self.protection if name == "All" else (name,):
            self.protection[one] = on

    @offers("getExternalCollisionProtectionEnabled(s)b")
    def get_protection(self, name: str) -> bool:
        """Whether it keeps its distances."""
        if name not in self.protection:
            raise CallRefusedError(
                f"ALMotion::getExternalCollisionProtectionEnabled\n\t{name} is not a valid name"
            )
        return self.protection[name]

    def _free(self, x: float, y: float) -> float:
        """The share of the way that is free, 0 to 1."""
        if not self.protection["Move"] or (x == 0 and y == 0):
            return 1.0
        side, ahead = self._body.side, self._world.nearest()
        if side is not None and ((x != 0 and side < self.tangential) or (y != 0 and side < abs(y))):
            return 0.0
        if x <= 0 or ahead is None:
            return 1.0
        return min(1.0, max(0.0, (ahead - self.orthogonal) / x))


def _distance(method: str, metres: float) -> float:
    if metres < 0:
        raise CallRefusedError(f"ALMotion::{method}\n\tsecurity distance must not be negative")
    return metres
