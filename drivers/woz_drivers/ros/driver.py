"""The driver: plays what a robot file declares, stops all of it at once, reads its sensors."""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import Coroutine, Iterable, Mapping
from contextlib import suppress
from typing import Any

from woz_drivers.ros import doctor, simulated_interface
from woz_drivers.ros.declarations import (
    EndDeclaration,
    SensorDeclaration,
    VerbDeclaration,
)
from woz_drivers.ros.rosbridge import Rosbridge, ServiceFailedError
from woz_drivers.ros.settings import RosSettings
from woz_drivers.ros.survey import survey
from woz_drivers.ros.templates import TemplateError, ValuePath, fill, placeholders
from woz_drivers.ros.velocity_drive import PERIOD_S, VelocityDrive
from woz_drivers.ros.verbs import BRIEF, DERIVED, arguments_of, offered
from woz_tui.drivers import confirmed_stop
from woz_tui.drivers.argument_values import color, known_joints, number
from woz_tui.drivers.background import Background
from woz_tui.drivers.confirmed_stop import confirmed_within
from woz_tui.drivers.contract import (
    UNKNOWN,
    DeviceLostError,
    Driver,
    DriverContext,
    DriverError,
    DriverFacts,
    Finding,
    Forecast,
    Job,
    Offer,
    Probe,
    RejectedError,
    Scope,
    StopReport,
    Written,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.sound_feeds import NO_TALK
from woz_tui.protocol.messages import Json

#: What a topic says must begin so soon after it was asked for, in seconds.
_BEGINS_S = 5.0
#: A sensor that is silent for so long, or for so many of its readings, is stale.
_STALE_S, _STALE_READINGS = 2.0, 5
_LOOK_S = 0.5
#: So many times zero is published on a new connection, at least.
_FOUND_EACH_OTHER = 20
#: At most so many: perhaps somebody else drives it.
_MOST_ZEROS = 100
#: Findings that the wizard is told of, before it becomes too much.
_MOST_NOTICES = 4


class Ros(Driver):
    """A robot that speaks ROS 1 or ROS 2, by rosbridge."""

    Settings = RosSettings
    summary = "whatever speaks ROS 1 or ROS 2, by rosbridge, or a simulated one"
    facts = DriverFacts(
        robot=True,
        needs="a rosbridge server on the robot, and a robot file that says what it sends",
        simulated="address: simulated",
        stop="the odometry stands still, actions say that they have ended",
        page="docs/how-to/ros.md",
        example="address: simulated, verbs: {say: {publish: /tts, type: std_msgs/String,"
        ' message: {data: "{text}"}}}',
        shown=("stop", "loss", "return", "units"),
    )
    settings: RosSettings

    def __init__(self, name: str, settings: RosSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._robot = Rosbridge(
            settings,
            context,
            simulated_interface.options(settings),
            get_ready=self._get_ready,
            on_lost=self._lost,
        )
        self._base = (
            VelocityDrive(self._robot, settings.drive) if settings.drive is not None else None
        )
        self._offered = {verb.name: verb for verb in offered(settings.verbs, settings.drive)}
        #: What ends cancelled commands, by lane: the next command of the lane waits for it.
        endings: dict[str, set[asyncio.Task[None]]] = {
            verb.lane: set() for verb in self._offered.values()
        }
        self._declared = {
            verb: DeclaredVerb(verb, declared, self._robot, endings[self._offered[verb].lane])
            for verb, declared in settings.verbs.items()
        }
        self._sensors = {
            sensor: Sensor(sensor, declared, context, self._robot)
            for sensor, declared in settings.sensors.items()
        }
        #: Where it looks: degrees to the left, degrees down.
        self._gaze = (0.0, 0.0)
        #: Verbs that cannot work with this robot, and why.
        self._broken: Mapping[str, Finding] = {}
        self._watch = Background("looking after sensors", context)
        self._lost_unexpectedly = False
        self._closed = False

    @classmethod
    def offer(cls, settings: RosSettings) -> Offer:
        """What the file declares, and what follows from it: nudge, poses."""
        return Offer(
            verbs=offered(settings.verbs, settings.drive),
            lacks=NO_TALK,
            sensors=tuple(settings.sensors),
            joints={name: Range(*ends, "deg") for name, ends in settings.joints.items()} or None,
        )

    @classmethod
    def remarks(cls, settings: RosSettings, written: Written) -> Iterable[Finding]:
        """Colours that are none, and arguments of which the robot is told nothing."""
        declared = settings.verbs.get(written.verb)
        if declared is None:
            return
        used = {name for _, name, _ in placeholders(declared.message)}
        arguments = arguments_of(written.verb, declared)
        for name, value in written.args.items():
            if name in arguments and name not in used and value != arguments[name].default:
                yield Finding("warning", name, "has no effect: the robot file does not send it")
        shade = written.args.get("color")
        free = "color" in used and "color" not in declared.values
        if free and isinstance(shade, str) and UNKNOWN not in shade:
            try:
                color(written.args, "color")
            except RejectedError as error:
                yield Finding("warning", "color", f"{error.what}; {error.remedy}")

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Compare the file with the robot; list what the robot offers, and draft a file."""
        return await doctor.examine(probe)

    # -- a session -------------------------------------------------------------------------------

    async def open(self) -> None:
        """Begin to look for the robot."""
        self._robot.start()
        if self._sensors:
            self._watch.start(self._watch_sensors())

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """As far as the file says how long it takes: by time, or a drive at its speeds."""
        if verb == "drive" and self._base is not None:
            return Forecast(self._base.seconds(args), ())
        if verb == "poses":
            return Forecast(sum(float(pose.get("seconds") or 1.0) for pose in args["poses"]), ())
        declared = self._declared.get(verb)
        seconds = declared.usual_s(args) if declared is not None else 0.0
        return Forecast(seconds or None)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Send what the file says, and return when it has ended. Raises as the contract says."""
        if job.verb not in self._offered:
            raise RejectedError(f"{self.name} cannot {job.verb!r}")
        if self._closed:
            raise DeviceLostError("the robot's driver is closed")
        broken = self._broken.get(DERIVED.get(job.verb, job.verb))
        self._robot.need()
        if broken is not None:
            raise DriverError(f"{broken.subject}: {broken.text}", broken.remedy)
        match job.verb:
            case "drive" if self._base is not None:
                return await self._base.drive(job)
            case "gaze" | "nudge":
                return await self._look(job)
            case "poses":
                return await self._poses(job)
            case "pose":
                self._check_pose(job.args["joints"])
            case "home":
                return await self._turned((0.0, 0.0), job, job.args)
        return await self._declared[job.verb].perform(job, job.args)

    async def _look(self, job: Job) -> Mapping[str, Json]:
        """A gaze, or a step from the last one, within the bounds of the file."""
        arguments = {one.name: one for one in self._offered["gaze"].arguments}
        angles = []
        for name, before in zip(("yaw", "pitch"), self._gaze, strict=True):
            if job.verb == "nudge":
                angle = before + number(job.args, name)
            else:
                angle = number(job.args, name, before)
            bounds = arguments[name].range
            if bounds is not None:
                low = -math.inf if bounds.low is None else bounds.low
                high = math.inf if bounds.high is None else bounds.high
                angle = min(max(angle, low), high)
            angles.append(angle)
        yaw, pitch = angles
        looks = {"yaw": yaw, "pitch": pitch}
        return {**looks, **await self._turned((yaw, pitch), job, looks)}

    async def _turned(
        self, gaze: tuple[float, float], job: Job, args: Mapping[str, Any]
    ) -> Mapping[str, Json]:
        """The head gets there; what fails is not where the next step begins."""
        before, self._gaze = self._gaze, gaze
        declared = self._declared["home" if job.verb == "home" else "gaze"]
        try:
            return await declared.perform(job, args)
        except DriverError:
            self._gaze = before
            raise

    async def _poses(self, job: Job) -> Mapping[str, Json]:
        poses: list[dict[str, Any]] = job.args["poses"]
        for pose in poses:
            self._check_pose(pose["joints"])
        sent: list[Json] = []
        for pose in poses:
            seconds = float(pose.get("seconds") or 1.0)
            began = time.monotonic()
            arguments = {"joints": pose["joints"], "seconds": seconds}
            sent.append(dict(await self._declared["pose"].perform(job, arguments)))
            # A message is sent at once, the movement takes its time.
            await asyncio.sleep(max(0.0, seconds - (time.monotonic() - began)))
        return {"poses": sent}

    def _check_pose(self, joints: Mapping[str, float]) -> None:
        for name, angle in known_joints(joints, self.settings.joints).items():
            low, high = self.settings.joints[name]
            if not low <= angle <= high:
                raise RejectedError(f"{name}: {angle:g} is not within {low:g} to {high:g} degrees")

    # -- stopping --------------------------------------------------------------------------------

    async def stop(self, scope: Scope) -> StopReport | None:
        """Everything at once; each verb confirms for itself."""
        if not self._robot.ready:
            if not self._lost_unexpectedly:
                return None
            driving = () if self._base is None else ("driving",)
            moving = (*driving, *sorted(self._leftovers()))
            return StopReport(missing=moving) if moving else None
        stops: dict[str, Coroutine[Any, Any, None]] = {}
        if self._base is not None:
            stops["driving"] = self._base.stop()
        for name, verb in self._declared.items():
            if verb.stoppable and (scope is Scope.ALL or self.settings.verbs[name].is_driving):
                stops[name] = verb.stop()
        if not stops:
            return None
        ends = {name: [self._robot.later(stop)] for name, stop in stops.items()}
        return await confirmed_within(confirmed_stop.STOP_S, ends)

    def _leftovers(self) -> frozenset[str]:
        """What may be going on since the line was lost."""
        return frozenset(name for name, verb in self._declared.items() if verb.may_go_on)

    async def rest(self) -> None:
        """Stand still; poses are the robot's own affair."""
        if self._robot.ready and self._base is not None:
            with suppress(DriverError, TimeoutError):
                await self._base.stop()

    async def close(self) -> None:
        """Let go; what is being done is ended."""
        first, self._closed = not self._closed, True
        await self._watch.close()
        if first and self._robot.ready:
            with suppress(DriverError, TimeoutError):
                async with asyncio.timeout(1.0):
                    await self._end_everything()
        await self._robot.close()

    # -- coming and going --------------------------------------------------------------------------

    async def _get_ready(self) -> str:
        """The robot is there: what went on when it was lost ends first."""
        if self._base is not None:
            await self._base.zero()
        if self._lost_unexpectedly:
            await self._end_everything()
        self._lost_unexpectedly = False
        self._robot.later(self._end_again(self._leftovers()))
        for verb in self._declared.values():
            verb.may_go_on = False
        self._robot.later(self._compare())
        return f"rosbridge of ROS {self.settings.ros} at {self._robot.shown}"

    async def _end_again(self, leftovers: frozenset[str]) -> None:
        """With ROS 2 what is published before a publisher and its subscribers have found each other
        is lost: say it for a while, and as long as the base moves, unless somebody plays meanwhile.
        """
        base = self._base
        for count in range(_MOST_ZEROS):
            await asyncio.sleep(PERIOD_S)
            if count >= _FOUND_EACH_OTHER and (base is None or not base.rolls_on):
                return
            if base is not None and not base.moving:
                await base.zero()
            for name in leftovers if count < _FOUND_EACH_OTHER else ():
                verb, stop = self._declared[name], self.settings.verbs[name].stop
                if stop is not None and stop.publish and not verb.going_on:
                    await verb.end()

    async def _end_everything(self) -> None:
        """Without waiting for confirmations, but for those of services."""
        if self._base is not None:
            await self._base.zero()
        for verb in self._declared.values():
            with suppress(DriverError, TimeoutError):
                await verb.end()

    async def _compare(self) -> None:
        """Tell the wizard what does not fit this robot before a verb is used."""
        try:
            found = await survey(self._robot, self.settings)
        except DeviceLostError:
            return
        except DriverError as error:
            self.context.notice("warning", f"not compared with the robot: {error.what}")
            return
        self._broken = found.broken
        findings = [finding for _, finding in found.wrong]
        findings.sort(key=lambda finding: finding.level)
        for finding in findings[:_MOST_NOTICES]:
            self.context.notice(finding.level, f"{finding.subject}: {finding.text}", finding.remedy)
        if len(findings) > _MOST_NOTICES:
            more = len(findings) - _MOST_NOTICES
            self.context.notice("warning", f"and {more} more", "see all with woz doctor")

    def _lost(self, error: DeviceLostError) -> None:
        self._lost_unexpectedly = not self._closed
        for verb in self._declared.values():
            verb.lost()
        if self._base is not None:
            self._base.lost()
        if not self._closed:
            for sensor in self._sensors.values():
                sensor.stale(error.what)

    async def _watch_sensors(self) -> None:
        while True:
            await asyncio.sleep(_LOOK_S)
            for sensor in self._sensors.values():
                sensor.look()


class DeclaredVerb:
    """One verb of the file: sends it, knows its end, ends it."""

    def __init__(
        self,
        verb: str,
        declared: VerbDeclaration,
        robot: Rosbridge,
        endings: set[asyncio.Task[None]],
    ) -> None:
        self._verb = verb
        self._declared = declared
        self._robot = robot
        #: What ends earlier commands of its lane.
        self._endings = endings
        #: Whether a command of it was under way when the robot was lost.
        self.may_go_on = False
        self._arguments = arguments_of(verb, declared)
        self._text = next((n for n, one in self._arguments.items() if one.kind == "text"), "")
        #: How many commands of it are going on.
        self._going_on = 0
        self._ends = EndTopic(declared.ends, robot) if declared.ends.subscribe else None
        stop = declared.stop
        if declared.publish:
            robot.advertise(declared.publish, declared.type_)
        if declared.action:
            robot.use_action(declared.action, declared.type_)
        if stop is not None and stop.publish:
            robot.advertise(stop.publish, stop.type_)

    @property
    def going_on(self) -> bool:
        """Whether a command of it is under way."""
        return self._going_on > 0

    def lost(self) -> None:
        """The robot is gone."""
        self.may_go_on |= self.going_on
        if self._ends is not None:
            self._ends.forget(self.may_go_on)

    @property
    def stoppable(self) -> bool:
        """Whether a stop has anything to do, or to tell, about it."""
        if self._declared.action or self._declared.stop is not None:
            return True
        return self.going_on and self._verb not in BRIEF

    async def perform(self, job: Job, args: Mapping[str, Any]) -> Mapping[str, Json]:
        """Send it, and return when it has ended."""
        declared = self._declared
        try:
            message = fill(declared.message, self._values(args))
        except TemplateError as error:
            raise RejectedError(f"{self._verb}: {error}", "correct the robot file") from None
        sent: dict[str, Json] = {"to": declared.target, "message": message}
        if self._endings:
            await asyncio.wait(self._endings)
            self._robot.need()
        self._going_on += 1
        try:
            if self._ends is not None:
                self._ends.expect()
            if declared.publish:
                await self._robot.publish(declared.publish, message)
            elif declared.service:
                answer = await self._robot.call(declared.service, message, declared.within)
                _check_success(declared.service, answer, declared.success)
                sent["result"] = answer
            else:
                kind = declared.type_.removesuffix("Action")
                result = await self._robot.send_goal(
                    declared.action, kind, message, declared.within
                )
                _check_success(declared.action, result, declared.success)
                sent["result"] = result
            if self._ends is not None and declared.publish:
                await self._need_listener()
            await self._robot.unless_lost(self._until_end(job, args))
            if self._ends is None and declared.publish:
                await self._need_listener()
        except asyncio.CancelledError:
            # Stopped, replaced or timed out; a stop is sent beside this, and twice does no harm.
            self._end_later()
            raise
        except DeviceLostError:
            self.may_go_on = True
            raise
        except ServiceFailedError:
            if self._ends is not None:
                self._ends.forget(may_go_on=False)
            raise
        except DriverError:
            if not declared.action:  # a goal was cancelled already, if that was needed
                self._end_later()
            raise
        finally:
            self._going_on -= 1
        return sent

    async def _need_listener(self) -> None:
        """Raises `DriverError` where nobody was there to hear what was published."""
        topic = self._declared.publish
        if await self._robot.is_there("subscribers", topic) is False:
            raise DriverError(
                f"{self._verb}: no node of the robot listens to {topic}",
                "start its node, or correct the topic in the robot file",
            )

    def _end_later(self) -> asyncio.Task[None]:
        """Begin to end it: the next command of the lane is not sent before."""
        ending = self._robot.later(self.end())
        self._endings.add(ending)
        ending.add_done_callback(self._endings.discard)
        return ending

    def _values(self, args: Mapping[str, Any]) -> dict[str, Any]:
        values = {**dict.fromkeys(self._arguments), **args}
        for name, words in self._declared.values.items():
            if isinstance(values.get(name), str) and values[name] in words:
                values[name] = words[values[name]]
        if "color" in values and "color" not in self._declared.values:
            values["color"] = color(values, "color")
        return values

    def usual_s(self, args: Mapping[str, Any]) -> float:
        """How long it takes, in seconds; 0: the file does not say."""
        ends = self._declared.ends
        length = len(str(args.get(self._text) or "")) if self._text else 0
        return ends.seconds + ends.per_character * length

    async def _until_end(self, job: Job, args: Mapping[str, Any]) -> None:
        seconds = self.usual_s(args)
        if seconds:
            job.expects(seconds)
        if self._ends is None:
            await asyncio.sleep(seconds)
            return
        await self._ends.wait(self._verb, self._declared.within)

    async def stop(self) -> None:
        """End it and return when that is known. Raises if nobody knows it."""
        declared = self._declared
        was_going_on = self._going_on > 0
        await asyncio.shield(self._end_later())
        if declared.action:
            ours = [goal for goal in self._robot.goals.values() if goal.action == declared.action]
            await asyncio.gather(*(self._robot.cancel(goal) for goal in ours if goal.accepted))
            return
        if declared.stop is None:
            raise DriverError(f"{self._verb} cannot be stopped", "say how with `stop`")
        if declared.stop.publish:
            await self._robot.wait_until_processed()
        elif was_going_on and declared.service:
            # The call of the verb and that of its stop go different ways: one may overtake.
            await asyncio.shield(self._end_later())
        if self._ends is not None:
            await self._ends.silence()

    async def end(self) -> None:
        """Send what ends it. Raises `DriverError` if a service refuses."""
        declared = self._declared
        if declared.action:
            await self._robot.cancel_all(declared.action)
        elif (stop := declared.stop) is not None:
            message = fill(stop.message, {})
            if stop.publish:
                await self._robot.publish(stop.publish, message)
            else:
                answer = await self._robot.call(stop.service, message, 1.0)
                _check_success(stop.service, answer)


def _check_success(name: str, answer: Json, field: str = "success") -> None:
    """An answer may say whether it succeeded, and a sentence. Raises `DriverError`."""
    if isinstance(answer, dict) and answer.get(field) is False:
        words = str(answer.get("message") or "it gives no reason")
        raise DriverError(f"{name} did not succeed: {words:.200}", "look at the robot's own node")


class EndTopic:
    """A topic that says whether something goes on."""

    def __init__(self, declared: EndDeclaration, robot: Rosbridge) -> None:
        self._declared = declared
        self._path = ValuePath.parse(declared.value)
        self._begun = self._ended = False
        #: Whether nothing goes on: nothing was begun, or it said so since.
        self._silent = True
        self._message_came = asyncio.Event()
        robot.subscribe(declared.subscribe, declared.type_, self._arrived)

    def expect(self) -> None:
        """Something is going to begin: what was said before does not count."""
        self._begun = self._declared.begun is None
        self._ended = self._silent = False

    def forget(self, may_go_on: bool) -> None:
        """What it said before does not count, because the robot is gone or nothing was begun."""
        self._silent = not may_go_on

    def _arrived(self, message: Mapping[str, Any]) -> None:
        value = self._path.of(message)
        self._silent = value == self._declared.ended
        if value == self._declared.begun:
            self._begun = True
        elif self._silent and self._begun:
            self._ended = True
        self._message_came.set()

    async def wait(self, verb: str, within: float) -> None:
        """Return when it has ended. Raises `DriverError` if the robot does not say so."""
        topic = self._declared.subscribe
        began = asyncio.get_running_loop().time()
        for what, limit in (("begun", min(_BEGINS_S, within)), ("ended", within)):
            try:
                async with asyncio.timeout_at(began + limit):
                    while not (self._ended if what == "ended" else self._begun):
                        self._message_came.clear()
                        await self._message_came.wait()
            except TimeoutError:
                raise DriverError(
                    f"{verb}: {topic} did not say within {limit:g} s that it has {what}",
                    "look at the robot's own node; check `ends` in the robot file",
                ) from None

    async def silence(self) -> None:
        """Return when it says that nothing goes on. Raises TimeoutError."""
        # The stop tells what is late; this one ends what is left of it.
        async with asyncio.timeout(2 * confirmed_stop.STOP_S):
            while not self._silent:
                self._message_came.clear()
                await self._message_came.wait()


#: A throttled reading may come so much too early, as a share of its time.
_EARLY = 0.2


class Sensor:
    """One value of one topic."""

    def __init__(
        self, name: str, declared: SensorDeclaration, context: DriverContext, robot: Rosbridge
    ) -> None:
        self._name = name
        self._declared = declared
        self._context = context
        self._path = ValuePath.parse(declared.value, declared.mounted)
        self._heard = time.monotonic()
        self._is_stale = False
        self._every = max(declared.throttle, declared.every)
        self._due = 0.0
        robot.subscribe(declared.subscribe, declared.type_, self._arrived, declared.throttle)

    def _arrived(self, message: Mapping[str, Any]) -> None:
        declared, value = self._declared, self._path.of(message)
        self._heard, self._is_stale = time.monotonic(), False
        self._context.sensor(self._name, "ok", every=self._every)
        # Something else may read the topic more often. The robot's own throttle may come early.
        throttle = declared.throttle
        if self._heard < self._due - _EARLY * throttle:
            return
        self._due = max(self._due, self._heard) + throttle
        if isinstance(value, str):
            self._context.reading(self._name, None, text=value)
            return
        number = None if value is None else float(value)
        scaled = None if number is None else number * declared.scale
        if scaled is not None and not Range(declared.low, declared.high).contains(scaled):
            scaled = None
        self._context.reading(self._name, scaled, unit=declared.unit, raw=number)

    def look(self) -> None:
        """Say it when nothing comes any more."""
        limit = max(_STALE_S, _STALE_READINGS * self._every)
        if time.monotonic() - self._heard > limit:
            self.stale(f"{self._declared.subscribe} is silent")

    def stale(self, why: str) -> None:
        """Nothing comes any more."""
        if not self._is_stale:
            self._is_stale = True
            self._context.sensor(self._name, "stale", why)
