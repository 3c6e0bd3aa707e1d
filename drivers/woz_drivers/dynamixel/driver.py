"""The driver: verbs in, setpoints out, by way of the loop's thread."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from woz_drivers.dynamixel import verbs
from woz_drivers.dynamixel.body_following import BodyFollower
from woz_drivers.dynamixel.chain import PROBE_S, PlannedMove, ServoChain
from woz_drivers.dynamixel.doctor import examine
from woz_drivers.dynamixel.port_loop import Action, ServoLoop
from woz_drivers.dynamixel.servo import ServoStatus
from woz_drivers.dynamixel.setpoint_planning import Keyframe, MotionPlan
from woz_drivers.dynamixel.settings import ServoSettings
from woz_tui.drivers.contract import (
    DeviceLostError,
    Driver,
    DriverContext,
    DriverError,
    DriverFacts,
    Finding,
    Job,
    Offer,
    Probe,
    RejectedError,
    Scope,
    StopReport,
)
from woz_tui.drivers.fields import Range
from woz_tui.protocol.messages import Json

#: A restarted servo answers again within about a second; after this it is reported missing.
REBOOT_S = 5.0
REBOOT_LOOK_S = 0.1
#: A body that does not tell is at rest when no setpoint has moved by more than `STILL` degrees
#: between two looks for `STILL_S` seconds.
STILL_S, LOOK_S = 0.5, 0.1
STILL = 0.05
#: The thread is given so long to end; one tick is enough unless the port hangs.
JOIN_S = 2.0
SENSORS = ("joint", "setpoint", "temperature", "voltage", "load")

log = logging.getLogger(__name__)

T = TypeVar("T")


class DynamixelServos(Driver):
    """Dynamixel servos of one port as joints with names, degrees and limits."""

    Settings = ServoSettings
    summary = "Dynamixel servos on a serial port (X series; MX, RX, AX)"
    facts = DriverFacts(
        needs="servos on a serial port",
        stop="each servo answers that it holds its place",
        page="docs/how-to/hardware.md",
        shown=("stop", "loss", "return", "errors", "units"),
    )
    settings: ServoSettings

    def __init__(self, name: str, settings: ServoSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self.loop = ServoLoop(name, settings, context)
        self._started = False

    @classmethod
    def offer(cls, settings: ServoSettings) -> Offer:
        """pose, poses, home, torque; play, gaze, nudge and reboot where the settings allow them.

        Servos that follow a body leave everything to it but torque and reboot. Five readings a
        joint: position and setpoint in degrees (10 Hz), temperature in C, voltage in V, load in %
        of the maximum (1 Hz). Setpoints are the body's if one is followed.
        """
        kinds = [kind for kind in SENSORS if not (settings.follows and kind == "setpoint")]
        return Offer(
            verbs=verbs.servo_verbs(settings),
            joints={
                name: Range(joint.min, joint.max, "deg") for name, joint in settings.joints.items()
            },
            sensors=tuple(f"{kind}.{name}" for kind in kinds for name in settings.joints),
        )

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Look at port, adapter and servos without moving anything."""
        return await asyncio.to_thread(examine, probe.settings)

    async def open(self) -> None:
        """Start the thread that looks for the port."""
        self._started = True
        self.loop.start()

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Carry out a verb; returns the setpoints really taken, and what was changed in them."""
        if self.settings.follows and job.verb not in ("torque", "reboot"):
            raise RejectedError(
                f"the joints follow {self.settings.follows!r}; ask it to {job.verb}"
            )
        if job.verb in ("pose", "poses", "home", "play"):
            return await self._move(job, verbs.keyframes(self.settings, job.verb, job.args))
        if job.verb in ("gaze", "nudge"):
            return await self._follow(job)
        if job.verb == "torque":
            return await self._torque(job)
        if job.verb == "reboot":
            return await self._reboot(job)
        raise RejectedError(f"servos cannot {job.verb!r}")

    async def stop(self, scope: Scope) -> StopReport | None:
        """Hold every joint where it is now; names those that do where one is not there or has an
        alarm: the chain may have been faulted from the beginning.

        `DeviceLostError` if the line is gone and joints were held when it went, `DriverError` if
        only some of them fell silent: then nobody knows.
        """
        if scope is Scope.DRIVE:
            return None
        self.loop.stopped = True
        self._follow_body(False)
        if not self._started or not (self.loop.online or self.loop.holding):
            return None  # every joint is limp
        return await self._ask(_frozen)

    async def resume(self) -> None:
        """The stop was released: follow the body again, slowly until each joint has met it."""
        self.loop.stopped = False
        self._follow_body(True)

    def _follow_body(self, follow: bool) -> None:
        if self.loop.following is not None:
            self.loop.following.paused = not follow

    async def rest(self) -> None:
        """Move slowly to the rest angles, if there are any and `rest_on_close` says so, then switch
        the torque off.

        Joints that follow a body and have no rest angles of their own wait for it to be at rest.
        """
        try:
            await self._take_rest_pose()
        finally:
            await self._all_limp()

    async def close(self) -> None:
        """Rest pose (unless the robot was stopped), torque off, port closed."""
        if not self._started:
            return
        try:
            if self.settings.rest_on_close and not self.loop.stopped:
                await self.rest()
            else:
                await self._all_limp()
        except DriverError as error:
            log.info("closed without torque off: %s", error.what)
        finally:
            self._started = False
            if not await asyncio.to_thread(self.loop.close, JOIN_S):
                log.error("the servo thread hangs in %s", self.settings.port)

    # -- verbs -----------------------------------------------------------------------------------

    async def _move(self, job: Job | None, frames: list[Keyframe]) -> dict[str, Json]:
        move = PlannedMove()
        try:
            plan = await self._ask(lambda chain, now: chain.begin(move, frames, now))
            if job is not None:
                job.expects(plan.duration)
            await asyncio.wrap_future(move.done)
            if job is not None and (move.left_out or move.taken):
                missing = move.left_out | dict.fromkeys(move.taken, "was taken by another movement")
                job.goes_on()("; ".join(f"{name} {why}" for name, why in missing.items()))
        except asyncio.CancelledError:
            self.loop.ask(lambda chain, _now: chain.drop(move))
            raise
        return _sent(plan, move)

    async def _follow(self, job: Job) -> dict[str, Json]:
        targets = verbs.turn(self.settings, job.args)
        relative = job.verb == "nudge"
        arrived = None if relative else _arrival(job)
        accepted = await self._ask(
            lambda chain, _now: chain.follow(targets, relative=relative, tell=arrived)
        )
        sent: dict[str, Json] = {"joints": {k: round(v, 3) for k, v in accepted.items()}}
        if not relative:
            clamped = {k: targets[k] for k, v in accepted.items() if v != targets[k]}
            if clamped:
                sent["clamped"] = clamped
        left_out = sorted(set(targets) - set(accepted))
        if left_out:
            sent["left_out"] = left_out
        return sent

    async def _torque(self, job: Job) -> dict[str, Json]:
        on = bool(job.args["on"])
        names = _named(job) or list(self.settings.joints)
        failed = await self._ask(lambda chain, _now: chain.set_torque(names, on))
        done: list[Json] = [name for name in names if name not in failed]
        if not done:
            raise DriverError(*_joint_troubles(failed))
        sent: dict[str, Json] = {"on": on, "joints": done}
        if failed:
            sent["left_out"] = {name: why.what for name, why in failed.items()}
        return sent

    async def _reboot(self, job: Job) -> dict[str, Json]:
        if self.settings.protocol == 1:
            raise RejectedError(
                "protocol 1 servos cannot be restarted over the wire",
                "switch their power off and on",
            )
        named = _named(job)

        def restart(chain: ServoChain, _now: float) -> tuple[list[str], list[str]]:
            wanted = named or [servo.name for servo in chain.servos.values() if servo.alarms]
            return wanted, chain.reboot(wanted)

        wanted, sent = await self._ask(restart)
        if not wanted:
            raise RejectedError(
                "no servo reports an alarm", "name one with `joint` to restart it anyway"
            )
        if deaf := [name for name in wanted if name not in sent]:
            raise DriverError(
                f"{', '.join(deaf)} did not take the restart", "check its cable and its power"
            )
        job.expects(1.0)
        missing = await self._wait_until_ready(sent)
        if missing:
            raise DriverError(
                f"{', '.join(missing)} did not come back after the restart", "check its power"
            )
        return {"joints": list(sent)}

    async def _wait_until_ready(self, names: list[str]) -> list[str]:
        """Names of those that are still silent after `REBOOT_S`, and a look at each: the chain asks
        one silent servo at a time.
        """

        def silent(chain: ServoChain, _now: float) -> list[str]:
            return [n for n in names if chain.servos[n].status is not ServoStatus.READY]

        missing = await self._ask(silent)
        looks = round((REBOOT_S + PROBE_S * len(names)) / REBOOT_LOOK_S)
        while missing and looks > 0:
            await asyncio.sleep(REBOOT_LOOK_S)
            missing = await self._ask(silent)
            looks -= 1
        return missing

    # -- rest ------------------------------------------------------------------------------------

    async def _take_rest_pose(self) -> None:
        rest = {
            name: joint.rest
            for name, joint in self.settings.joints.items()
            if joint.rest is not None and self.settings.rest_on_close
        }

        def distance(chain: ServoChain, _now: float) -> dict[str, float]:
            return {
                name: abs(angle - chain.servos[name].setpoint)
                for name, angle in rest.items()
                if chain.servos[name].obstacle is None
            }

        if not rest and self.loop.following is not None:
            await self._body_at_rest(self.loop.following)
            return
        ways = await self._ask(distance)
        if ways:
            self._follow_body(False)
            seconds = max(ways.values()) / self.settings.rest_speed
            await self._move(None, [Keyframe({name: rest[name] for name in ways}, seconds)])

    async def _body_at_rest(self, following: BodyFollower) -> None:
        """Return when no joint is held, or the body is at rest or silent, and the joints stand.

        However long that takes: the session ends it after `REST_WAIT_S`, and says so.
        """
        held, since = await self._ask(_held), 0.0
        while held and not following.still and since < STILL_S:
            await asyncio.sleep(LOOK_S)
            before, held = held, await self._ask(_held)
            moved = any(abs(held[name] - before.get(name, 0.0)) > STILL for name in held)
            # A slow start looks like standing still; only the body knows that it has more to go.
            under_way = moved or following.at_rest is False
            since = 0.0 if under_way else since + LOOK_S

    async def _all_limp(self) -> None:
        names = list(self.settings.joints)

        def limp(chain: ServoChain, _now: float) -> None:
            # Those believed limp as well: the answer to `torque: on` may have been lost.
            servos = chain.servos
            held = [
                name
                for name in names
                if servos[name].torque or servos[name].status is ServoStatus.READY
            ]
            failed = chain.set_torque(held, on=False)
            if failed:
                text, _ = _joint_troubles(failed)
                self.context.notice("error", f"torque is still on: {text}", "switch the power off")

        await self._ask(limp)

    async def _ask(self, action: Action[T]) -> T:
        if not self._started:
            raise DeviceLostError("the servo driver is not open")
        return await asyncio.wrap_future(self.loop.ask(action))


def _arrival(job: Job) -> Callable[[str], None]:
    """What tells that the motion of a job has been seen to arrive, or why it has not."""
    goes_on = job.goes_on()

    def tell(why: str) -> None:
        job.evidence("measured")
        goes_on(why)

    return tell


def _held(chain: ServoChain, _now: float) -> dict[str, float]:
    """Setpoints of the joints that are held."""
    return {servo.name: servo.setpoint for servo in chain.servos.values() if servo.moves}


def _joint_troubles(failed: Mapping[str, DriverError]) -> tuple[str, str]:
    """What went wrong with which joints, and what to do."""
    remedies = dict.fromkeys(why.remedy for why in failed.values() if why.remedy)
    return "; ".join(f"{name} {why.what}" for name, why in failed.items()), "; ".join(remedies)


def _named(job: Job) -> list[str]:
    """The one joint that a command names, if it names one."""
    name = job.args.get("joint")
    return [name] if name else []


def _sent(plan: MotionPlan, move: PlannedMove) -> dict[str, Any]:
    """What really went out: goals in degrees, time, and everything that differs from the wish."""
    sent: dict[str, Any] = {
        "joints": {name: round(track.goal, 3) for name, track in plan.tracks.items()},
        "seconds": round(plan.duration, 3),
    }
    if plan.clamped:
        sent["clamped"] = dict(plan.clamped)
    if plan.late > 0:
        sent["late_s"] = round(plan.late, 3)
    if move.left_out:
        sent["left_out"] = dict(move.left_out)
    if move.taken:
        sent["taken_over"] = list(move.taken)
    return sent


def _frozen(chain: ServoChain, _now: float) -> StopReport | None:
    chain.freeze()
    servos = chain.servos.values()
    ready = tuple(servo.name for servo in servos if servo.answers)
    faulted = any(servo.trouble or servo.alarms for servo in servos)
    return StopReport(ready) if faulted else None
