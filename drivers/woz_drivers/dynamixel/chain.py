"""What the loop's thread does with the servos: read, move, bound, write, look after them.

Everything here runs in that one thread and may raise `DeviceLostError`.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field

from woz_drivers.dynamixel import servo as servos
from woz_drivers.dynamixel.body_following import BodyFollower
from woz_drivers.dynamixel.control_tables import ControlTable
from woz_drivers.dynamixel.port import slow_answers
from woz_drivers.dynamixel.servo import (
    LATE_MISSES,
    LATE_S,
    MISSES,
    PINGS_ONLY,
    TORQUE_REMEDY,
    Servo,
    ServoStatus,
    SilentError,
    UnfitError,
)
from woz_drivers.dynamixel.servo_health import ServoUpkeep
from woz_drivers.dynamixel.setpoint_planning import (
    ARRIVED,
    Keyframe,
    MotionPlan,
    TargetFollower,
    plan_motion,
)
from woz_drivers.dynamixel.settings import ServoSettings
from woz_drivers.dynamixel.wire import ServoWire
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError, RejectedError
from woz_tui.motion.safety import limited_setpoint

#: A setpoint that did not change is written again so often, in seconds: one may have been lost.
REFRESH_S = 0.5
#: A late tick may make up for at most so many periods at full speed.
CATCH_UP = 2.0
#: Silent servos are asked again one by one, one every so many seconds.
PROBE_S = 1.0
#: A joint may come to its goal so long after its setpoint, in seconds.
SETTLE_S = 1.0
STUCK_REMEDY = "see what holds it, and its load; `tolerance` says how near to its goal is there"


@dataclass(eq=False, slots=True)
class PlannedMove:
    """A planned movement under way; `done` is set when it has ended.

    `left_out` names joints that could not take part, and why; `taken` those that another command
    has taken over since.
    """

    done: Future[None] = field(default_factory=Future)
    plan: MotionPlan | None = None
    joints: set[str] = field(default_factory=set)
    left_out: dict[str, str] = field(default_factory=dict)
    taken: list[str] = field(default_factory=list)
    #: Since when all setpoints are at their goals.
    over_since: float | None = None


@dataclass(eq=False, slots=True)
class FollowedGaze:
    """Targets in degrees that joints follow, and what is told of their arrival."""

    targets: Mapping[str, float]
    tell: Callable[[str], None]
    over_since: float | None = None


class ServoChain(ServoUpkeep):
    """The servos of one port, for as long as one opening of the port lasts.

    With `following` the joints do what a body wants, but for movements begun here.
    """

    def __init__(
        self,
        wire: ServoWire,
        settings: ServoSettings,
        context: DriverContext,
        following: BodyFollower | None = None,
    ) -> None:
        super().__init__(wire, settings, context)
        self._following = following
        self._moves: list[PlannedMove] = []
        self._gaze: FollowedGaze | None = None
        self._probes: deque[Servo] = deque()
        self._last_tick: float | None = None
        self._next_refresh = 0.0
        self._next_probe = 0.0

    # -- coming up ---------------------------------------------------------------------------

    def connect(self) -> None:
        """Check every servo, with more patience if it needs any. `DeviceLostError` if none answers
        at all.
        """
        for servo in self.servos.values():
            self._check(servo, fresh=True)
        silent = self._silent()
        longest = self.wire.measure(servo.joint.id for servo in silent) if silent else None
        if longest is not None:
            slow = slow_answers(self.settings.port, longest)
            self._context.notice("warning", *self.wire.port.blame(*slow))
            for servo in silent:
                self._check(servo, fresh=True)
        if len(self._silent()) == len(self.servos):
            raise self._nobody_answers()

    def _silent(self) -> list[Servo]:
        return [one for one in self.servos.values() if one.status is ServoStatus.SILENT]

    def _check(self, servo: Servo, *, fresh: bool) -> bool:
        try:
            servos.check(self.wire, servo, self.settings, fresh=fresh)
        except SilentError as silent:
            servo.lose(*self.wire.port.blame(silent.what, silent.remedy))
        except UnfitError as unfit:
            servo.lose(unfit.what, unfit.remedy, ServoStatus.UNFIT)
        return servo.status is not ServoStatus.SILENT

    def _nobody_answers(self) -> DeviceLostError:
        ids = {servo.joint.id for servo in self.servos.values()}
        found = self.wire.scan(ids)
        where = f"{self.settings.port} at {self.settings.baud} baud"
        deaf = [one for one in self.servos.values() if one.trouble.startswith(PINGS_ONLY)]
        if deaf:
            labels = ", ".join(one.label for one in deaf)
            return DeviceLostError(f"{labels} {deaf[0].trouble}", deaf[0].remedy)
        if ids & found.keys():
            late = ", ".join(map(str, sorted(ids & found.keys())))
            told = self.wire.port.blame(
                f"the servos on {where} are there (ids {late}), but their answers come late or not"
                " at all",
                "raise `reply_timeout`; `woz doctor` looks at adapter and servos",
            )
            return DeviceLostError(*told)
        if found:
            others = ", ".join(map(str, sorted(found)))
            return DeviceLostError(
                f"none of the configured servos answers on {where}; ids that do: {others}",
                "correct the ids in the robot file",
            )
        told = self.wire.port.blame(
            f"no servo answers on {where}",
            "check their power and `baud`; `woz doctor` tries the other speeds",
        )
        return DeviceLostError(*told)

    # -- what the asyncio side asks for --------------------------------------------------------

    def begin(self, move: PlannedMove, frames: Sequence[Keyframe], now: float) -> MotionPlan:
        """Plan `frames` from the setpoints held now and begin. `RejectedError` if
        nothing can move.
        """
        wanted = {name for frame in frames for name in frame.joints}
        move.left_out = self._obstacles(sorted(wanted))
        able = sorted(wanted - set(move.left_out))
        if not able:
            raise self._refusal(move.left_out)
        start = {name: self.servos[name].setpoint for name in able}
        limits = {name: self.servos[name].limits for name in able}
        planned = plan_motion(start, frames, limits, self.settings.profile)
        for name, track in planned.tracks.items():
            self._take_over(name)
            servo = self.servos[name]
            servo.track, servo.track_began = track, now
        move.plan, move.joints = planned, set(planned.tracks)
        self._moves.append(move)
        return planned

    def follow(
        self,
        targets: Mapping[str, float],
        *,
        relative: bool,
        tell: Callable[[str], None] | None = None,
    ) -> dict[str, float]:
        """Let joints follow targets in degrees, or step by them; returns the targets as bounded.

        `tell` is called once, here: with nothing when all joints are there, or with the reason why
        they will not be.
        """
        left_out = self._obstacles(targets)
        if len(left_out) == len(targets):
            raise self._refusal(left_out)
        accepted = {}
        for name, value in targets.items():
            servo = self.servos[name]
            if name in left_out:
                continue
            if servo.follow is None:
                self._take_over(name)
                servo.follow = TargetFollower(servo.limits, servo.setpoint)
            base = servo.follow.target if relative else 0.0
            servo.follow.target = accepted[name] = servo.limits.clamp(base + value)
        self._end_gaze("the head was turned further")
        if tell is not None and left_out:
            tell("; ".join(f"{name} {why}" for name, why in sorted(left_out.items())))
        elif tell is not None:
            self._gaze = FollowedGaze(accepted, tell)
        return accepted

    def _end_gaze(self, why: str) -> None:
        """Tell that the gaze has arrived, or why it will not."""
        gaze, self._gaze = self._gaze, None
        if gaze is not None:
            gaze.tell(why)

    def drop(self, move: PlannedMove) -> None:
        """End a movement where it is: its setpoints stay. One that has ended changes nothing."""
        if move not in self._moves:
            return  # its joints may follow somebody else by now
        for name in move.joints:
            self.servos[name].hold()
        self._finish(move)

    def freeze(self) -> None:
        """Every joint stays where it is at this moment: what the stop asks for.

        `DriverError` names servos that hold and do not answer now: the others stand, these may not.
        """
        self._read()
        for servo in self.servos.values():
            servo.settle()
        self.fail_all(DriverError("stopped where it was"))
        self._write(everything=True)
        self._next_refresh = 0.0  # nobody answers this write; the next tick repeats it
        if any(servo.misses for servo in self.servos.values()):
            self._read()  # one answer may have been lost
        unknown = [
            servo.label for servo in self.servos.values() if servo.torque and not servo.answers
        ]
        if unknown:
            raise DriverError(
                f"it is unknown whether {', '.join(unknown)} has stopped",
                "switch the power off if it moves",
            )

    def set_torque(self, names: Iterable[str], on: bool) -> dict[str, DriverError]:
        """Switch joints; returns what went wrong, by joint."""
        failed: dict[str, DriverError] = {}
        for name in names:
            servo = self.servos[name]
            if servo.status is not ServoStatus.READY:
                failed[name] = UnfitError(servo.trouble, servo.remedy)
                continue
            self._take_over(name, "" if on else "had its torque switched off")
            try:
                if on:
                    servos.torque_on(self.wire, servo, self.settings)
                else:
                    servos.torque_off(self.wire, servo)
            except (SilentError, UnfitError) as error:
                failed[name] = error
        if self._following is not None:  # the body may be asked to move in the next moment
            self._following.publish_positions(self.servos.values(), time.monotonic())
        return failed

    def reboot(self, names: Iterable[str]) -> list[str]:
        """Restart servos; they are silent for a moment, and limp afterwards."""
        sent = []
        for name in names:
            servo = self.servos[name]
            self._take_over(name, "restarts")
            if self.wire.reboot(servo.joint.id):
                sent.append(name)
            servo.torque = False
            servo.lose("restarts", "")
            self._probes.appendleft(servo)
        return sent

    # -- fifty times a second ------------------------------------------------------------------

    def tick(self, now: float) -> None:
        """Read positions, move setpoints on, write them, and do one chore."""
        self._read()
        elapsed = 0.0 if self._last_tick is None else now - self._last_tick
        self._last_tick = now
        self._advance(now, min(elapsed, CATCH_UP / self.settings.rate))
        refresh = now >= self._next_refresh
        if refresh:
            self._next_refresh = now + REFRESH_S
        self._write(everything=refresh)
        self._end_moves(now)
        if self._following is not None:
            self._following.publish_positions(self.servos.values(), now)
        self._probe(now)
        self.one_chore(now)

    def _read(self) -> None:
        ready = (each for each in self.servos.values() if each.status is ServoStatus.READY)
        for table, group in _by_table(ready).items():
            if table.protocol == 1:
                for servo in group:
                    self._read_status(servo, table)
                continue
            found = self.wire.read_group((servo.joint.id for servo in group), table.present)
            for servo in group:
                self._take_position(servo, found.get(servo.joint.id))

    def _read_status(self, servo: Servo, table: ControlTable) -> None:
        """Position and torque together: no goal may go to a servo that has lost its power."""
        block = table.status_block()
        answer = self.wire.read(servo.joint.id, block)
        if answer is None:
            self._take_position(servo, None)
            return
        self._take_position(servo, table.present.within(block, answer.data))
        self.check_torque(servo, table, answer)

    def _take_position(self, servo: Servo, raw: int | None) -> None:
        if raw is None:
            self._count_miss(servo)
            return
        servo.misses = 0
        assert servo.calibration is not None
        servo.present = servo.calibration.degrees(raw)
        if not servo.torque:
            servo.settle()  # a limp joint's setpoint follows the hand that moves it

    def _count_miss(self, servo: Servo) -> None:
        servo.misses += 1
        port, now = self.wire.port, time.monotonic()
        if servo.misses == 1:
            servo.missed_since = now
        patient = port.is_late and now - servo.missed_since < LATE_S
        if servo.misses >= (LATE_MISSES if patient else MISSES):
            what, remedy = port.blame("no longer answers", "check its cable and its power")
            self._take_over(servo.name, what)
            servo.lose(what, remedy)
            self._context.notice("error", f"{servo.label} {what}", remedy)

    def _advance(self, now: float, elapsed: float) -> None:
        if self._following is not None:
            self._following.read_setpoints(now)
        for servo in self.servos.values():
            if not servo.moves:
                continue
            wanted = servo.setpoint
            if servo.track is not None:
                wanted = servo.track.at(now - servo.track_began)
            elif self._following is not None and servo.obstacle is None:
                wanted = self._following.setpoint_for(servo, elapsed)
            elif servo.follow is not None:
                wanted = servo.follow.step(servo.setpoint, elapsed)
                if servo.follow.arrived(wanted):
                    servo.follow = None
            servo.setpoint = limited_setpoint(servo.limits, servo.setpoint, wanted, elapsed)

    def _end_moves(self, now: float) -> None:
        """Report movements that are over: the joints are at their goals, or do not get there."""
        for move in list(self._moves):
            if not self._over(move, now):
                continue
            assert move.plan is not None
            move.over_since = now if move.over_since is None else move.over_since
            away = self._away({name: move.plan.tracks[name].goal for name in move.joints})
            if away and now - move.over_since < SETTLE_S:
                continue
            for name in move.joints:
                self.servos[name].hold()
            if away:
                move.done.set_exception(DriverError(away, STUCK_REMEDY))
            self._finish(move)
        if (gaze := self._gaze) is None or any(self.servos[one].follow for one in gaze.targets):
            return
        gaze.over_since = now if gaze.over_since is None else gaze.over_since
        away = self._away(gaze.targets)
        if not away or now - gaze.over_since >= SETTLE_S:
            self._end_gaze(away)

    def _away(self, goals: Mapping[str, float]) -> str:
        """Which joints are not where they shall be, as their servos measure it; empty: none."""
        return "; ".join(
            f"{name} stands at {self.servos[name].present:.0f} degrees and not at {goal:.0f}"
            for name, goal in goals.items()
            if abs(self.servos[name].present - goal) > self.settings.tolerance
        )

    def _over(self, move: PlannedMove, now: float) -> bool:
        assert move.plan is not None
        for name in move.joints:
            servo = self.servos[name]
            goal = move.plan.tracks[name].goal
            if now - servo.track_began < move.plan.duration or (
                servo.moves and abs(servo.setpoint - goal) > ARRIVED
            ):
                return False
        return True

    def _write(self, *, everything: bool) -> None:
        moving = (each for each in self.servos.values() if each.moves)
        for table, group in _by_table(moving).items():
            values = {}
            for servo in group:
                if table.protocol == 1 and servo.misses:
                    continue  # silent just now: it may be starting, and a goal would switch it on
                assert servo.calibration is not None
                raw = servo.calibration.raw(servo.setpoint)
                if everything or raw != servo.written:
                    servo.written = raw
                    speed = servo.joint.speed
                    values[servo.joint.id] = servo.calibration.goal_value(raw, speed)
            self.wire.write_group(table.goal_block(), values)

    def _probe(self, now: float) -> None:
        """Ask one silent servo whether it is back; never more than one a second."""
        if now < self._next_probe:
            return
        self._next_probe = now + PROBE_S
        for servo in self._silent():
            if servo not in self._probes:
                self._probes.append(servo)
        while self._probes:
            servo = self._probes.popleft()
            if servo.status is ServoStatus.SILENT:
                if self._check(servo, fresh=False):
                    self._notify_back(servo)
                return

    def _notify_back(self, servo: Servo) -> None:
        if servo.status is ServoStatus.READY:
            held = "and still holds" if servo.torque else "and is limp"
            self._context.notice("info", f"{servo.label} answers again {held}")

    # -- bookkeeping of movements ----------------------------------------------------------------

    def let_go(self, servo: Servo, why: str) -> None:
        """A joint cannot take part any more: it lost its torque or stopped by itself."""
        self._take_over(servo.name, why)
        servo.settle()

    def fail_all(self, error: DriverError) -> None:
        """Every movement under way ends with `error`."""
        self._end_gaze(error.what)
        for move in self._moves:
            if not move.done.done():
                move.done.set_exception(error)
        self._moves.clear()

    def _take_over(self, name: str, why: str = "") -> None:
        self.servos[name].hold()
        if self._gaze is not None and name in self._gaze.targets:
            self._end_gaze(f"{name} {why or 'was taken by another movement'}")
        for move in list(self._moves):
            if name in move.joints:
                move.joints.discard(name)
                if why:
                    move.left_out[name] = why
                else:
                    move.taken.append(name)
                if not move.joints:
                    self._finish(move)

    def _finish(self, move: PlannedMove) -> None:
        if move in self._moves:
            self._moves.remove(move)
        if move.done.done():
            return
        if move.plan is not None and move.left_out and not move.joints and not move.taken:
            move.done.set_exception(self._refusal(move.left_out))
        else:
            move.done.set_result(None)

    def _obstacles(self, names: Iterable[str]) -> dict[str, str]:
        """Joints that no movement may begin with, and why."""
        found = {name: self.servos[name].obstacle for name in names}
        return {name: why.what for name, why in found.items() if why is not None}

    def _refusal(self, left_out: Mapping[str, str]) -> DriverError:
        reasons = sorted(set(left_out.values()))
        names = ", ".join(sorted(left_out))
        if reasons == ["torque is off"]:
            return RejectedError(f"the torque of {names} is off", TORQUE_REMEDY)
        detail = "; ".join(f"{name} {why}" for name, why in sorted(left_out.items()))
        known = [self.servos[name].obstacle for name in sorted(left_out)]
        remedies = [each.remedy for each in known if each is not None and each.remedy]
        return DriverError(detail, next(iter(remedies), ""))


def _by_table(servos: Iterable[Servo]) -> dict[ControlTable, list[Servo]]:
    """Those of them that are calibrated."""
    groups: dict[ControlTable, list[Servo]] = {}
    for servo in servos:
        if servo.calibration is not None:
            groups.setdefault(servo.calibration.model.table, []).append(servo)
    return groups
