"""ALMotion: motors, joints, breathing."""

from __future__ import annotations

import asyncio
import math
from typing import Any

from naoqi_simulator.service_table import CallRefusedError, Service, offers
from naoqi_simulator.world import SimulatedWorld, flat

#: Distances kept when nothing else was set, in metres.
ORTHOGONAL_M, TANGENTIAL_M = 0.4, 0.1
_FOR_EVER = 1e9


def _distance(method: str, metres: float) -> float:
    if metres < 0:
        raise CallRefusedError(f"ALMotion::{method}\n\tsecurity distance must not be negative")
    return metres


#: Seconds that waking up and resting take.
WAKE_S, REST_S = 2.5, 2.5


class MotionService(Service):
    """Motors, joints and breathing; driving, stopping, distances kept from obstacles."""

    name = "ALMotion"

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__()
        self._world = world
        self._body = world.body
        self.orthogonal, self.tangential = ORTHOGONAL_M, TANGENTIAL_M
        self.fall_manager = True
        self.protection = {"All": True, "Move": True, "Arms": True, "LArm": True, "RArm": True}

    @offers("wakeUp()v")
    async def wake_up(self) -> None:
        """Motors on, stand up."""
        if not self._body.awake:
            self._body.wake()
            self._body.take("StandInit", WAKE_S)
            if await self._world.going.last("posture", WAKE_S, "wakeUp"):
                self._body.posture = "Stand"

    @offers("rest()v")
    async def rest(self) -> None:
        """Go to a safe posture, motors off."""
        self._end_all()
        if self._body.awake:
            self._body.take("Crouch", REST_S)
            await self._world.going.last("posture", REST_S, "rest")
            self._body.posture = "Crouch"
        self._body.relax()

    @offers("robotIsWakeUp()b")
    def robot_is_wake_up(self) -> bool:
        """Whether the motors are on."""
        return self._body.awake

    @offers("setStiffnesses(mm)v")
    def set_stiffnesses(self, names: Any, values: Any) -> None:
        """0 to 1 for head, arms and hands; one value for all or one for each name.

        The page "Stiffness control" (naoqi/motion/control-stiffness of NAOqi 2.5) forbids a
        Pepper's lower part, and names no single joints among what may be set.
        """
        by_joint = self._pairs("setStiffnesses", names, values)
        for name in flat(names):
            if self._body.plan.stiffened is not None and name not in self._body.plan.stiffened:
                raise CallRefusedError(
                    f"ALMotion::setStiffnesses\n\t{name} is not allowed on {self._body.plan.robot}"
                )
        for joint, stiffness in by_joint.items():
            self._body.stiffness[joint] = min(1.0, max(0.0, float(stiffness)))

    @offers("getStiffnesses(m)[f]")
    def get_stiffnesses(self, names: Any) -> list[float]:
        """0 to 1 for each joint."""
        return [self._body.stiffness[one] for one in self._joints("getStiffnesses", names)]

    @offers("getAngles(mb)[f]")
    def get_angles(self, names: Any, _sensors: bool) -> list[float]:
        """Radians for each joint."""
        return [self._body.angle(one) for one in self._joints("getAngles", names)]

    @offers("getBodyNames(s)[s]")
    def get_body_names(self, name: str) -> list[str]:
        """The joints of a chain."""
        return self._joints("getBodyNames", name)

    @offers("getLimits(s)m")
    def get_limits(self, name: str) -> list[list[float]]:
        """Lowest, highest angle (rad), highest speed (rad/s), highest torque (not simulated: 0)."""
        return [[*self._body.plan.joints[one], 0.0] for one in self._joints("getLimits", name)]

    @offers("setAngles(mmf)v")
    def set_angles(self, names: Any, angles: Any, fraction: float) -> None:
        """Let joints go there; returns at once. Angles out of range are clipped."""
        if not 0 < fraction <= 1:
            raise CallRefusedError("ALMotion::setAngles\n\tfractionMaxSpeed must be within ]0, 1]")
        for joint, angle in self._pairs("setAngles", names, angles).items():
            seconds = self._body.seconds_to({joint: float(angle)}, fraction)
            self._body.move_joint(joint, float(angle), seconds)

    @offers("changeAngles(mmf)v")
    def change_angles(self, names: Any, changes: Any, fraction: float) -> None:
        """As setAngles, from where the joints are."""
        by_joint = self._pairs("changeAngles", names, changes)
        angles = [self._body.angle(joint) + float(by) for joint, by in by_joint.items()]
        self.set_angles(list(by_joint), angles, fraction)

    @offers("angleInterpolation(mmmb)v")
    async def angle_interpolation(
        self, names: Any, angles: Any, times: Any, absolute: bool
    ) -> None:
        """Move joints through angles (rad) at times (s); returns when it is over."""
        courses = self._courses(flat(names), flat(angles), flat(times))
        await asyncio.gather(*(self._follow(*course, absolute) for course in courses))

    def _courses(
        self, names: list[Any], angles: list[Any], times: list[Any]
    ) -> list[tuple[str, list[float], list[float]]]:
        joints = self._joints("angleInterpolation", names)
        if len(joints) == 1 and not isinstance(angles[0], list | tuple):
            # One joint takes a plain list of its own.
            angles, times = [angles], [times if not isinstance(times[0], list) else times[0]]
        if not len(joints) == len(angles) == len(times):
            raise CallRefusedError(
                "ALMotion::angleInterpolation\n\tlists do not have the same size"
            )
        courses = [
            (joint, [float(one) for one in flat(turns)], [float(one) for one in flat(when)])
            for joint, turns, when in zip(joints, angles, times, strict=True)
        ]
        for joint, turns, when in courses:
            rising = all(a < b for a, b in zip([0.0, *when], when, strict=False))
            if len(turns) != len(when) or not rising:
                raise CallRefusedError(
                    f"ALMotion::angleInterpolation\n\t{joint}: times must be positive and rise,"
                    " one for each angle"
                )
        return courses

    async def _follow(
        self, joint: str, angles: list[float], times: list[float], absolute: bool
    ) -> None:
        start, passed = self._body.angle(joint), 0.0
        for angle, when in zip(angles, times, strict=True):
            self._body.move_joint(joint, angle if absolute else start + angle, when - passed)
            if not await self._world.going.last("joints", when - passed, joint):
                return
            passed = when

    @offers("angleInterpolationWithSpeed(mmf)v")
    async def angle_interpolation_with_speed(
        self, names: Any, angles: Any, fraction: float
    ) -> None:
        """Move joints at a fraction of their full speed; returns when it is over."""
        by_joint = self._pairs("angleInterpolationWithSpeed", names, angles)
        targets = {joint: float(angle) for joint, angle in by_joint.items()}
        if not 0 < fraction <= 1:
            raise CallRefusedError(
                "ALMotion::angleInterpolationWithSpeed\n\tspeed must be within ]0, 1]"
            )
        seconds = self._body.seconds_to(targets, fraction)
        for joint, angle in targets.items():
            self._body.move_joint(joint, angle, seconds)
        await self._world.going.last("joints", seconds, ",".join(targets))

    @offers("setBreathEnabled(sb)v")
    def set_breath_enabled(self, chain: str, on: bool) -> None:
        """Body, Legs, Arms, LArm, RArm or Head."""
        for one in self._breathing("setBreathEnabled", chain):
            self._body.breathing[one] = on

    @offers("getBreathEnabled(s)b")
    def get_breath_enabled(self, chain: str) -> bool:
        """Whether all of the chain breathes."""
        chains = self._breathing("getBreathEnabled", chain)
        return all(self._body.breathing[one] for one in chains)

    def _breathing(self, method: str, chain: str) -> tuple[str, ...]:
        if chain not in self._body.plan.breathing:
            raise CallRefusedError(f"ALMotion::{method}\n\t{chain} is not a valid chain name")
        return self._body.plan.breathing[chain]

    def _joints(self, method: str, names: Any) -> list[str]:
        try:
            return [joint for name in flat(names) for joint in self._body.plan.expand(str(name))]
        except KeyError as error:
            raise CallRefusedError(
                f"ALMotion::{method}\n\tunknown joint name {error.args[0]}"
            ) from None

    def _pairs(self, method: str, names: Any, values: Any) -> dict[str, Any]:
        joints, flat_values = self._joints(method, names), flat(values)
        if len(flat_values) == 1:
            flat_values = flat_values * len(joints)
        if len(flat_values) != len(joints):
            raise CallRefusedError(f"ALMotion::{method}\n\tlists do not have the same size")
        return dict(zip(joints, flat_values, strict=True))

    def _end_all(self) -> None:
        """End every movement that a client asked for."""
        self._world.going.end("move", "joints", "posture", "animation")
        self._body.halt()
        self._body.hold()

    # -- the base

    @offers("moveTo(fff)b")
    async def move_to(self, x: float, y: float, turn: float) -> bool:
        """Drive by x, y (m) and turn (rad); False if it did not get there."""
        if self._world.faults.active("says-no") or not self._stands():
            return False
        self._world.going.end("move")
        m_s, rad_s = self._body.plan.speed
        seconds = max(math.hypot(x, y) / m_s, abs(turn) / rad_s)
        share = self._free(x, y)
        if seconds <= 0 or share <= 0:
            return share > 0
        self._body.drive(x / seconds, y / seconds, turn / seconds, seconds * share)
        arrived = await self._world.going.last("move", seconds * share, "moveTo")
        if arrived or not (self._world.going.of("move") or self._body.plan.step_s):
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
        if self._stands() and not self._world.faults.active("says-no"):
            self._world.going.end("move")
            self._body.drive(x, y, turn, _FOR_EVER)

    @offers("moveToward(fff)v")
    async def move_toward(self, x: float, y: float, turn: float) -> None:
        """As move, in shares of the full speed."""
        for share in (x, y, turn):
            if not -1 <= share <= 1:
                raise CallRefusedError("ALMotion::moveToward\n\tvelocities must be within [-1, 1]")
        m_s, rad_s = self._body.plan.speed
        await self.move(x * m_s, y * m_s, turn * rad_s)

    def _stands(self) -> bool:
        """Whether it can go: awake, and on its feet."""
        walks = self._body.plan.walks
        return self._body.awake and not (walks and self._body.family != "Standing")

    @offers("moveIsActive()b")
    def move_is_active(self) -> bool:
        """Whether the base is on its way."""
        return any(self._body.velocity())

    @offers("stopMove()v")
    def stop_move(self) -> None:
        """The base stops; joints and animations go on. Who walks takes the step to its end."""
        self._world.going.end("move")
        if self._body.plan.step_s and self.move_is_active():
            self._body.last_step(self._body.plan.step_s)
        else:
            self._body.halt()

    @offers("killMove()v")
    def kill_move(self) -> None:
        """As stopMove, less gently: who walks loses its balance."""
        walks = self._body.plan.walks and self.move_is_active()
        self._world.going.end("move")
        self._body.halt()
        if walks:
            self._world.falls.fall()

    @offers("killAll()v")
    def kill_all(self) -> None:
        """All movements end where they are; who walks loses its balance."""
        self.kill_move()
        self._end_all()

    @offers("killTasksUsingResources([s])v")
    def kill_tasks_using_resources(self, resources: list[str]) -> None:
        """End what moves these joints or chains; animations and postures move all of them."""
        joints = set(self._joints("killTasksUsingResources", resources))
        for span in self._world.going.of("joints", "posture", "animation"):
            if span.kind != "joints" or joints & set(span.about.split(",")):
                self._world.going.end(span.kind, about=span.about)
        self._body.hold(joints)
        if self._body.plan.walks and joints & set(self._body.plan.chains["Legs"]):
            self.kill_move()

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

    @offers("setFallManagerEnabled(b)v")
    def set_fall_manager_enabled(self, on: bool) -> None:
        """Whether it protects itself when it falls, and tells of it."""
        self.fall_manager = on

    @offers("getFallManagerEnabled()b")
    def get_fall_manager_enabled(self) -> bool:
        """On, unless it was switched off."""
        return self.fall_manager

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
