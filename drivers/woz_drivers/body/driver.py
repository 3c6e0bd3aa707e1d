"""The driver: verbs in, ticks out, by way of the ticker's thread."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Callable, Iterable, Mapping
from typing import Any, ClassVar

from woz_drivers.body import doctor
from woz_drivers.body.servo_feedback import MOVING, MotionWatch, joint_troubles
from woz_drivers.body.settings import BodySettings, move_changes
from woz_drivers.body.tick_loop import BodyLoop, ThreadTicker
from woz_tui.drivers import argument_values
from woz_tui.drivers.background import BackgroundTasks
from woz_tui.drivers.confirmed_stop import AGAIN_S
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverContext,
    DriverError,
    DriverFacts,
    Finding,
    Forecast,
    Health,
    Job,
    Offer,
    Probe,
    RejectedError,
    Scope,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_verbs import known_by
from woz_tui.motion.body_verbs import BRIEF, body_verbs
from woz_tui.motion.engine import Engine
from woz_tui.motion.engine_io import EndedInput
from woz_tui.motion.kinematics import body_outline
from woz_tui.motion.modes import Mode, Operator, operator_of
from woz_tui.motion.rendering import RenderedDriver
from woz_tui.protocol.messages import Json
from woz_tui.system.tasks import wait_at_most

#: The stop is confirmed by the next tick; after so many seconds nobody knows.
STOP_S = 0.4
#: The thread is given so long to end; one tick is enough.
JOIN_S, LOOK_S = 2.0, 0.005
#: What is over when its joints are there.
_AWAITED = ("play", "play_move", "pose", "poses", "home")
#: A named pose takes so long at speed 1, in seconds.
POSE_S = 1.0

#: Told where the head shall follow what nobody sees, and what to do about it.
BLIND = (
    "tracking has no camera: the body gets sad, then moves to its home pose",
    "name a driver of type camera in the body's setting `camera`",
)

log = logging.getLogger(__name__)


class Body(RenderedDriver):
    """Joints with roles, a face and a personality, moved by an engine."""

    Settings = BodySettings
    summary = "a body: gaze, moves, emotions and modes, for servos or only on the screen"
    facts = DriverFacts(
        needs="servos (type dynamixel) and a face (type led-face), or only the screen",
        simulated="without servos the console shows the body",
        stop="the motion stands still; the servos confirm by themselves",
        page="docs/how-to/body.md",
    )
    settings: BodySettings
    #: What keeps the rate, made with the rate and the driver's name.
    ticker: ClassVar[Callable[[float, str], ThreadTicker]] = ThreadTicker

    def __init__(self, name: str, settings: BodySettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._ticker = type(self).ticker(settings.rate, name)
        self.loop = BodyLoop(
            settings, context, self._ticker.lateness, self._on_ended, self._on_stroke
        )
        verbs = self.offer(settings).verbs
        self._verbs = {verb.name for verb in verbs}
        self._brief = {verb.name for verb in verbs if verb.stream} | BRIEF
        self._arriving = {verb.name for verb in verbs if verb.arrives}
        self._running: dict[int, asyncio.Future[str]] = {}
        #: Tells that a move comes to its stroke, by token.
        self._strokes: dict[int, Callable[[], None]] = {}
        #: Tells how motions end that go on after their command, by token.
        self._going_on: dict[int, Callable[[str], None]] = {}
        #: Those that wait until servos show that a motion has arrived.
        self._seeing = BackgroundTasks("waiting for joints to arrive")
        self._events: asyncio.AbstractEventLoop | None = None
        self._closed = False

    @classmethod
    def offer(cls, settings: BodySettings) -> Offer:
        """Everything a body can be asked for; what is about the face only if it has one. What its
        servos show is measured; without any nobody can know, and the joints are published, too.
        Setpoints in degrees come at 10 Hz; `tick` is how late the latest tick of a second was, in
        milliseconds.
        """
        verbs = body_verbs(settings, settings.playable)
        kinds = ("setpoint",) if settings.servos else ("setpoint", "joint")
        return Offer(
            verbs=tuple(known_by("measured", verbs, *_AWAITED)) if settings.servos else verbs,
            joints={
                name: Range(joint.min, joint.max, "deg") for name, joint in settings.joints.items()
            },
            sensors=(*(f"{kind}.{name}" for kind in kinds for name in settings.joints), "tick"),
            outline={"kind": "body", **body_outline(settings)},
        )

    @classmethod
    def engine(cls, settings: BodySettings, *, seed: int | None = None) -> Engine:
        """A body in time of its own, for `woz render`; `seed` instead of the file's."""
        return Engine(
            settings,
            settings.repertoire.moves,
            seed=settings.seed if seed is None else seed,
        )

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Say what it is made of; there is no hardware of its own to look at."""
        return doctor.examine(probe)

    async def open(self) -> None:
        """Begin to tick."""
        self._events = asyncio.get_running_loop()
        self.context.health(Health.CONNECTING, "before its first update")
        self._ticker.start(self.loop.step)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Carry out a verb: the engine takes it at once, and what takes time is awaited.

        Returns what was really taken; `ended` says why it was over early. A stream of setpoints
        (gaze, joints ...) is not awaited: the next one takes its place.
        """
        if self._events is None or self._closed:
            raise DeviceLostError("the body is not open")
        if job.verb not in self._verbs:
            raise RejectedError(f"this body cannot {job.verb!r}")
        verb, args = self.translated(self.settings, job.verb, job.args)
        named = _named(args)
        if self.loop.feedback is not None and job.verb in MOVING:
            self.loop.feedback.need(named or self.settings.joints, self._events.time())
        if verb == "play_move":  # here: no tick waits for the reading
            self.loop.engine.read_move(argument_values.text(args, "move"))
        answer = self.loop.apply(verb, args, operator_of(job.source))
        if verb == "mode" and args.get("mode") == Mode.TRACKING.value and not self.settings.camera:
            self.context.notice("warning", *BLIND)
        sent = dict(answer.sent)
        if not answer.token:
            return sent
        if job.verb in self._brief:
            if job.verb in self._arriving:
                self._going_on[answer.token] = self._arrival(job)
            return sent if answer.seconds is None else {**sent, "seconds": answer.seconds}
        if answer.seconds is not None:
            job.expects(answer.seconds)
        self._strokes[answer.token] = lambda: job.mark("stroke")
        watch = self._watch(named) if job.verb in _AWAITED else None
        try:
            why = await self._end_of(answer.token)
            if not why and watch is not None:
                return {**sent, **await self._seen(job, watch)}
        finally:
            self._strokes.pop(answer.token, None)
            self._unwatch(watch)
        if why:
            job.goes_on()(why)
        return {**sent, "ended": why} if why else sent

    # -- what servos show ------------------------------------------------------------------------

    def _watch(self, named: Iterable[str] = ()) -> MotionWatch | None:
        """Watch how the joints follow; None without servos."""
        if self.loop.feedback is None:
            return None
        watch = MotionWatch(self.loop.feedback, frozenset(named))
        self.loop.watches = (*self.loop.watches, watch)
        return watch

    def _unwatch(self, watch: MotionWatch | None) -> None:
        self.loop.watches = tuple(each for each in self.loop.watches if each is not watch)

    async def _seen(self, job: Job, watch: MotionWatch) -> dict[str, Json]:
        """What the servos show of a motion that is over, for `sent`.

        Raises `DriverError` if a joint that could have followed did not, or none could.
        """
        missing, joints = await watch.missing(), watch.involved()
        if not missing:
            job.evidence("measured" if joints else "timed")
            return {}
        text, remedy = joint_troubles(missing)
        assert self._events is not None
        could_not = watch.feedback.obstacles(self._events.time())
        if len(missing) == len(joints) or any(name not in could_not for name in missing):
            raise DriverError(text, remedy)
        job.evidence("measured")
        job.goes_on()(text)
        return {"left_out": {name: why for name, (why, _) in missing.items()}}

    def _arrival(self, job: Job) -> Callable[[str], None]:
        """What is told when a motion that goes on is over: that joints are seen there, or not."""
        goes_on, watch = job.goes_on(), self._watch()
        if watch is None:
            return goes_on

        async def see() -> None:
            try:
                missing = await watch.missing()
            finally:
                self._unwatch(watch)
            job.evidence("measured" if watch.involved() else "timed")
            goes_on(joint_troubles(missing)[0])

        def over(why: str) -> None:
            if why:
                self._unwatch(watch)
                goes_on(why)
            else:
                self._seeing.start(see())

        return over

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """Moves, poses and gazes, by the engine's own arithmetic; of a move its stroke, too."""
        foreseen = self.loop.predict(*self.translated(self.settings, verb, args))
        if foreseen.seconds is None:
            return Forecast()
        at = foreseen.stroke
        return Forecast(foreseen.seconds, () if at is None else ((at, "stroke", ""),))

    async def stop(self, scope: Scope) -> None:
        """Stand still, breathing and blinking too, until `resume`; before `open`, from the first
        tick on.

        Raises:
            DriverError: No tick confirmed it.
        """
        if scope is Scope.DRIVE or self._closed:
            return
        frozen = self.loop.freeze()
        if self._events is None:
            return
        still = asyncio.wrap_future(frozen)
        try:
            await wait_at_most([still], STOP_S, AGAIN_S)
            if not still.done():
                raise DriverError(
                    "the stop was not confirmed", "the servos hold their position; end the session"
                )
            still.result()
        finally:
            still.cancel()

    async def resume(self) -> None:
        """The stop was released: breathe and blink again."""
        if not self._closed:
            self.loop.resume()

    def reread(self, settings: BodySettings, *, dry_run: bool) -> list[str]:
        """Take over edited move files."""
        moves = settings.repertoire.moves
        changes = [*move_changes(self.loop.moves, moves)]
        if changes and not dry_run:
            self.loop.set_moves(moves)
        return changes

    async def rest(self) -> None:
        """Hold the breath and go slowly to the rest pose."""
        if self._events is None or self._closed:
            return
        self.loop.at_rest = False
        try:
            await self._go_to_rest()
        finally:  # also a body that is stopped on the way goes no further
            self.loop.at_rest = True

    async def _go_to_rest(self) -> None:
        pose: dict[str, Json] = dict(self.settings.rest_pose)
        try:
            self.loop.apply("mode", {"mode": "normal"}, Operator.WIZARD)
            self.loop.apply("breathing", {"on": False}, Operator.WIZARD)
            answer = self.loop.apply(
                "pose", {"joints": pose, "seconds": self.settings.rest_time}, Operator.WIZARD
            )
        except RejectedError as refused:
            log.info("no rest pose: %s", refused.what)
            return
        if answer.token:
            await self._end_of(answer.token)

    async def close(self) -> None:
        """End the thread; servos hold the last setpoints until they are closed themselves."""
        if self._closed:
            return
        self._closed = True
        if self._events is None:
            return
        self._ticker.end()
        await self._seeing.close(0.0)
        for _ in range(round(JOIN_S / LOOK_S)):
            if self._ticker.ended:
                break
            await asyncio.sleep(LOOK_S)
        else:
            log.error("the body's thread does not respond")
        for future in self._running.values():
            if not future.done():
                future.set_exception(DeviceLostError("the body was closed"))
        self.context.notice("info", str(self._ticker.lateness))

    # -- inputs ----------------------------------------------------------------------------------

    @classmethod
    def translated(
        cls, settings: BodySettings, verb: str, args: Mapping[str, Json]
    ) -> tuple[str, Mapping[str, Json]]:
        """An input as the engine knows it: `play` of a named pose is a pose; `amplitude` is the
        share of the way from home.
        """
        name = args.get("move")
        pose = settings.poses.get(name) if verb == "play" and isinstance(name, str) else None
        if pose is None:
            return verb, args
        speed, amplitude = (_number(args.get(key)) for key in ("speed", "amplitude"))
        if speed <= 0:
            raise RejectedError(f"speed must be above 0, not {speed:g}")
        home = {joint: settings.joints[joint].home for joint in pose}
        joints: dict[str, Any] = {
            joint: home[joint] + amplitude * (angle - home[joint]) for joint, angle in pose.items()
        }
        return "pose", {"joints": joints, "seconds": POSE_S / speed}

    async def _end_of(self, token: int) -> str:
        """Why the input `token` is over; empty if it came to its own end."""
        assert self._events is not None
        future: asyncio.Future[str] = self._events.create_future()
        self._running[token] = future
        try:
            return await future
        except asyncio.CancelledError:
            self.loop.drop(token)
            raise
        finally:
            self._running.pop(token, None)

    def _on_ended(self, ended: tuple[EndedInput, ...]) -> None:
        """From the ticking thread. Inputs are registered in the turn of the loop in which they were
        applied, so none can be told of before it is known.
        """
        assert self._events is not None
        with contextlib.suppress(RuntimeError):  # the loop has closed: the session is over
            self._events.call_soon_threadsafe(self._ended, ended)

    def _on_stroke(self, token: int) -> None:
        """From the ticking thread, as `_on_ended`."""
        assert self._events is not None
        with contextlib.suppress(RuntimeError):
            self._events.call_soon_threadsafe(self._stroke, token)

    def _stroke(self, token: int) -> None:
        if (tell := self._strokes.get(token)) is not None:
            tell()

    def _ended(self, ended: tuple[EndedInput, ...]) -> None:
        for one in ended:
            if (tell := self._going_on.pop(one.token, None)) is not None:
                tell(one.why)
            future = self._running.get(one.token)
            if future is not None and not future.done():
                future.set_result(one.why)


def _named(args: Mapping[str, Json]) -> frozenset[str]:
    """The joints that a command names."""
    poses = args.get("poses")
    every = [args, *(poses if isinstance(poses, list) else ())]
    found = [each.get("joints") for each in every if isinstance(each, Mapping)]
    return frozenset(name for one in found if isinstance(one, Mapping) for name in one)


def _number(value: Json) -> float:
    """A share or a pace; 1 if there is none."""
    return float(value) if isinstance(value, int | float) else 1.0
