"""Head, antennas and body: one lane of moves that the daemon carries out, and setpoints of ours.

A pose or a gesture is a move of the daemon, which interpolates it on the robot. What has no end of
its own, such as a gaze that arrow keys turn on and on, or a body that breathes, is a stream of
setpoints. The daemon takes no setpoints while a move runs, and two moves at once fight: so each of
them ends before the next thing begins.
"""

from __future__ import annotations

import asyncio
import contextlib
import math
import random
from collections.abc import AsyncIterator, Callable, Coroutine, Mapping, Sequence
from typing import Any

from woz_drivers.lines.web_socket_line import AnswerError, LateAnswerError
from woz_drivers.reachy_mini.daemon_link import DaemonLink
from woz_drivers.reachy_mini.moves import PoseFrame
from woz_drivers.reachy_mini.pose import HOME, LIMITS, Pose, reachable
from woz_drivers.reachy_mini.settings import ReachyMiniSettings
from woz_tui.drivers.background import BackgroundTasks
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError, RejectedError
from woz_tui.drivers.robot_parts import RefusalAllowed
from woz_tui.motion.body_feeds import PRESENT, SETPOINTS, JointPositions, Setpoints
from woz_tui.motion.safety import LimitedJoint, Limits
from woz_tui.system.tasks import end_tasks

#: Setpoints a second.
RATE = 50.0
#: A minimum-jerk move is so much faster in its middle than on the whole.
_PEAK = 1.875
#: No move is shorter, in seconds.
_SHORTEST_S = 0.15
#: From one look at the moves under way to the next, in seconds: at the end of one whose length is
#: known, and of another.
_LOOK_S, _SELDOM_S = 0.015, 0.1
#: So much longer than it should a move may take, and so long nobody may know of it, in seconds.
_LATE_S = 3.0
#: Setpoints of a body that are older count no more, in seconds; until a joint has met them it goes
#: no faster than so, in degrees a second, and it has met them when it is so near, in degrees.
_STALE_S, _CATCH_UP_SPEED, _CAUGHT_UP_BY = 0.5, 45.0, 1.0
#: A twitch of the antennas, as a blink: how far, in degrees, and how long, in seconds.
_TWITCH, _TWITCH_S = 16.0, 0.35
_MOTORS_OFF = "switch them on first: `torque: on`, or `wake_up`"


class CutShortError(DriverError):
    """The stop came first."""

    def __init__(self) -> None:
        super().__init__("cut short by the stop")


def shortest_s(pose: Pose, before: Pose) -> float:
    """In how many seconds the way between two poses may be gone at the joints' speeds."""
    ways = (_PEAK * abs(pose[name] - before[name]) / one.speed for name, one in LIMITS.items())
    return max(_SHORTEST_S, *ways)


class ReachyBody:
    """Everything that moves. `following`: a driver of type `body` says where."""

    def __init__(
        self, link: DaemonLink, settings: ReachyMiniSettings, context: DriverContext
    ) -> None:
        self._link = link
        self._context = context
        self._settings = settings
        self.following = bool(settings.follows)
        self._setpoints = context.feed(SETPOINTS, of=settings.follows) if self.following else None
        self._present = context.feed(PRESENT)
        #: Where the joints were sent last, and where that leads; None: nobody knows, the robot's
        #: own pose counts.
        self._sent: Pose | None = None
        self._held: Pose | None = None
        #: The pose from which the frames of a gesture under way count.
        self._base: Pose | None = None
        #: Where it shall look as soon as the move that is under way lets it.
        self._next: Pose = {}
        #: What an emotion adds to the pose of the body that is followed.
        self._posture: Pose = {}
        self._streaming: asyncio.Task[None] | None = None
        #: What the next command waits for.
        self._tidying = BackgroundTasks("a move that was cut short")
        #: Held while a move of the daemon is under way.
        self._lane = asyncio.Lock()
        self._stopped = False
        #: While it is above 0 a move of the daemon has the body, and nothing is followed.
        self._moves = 0
        self._locked = False
        self._random = random.Random(1)
        self._ending = BackgroundTasks("a stop")
        #: The end of every move that the last stop has begun.
        self.ended: asyncio.Future[None] | None = None

    @property
    def pose(self) -> dict[str, float]:
        """The pose that it has taken, or is about to take."""
        pose = self._base or self._held or reachable({}, self._link.pose)
        return {**pose, **self._next}

    @property
    def setpoint(self) -> Pose:
        """Where the joints were sent last."""
        return self._sent or self._link.pose

    @property
    def _aiming(self) -> bool:
        return not self.following and self._streaming is not None and not self._streaming.done()

    def _forget_setpoints(self) -> None:
        """Something may have moved it otherwise than it was told to."""
        self._sent = self._held = None
        self._next = {}

    # -- moves of the daemon ---------------------------------------------------------------------

    async def go(self, wanted: Pose, seconds: float) -> dict[str, Any]:
        """Take a pose in `seconds`, or in as many as the joints need; what was really sent.

        Raises `DriverError`.
        """
        pose = reachable(wanted, self.pose)
        self._next = {}
        try:
            taken = await self._go(pose, seconds)
            await self._settle()
        finally:
            self._look_on()
        return {
            "joints": {name: round(pose[name], 2) for name in wanted},
            "seconds": round(taken, 3),
        }

    async def _go(self, pose: Pose, seconds: float) -> float:
        """Take a whole pose; in how many seconds."""
        self._need()
        seconds = max(seconds, shortest_s(pose, self.setpoint))
        await self._carry_out(lambda: self._link.goto(pose, seconds), seconds, pose)
        return seconds

    async def _settle(self) -> None:
        """Hold the very pose: the daemon's last step of a goto is before its end, on a busy machine
        by several degrees.
        """
        if self._held is not None:
            await self._link.setpoint(self._held)

    def seconds_for(self, wanted: Pose, seconds: float) -> float:
        """How long `go` will take, in seconds."""
        return max(seconds, shortest_s(reachable(wanted, self.pose), self.setpoint))

    async def lie_down(self, pose: Pose, seconds: float) -> None:
        """Take a pose in which it can be left alone; no body is followed any more."""
        await self._end_stream()
        await self.go(pose, seconds)

    async def gesture(
        self, frames: Sequence[PoseFrame], base: Pose, amplitude: float, speed: float
    ) -> float:
        """Pass through frames one after the other; how many seconds that took by plan.

        Where it is told to look meanwhile, the frames that are left come along.
        """
        total, pose = 0.0, self.pose
        try:
            for frame in frames:
                base = {**base, **self._next}
                pose = reachable(frame.after(base, amplitude), {**pose, **self._next})
                self._base, self._next = base, {}
                total += await self._go(pose, frame.seconds / speed)
            await self._settle()
        finally:
            self._base = None
            self._look_on()
        return total

    def gesture_s(
        self, frames: Sequence[PoseFrame], base: Pose, amplitude: float, speed: float
    ) -> float:
        """How long `gesture` will take, in seconds."""
        total, before = 0.0, self.setpoint
        for frame in frames:
            pose = reachable(frame.after(base, amplitude), before)
            total += max(frame.seconds / speed, shortest_s(pose, before))
            before = pose
        return total

    async def play(self, name: str) -> None:
        """Have the daemon play a move of its own, to its end."""
        self._need()
        try:
            await self._carry_out(lambda: self._link.play(name), None, None)
        finally:
            self._look_on()

    def _need(self) -> None:
        """Raises `DriverError` if it cannot be moved now."""
        if self._stopped:
            raise CutShortError
        self.need_motors()

    def need_motors(self) -> None:
        """Raises `RejectedError` while the motors do not hold a pose."""
        match self._link.status.motors:
            case "disabled":
                raise RejectedError("the motors are off", _MOTORS_OFF)
            case "gravity_compensation":
                raise RejectedError("the head is free to be moved by hand", "`torque: on`")

    async def _carry_out(
        self,
        begin: Callable[[], Coroutine[Any, Any, str]],
        seconds: float | None,
        pose: Pose | None,
    ) -> None:
        """Have a move begin, and wait for its end; it is ended when it is cancelled or fails."""
        async with self._lane:
            await self._tidying.settled()
            if not self.following:
                await self._end_stream()
            if self._stopped:
                raise CutShortError
            await self._move(asyncio.ensure_future(begin()), seconds, pose)

    async def _move(
        self, beginning: asyncio.Future[str], seconds: float | None, pose: Pose | None
    ) -> None:
        self._moves += 1
        try:
            uuid = await asyncio.shield(beginning)
            self._sent = self._held = pose
            await self._until_over(uuid, seconds)
        except (asyncio.CancelledError, DriverError):
            self._forget_setpoints()
            self._tidying.start(self._end_begun(beginning))
            raise
        finally:
            self._moves -= 1

    async def _until_over(self, uuid: str, seconds: float | None) -> None:
        loop = asyncio.get_running_loop()
        latest = loop.time() + (
            seconds / self._settings.pace + _LATE_S if seconds is not None else math.inf
        )
        await self._link.pause(_SELDOM_S if seconds is None else seconds)
        answered = loop.time()
        while True:
            try:
                if uuid not in await self._link.running():
                    return
                answered = loop.time()
            except LateAnswerError:  # one that a network held up ends no move
                if loop.time() > answered + _LATE_S:
                    raise
            if loop.time() > latest:
                raise DriverError("the move did not end in time", "restart the robot's daemon")
            await self._link.pause(_SELDOM_S if seconds is None else _LOOK_S)

    async def _end_begun(self, beginning: asyncio.Future[str]) -> None:
        """End a move that may run; where the daemon answers nothing, whatever runs."""
        try:
            await self._link.end(await beginning)
        except (AnswerError, DeviceLostError):
            return  # refused: nothing has begun; lost: all is ended when it is there again
        except DriverError:
            await self._link.end_running()

    # -- setpoints -------------------------------------------------------------------------------

    async def aim(self, joints: Mapping[str, float]) -> dict[str, float]:
        """Turn towards these angles, smoothly, and return at once; a newer aim takes over.

        A move that is under way is not disturbed: it turns afterwards, a gesture at its next frame.
        """
        self.need_motors()
        goal = reachable(joints, self.pose)
        self._next = {name: goal[name] for name in ("pan", "tilt", "body")}
        if not self._lane.locked():
            self._need()
            self._look_on()
        return {name: round(goal[name], 2) for name in joints}

    def _look_on(self) -> None:
        """Turn to where it shall look, if that has not been done."""
        if self._next and not self._stopped and not self._lane.locked():
            self._held, self._next = reachable(self._next, self.pose), {}
            if not self._aiming:
                self._streaming = self._task(self._stream)

    def follow(self) -> None:
        """Begin to follow the body, if it is to."""
        if self.following and (self._streaming is None or self._streaming.done()):
            self._streaming = self._task(self._follow)

    async def express(self, frames: Sequence[PoseFrame], intensity: float) -> None:
        """Show an emotion over the pose of the body that is followed; its last frame stays, also
        where it is cut short.
        """
        try:
            for frame in frames:
                self._add(frame, intensity)
                await self._link.pause(frame.seconds)
        except asyncio.CancelledError:
            self._add(frames[-1], intensity)
            raise

    def _add(self, frame: PoseFrame, intensity: float) -> None:
        self._posture = {name: intensity * by for name, by in frame.joints.items()}

    async def _stream(self) -> None:
        """Setpoints until every joint has come to its goal."""
        joints = {name: LimitedJoint(one, self.setpoint[name]) for name, one in LIMITS.items()}
        async for elapsed in _ticks(self._settings.pace):
            goal = self._held or {}
            sent = {name: one.step(goal.get(name), elapsed) for name, one in joints.items()}
            self._sent = sent
            await self._link.setpoint(sent)
            if all(one.landed for one in joints.values()):
                what = "nobody knows whether the robot looks where it is told to"
                with RefusalAllowed(self._context, what):
                    await self._arrive()
                if self._held is goal or self._held is None:
                    break  # else it was to look elsewhere meanwhile

    async def _arrive(self) -> None:
        """Ask whether setpoints count: a lock that a failed move left has the daemon ignore all."""
        goal = self._held
        match await self._link.ask("POST", "move/set_target", json={}):
            case {"status": "ignored"} if not await self._link.running():
                if not self._locked:
                    self._locked = True
                    self._context.notice(
                        "warning",
                        "the robot does not look where it is told to: its daemon waits for a move"
                        " that is over",
                        "restart the daemon",
                    )
                if self._held is goal:
                    self._forget_setpoints()
            case _:
                self._locked = False

    async def _follow(self) -> None:
        """Setpoints of the body, for good. A joint that begins to follow meets it slowly."""
        joints: dict[str, LimitedJoint] = {}
        twitch_in = self._pause_before_twitch()
        async for elapsed in _ticks(self._settings.pace):
            held = self._link.status.motors == "enabled"
            pose = self._link.pose
            stiff = frozenset(pose if held else ())
            self._present.put(JointPositions(self._context.clock.now_us(), pose, stiff))
            wanted = self._followed_pose()
            if wanted is None or self._stopped or self._moves or not held:
                joints = {}
                continue
            if not joints:
                joints = {name: LimitedJoint(_slow(name), self.setpoint[name]) for name in LIMITS}
            twitch_in -= elapsed
            if twitch_in < -_TWITCH_S:
                twitch_in = self._pause_before_twitch()
            out = _TWITCH * math.sin(math.pi * -twitch_in / _TWITCH_S) if twitch_in < 0 else 0.0
            wanted |= {name: wanted[name] + out for name in ("left-antenna", "right-antenna")}
            goal = reachable(wanted, wanted)
            for name, one in joints.items():
                one.step(goal[name], elapsed)
                if (
                    one.limits.acceleration is None
                    and abs(one.position - goal[name]) <= _CAUGHT_UP_BY
                ):
                    one.limits = _quick(name)
            self._sent = self._held = {name: one.position for name, one in joints.items()}
            await self._link.setpoint(self._sent)

    def _followed_pose(self) -> dict[str, float] | None:
        """The body's newest pose with what an emotion adds; None if it says nothing."""
        newest = self._setpoints.latest().value if self._setpoints is not None else None
        if not isinstance(newest, Setpoints):
            return None
        if self._context.clock.now_us() - newest.t_us > _STALE_S * 1e6:
            return None
        named = {name: at for name, at in newest.joints.items() if name in LIMITS}
        pose = {**HOME, **{name: at for name, at in named.items() if math.isfinite(at)}}
        if "body" not in named:
            pose["body"] = reachable({"pan": pose["pan"]}, {**pose, "body": 0.0})["body"]
        return {name: at + self._posture.get(name, 0.0) for name, at in pose.items()}

    def _pause_before_twitch(self) -> float:
        each_minute = self._settings.twitches
        return self._random.uniform(0.5, 1.5) * 60 / each_minute if each_minute else math.inf

    # -- standing still --------------------------------------------------------------------------

    def hold(self) -> None:
        """Nothing begins to move, and no body is followed, until `resume`."""
        self._stopped = True

    def begin_end(self) -> asyncio.Future[None]:
        """End every move, whoever began it, in the background: until none runs, or `resume`."""
        self._ending.cancel()
        self.ended = self._ending.start(self.end_moves())
        return self.ended

    async def end_moves(self) -> None:
        """End every move, whoever began it; returns when none runs any more."""
        self.hold()
        if not self.following:
            await self._end_stream()
        await self._link.end_any()
        while (running := await self._link.running()) or self._moves or self._tidying:
            await asyncio.gather(*(self._link.end(uuid) for uuid in running))
            await asyncio.sleep(_LOOK_S)
        self._forget_setpoints()

    async def stand_still(self) -> None:
        """Return when the poses that come from now on say that nothing moves."""
        began = asyncio.get_running_loop().time()
        while not self._link.still_since(began):  # noqa: ASYNC110 - poses set no event
            await asyncio.sleep(_LOOK_S)

    def resume(self) -> None:
        """The stop was released: what is asked for from now on must not end by it."""
        self._ending.cancel()
        self._stopped = False

    def forget(self) -> None:
        """The robot was lost, or somebody else moved it: its own pose counts from now on."""
        self._forget_setpoints()
        self._posture = {}
        if self._streaming is not None:
            self._streaming.cancel()
            self._streaming = None

    async def close(self) -> None:
        """End what goes on; the robot stays as it is."""
        self._ending.cancel()
        await self._end_stream()
        await self._tidying.close()

    async def _end_stream(self) -> None:
        streaming, self._streaming = self._streaming, None
        await end_tasks(streaming)

    def _task(self, work: Callable[[], Coroutine[Any, Any, None]]) -> asyncio.Task[None]:
        async def guarded() -> None:
            with contextlib.suppress(DeviceLostError):  # the line says so, and is looked for
                await work()

        return asyncio.get_running_loop().create_task(guarded(), name="reachy-mini setpoints")


async def _ticks(pace: float) -> AsyncIterator[float]:
    """Seconds of the robot since the tick before, again and again."""
    loop = asyncio.get_running_loop()
    due = last = loop.time()
    while True:
        due = max(due + 1 / RATE, loop.time())
        await asyncio.sleep(due - loop.time())
        now = loop.time()
        yield min(max(now - last, 1e-3), 0.1) * pace
        last = now


def _slow(name: str) -> Limits:
    """Of a joint on its way to a body that it has not met yet."""
    one = LIMITS[name]
    return Limits(one.low, one.high, min(one.speed, _CATCH_UP_SPEED))


def _quick(name: str) -> Limits:
    """Of a joint that follows a body: this bounds its acceleration itself."""
    one = LIMITS[name]
    return Limits(one.low, one.high, 2 * one.speed, one.acceleration)
