"""Driver of the simulated robot: carries out verbs, publishes readings, simulates faults."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Awaitable, Callable, Collection, Mapping
from typing import Any

from woz_drivers.simulated import doctor, looks, verbs
from woz_drivers.simulated import settings as _settings
from woz_drivers.simulated.body import SimulatedRobotBody
from woz_drivers.simulated.camera import DrawnPerson, SimulatedCamera
from woz_drivers.simulated.faults import SLOWNESS, ActiveFaults, Fault
from woz_drivers.simulated.microphone import SimulatedMicrophone, SpeechMessages
from woz_drivers.simulated.publishing import Publisher
from woz_drivers.simulated.speech import Utterance, utterance, word_times
from woz_drivers.simulated.verbs import SimulatedMove
from woz_drivers.simulated.visitor import SimulatedVisitor
from woz_drivers.sound import emotion_sound
from woz_tui.drivers.argument_values import (
    color,
    did_you_mean,
    file,
    known_joints,
    sound_seconds,
)
from woz_tui.drivers.contract import (
    FACE_CONSENT,
    LEARN_FACE,
    SPEECH,
    DeviceLostError,
    Driver,
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
    StopReport,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.sound_feeds import NO_TALK
from woz_tui.motion.body_feeds import VOICE, VoiceLevels
from woz_tui.motion.emotions import NEUTRAL
from woz_tui.protocol.messages import FaceShown, Json
from woz_tui.system.tasks import end_tasks


class RobotTime:
    """Real time: seconds of CLOCK_MONOTONIC, pauses of asyncio."""

    def now(self) -> float:
        """Seconds on a clock that never goes back; its zero is arbitrary."""
        return time.monotonic()

    async def sleep(self, seconds: float) -> None:
        """Pause for `seconds`; zero or less only lets other tasks run."""
        await asyncio.sleep(max(0.0, seconds))


Sent = Mapping[str, Any]
#: Time in seconds from the beginning, sort and text of each mark.
Marks = tuple[tuple[float, str, str], ...]

#: How long the face takes to change, and a screen or a colour, in seconds.
FACE_SECONDS, SCREEN_SECONDS = 0.3, 0.1

#: A face is looked at so long before it is known, in seconds.
FACE_LEARNT_SECONDS = 1.0

#: A sound lasts so long whose length cannot be read, in seconds.
UNKNOWN_SOUND = 2.0

#: Joints that lag behind their track get this much longer to arrive, in seconds.
LAG = 1.5
#: Readings go out this often while something moves, in seconds.
TICK = 0.1

#: A running command looks this often whether something broke it, in seconds.
SLICE = 0.05

#: No pause is shorter, in seconds, so that rounding cannot make a loop spin.
BLINK = 0.001

#: The home pose is taken this gently when the robot is left alone, in seconds.
REST_SECONDS = 1.5

_LOST_REMEDY = "it recovers by itself when the fault is over"


class SimulatedRobot(Driver):
    """A robot without hardware."""

    Settings = _settings.SimulatedSettings
    summary = "A robot without hardware, to write and rehearse experiments"
    facts = DriverFacts(
        robot=True,
        needs="nothing",
        simulated="it is a simulation",
        stop="its joints, voice and base stand still",
        page="drivers/woz_drivers/simulated/README.md",
    )
    settings: _settings.SimulatedSettings

    def __init__(
        self,
        name: str,
        settings: _settings.SimulatedSettings,
        context: DriverContext,
        *,
        pace: RobotTime | None = None,
    ) -> None:
        super().__init__(name, settings, context)
        self._pace = pace or RobotTime()
        self._verbs = {verb.name: verb for verb in self.offer(settings).verbs}
        self._faults = ActiveFaults()
        self._body = SimulatedRobotBody(settings.joints)
        self._body.torque = settings.torque
        self._visitor = SimulatedVisitor(settings.seed) if settings.visitor else None
        self._publisher = Publisher(context, self._faults)
        self._speech_messages = SpeechMessages(name, context, self._clock_us)
        visitor = self._visitor
        self._camera = SimulatedCamera(context) if visitor else None
        self._microphone = (
            SimulatedMicrophone(name, context, self._publisher, visitor.hearing)
            if visitor
            else None
        )
        self._moves = verbs.playable_moves(settings)
        self._roles = verbs.roles(settings)
        #: Its emotion and how strong that is, as it was told; the face as it was shown last.
        self._expression = (NEUTRAL, 0.0)
        self._face: FaceShown | None = None
        #: How loud it is, for its own face, on the body's clock, and for that of another driver.
        self._voice = VoiceLevels()
        self._levels = context.feed(VOICE)
        self.volume = 0.7
        self.mode = settings.modes[0]
        self._performers: dict[str, Callable[[Job], Awaitable[Sent]]] = {
            "say": self._say,
            "utter": self._utter,
            "sound": self._sound,
            "volume": self._set_volume,
            "play": self._play,
            "pose": self._pose,
            "poses": self._poses,
            "home": self._home,
            "torque": self._torque,
            "gaze": self._gaze,
            "nudge": self._nudge,
            "hip": self._hip,
            "emotion": self._emotion,
            "eyes": self._eyes,
            "screen": self._screen,
            "drive": self._drive,
            "mode": self._mode,
            FACE_CONSENT: self._consent,
            LEARN_FACE: self._learn_face,
            "listen_room": self._learn_room,
        }
        #: Goals of gazes on their way, in degrees by joint, and whom to tell how they end.
        self._gazes: list[tuple[dict[str, float], Job, Callable[[str], None]]] = []
        self._opened = self._looked = self._pace.now()
        self._stops = {Scope.ALL: 0, Scope.DRIVE: 0}
        self._life: asyncio.Task[None] | None = None
        self._closed = False

    @classmethod
    def offer(cls, settings: _settings.SimulatedSettings) -> Offer:
        """The common verbs, as far as the joints go, and `fault`; the visitor's traces if there is
        one. It looks like a trunk with a head and a face.
        """
        return Offer(
            verbs=verbs.offered(settings),
            lacks=NO_TALK,
            sensors=verbs.sensors(settings),
            joints={
                name: Range(joint.low, joint.high, "degrees")
                for name, joint in settings.joints.items()
            },
            outline=looks.outline(settings),
        )

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Nothing can be missing; say what of the settings deserves a thought."""
        return doctor.examine(probe)

    # -- life -----------------------------------------------------------------------------------

    async def open(self) -> None:
        """Begin to tick; the hardware is found after `connect_after`."""
        now = self._opened = self._looked = self._pace.now()
        for fault in self.settings.faults:
            self._faults.add(fault.kind, fault.seconds, fault.part, now + fault.after)
        self.context.health(Health.CONNECTING, "simulated hardware")
        self._report_health(now)
        self._show_face()
        if self._microphone is not None:
            self._microphone.tell_threshold()
            self.context.sensor(SPEECH, "ready", "it reports speech by itself")
        self._life = asyncio.create_task(self._live(), name=f"{self.name} simulated")

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Carry out one command, unless a break-down prevents it."""
        verb = self._verbs.get(job.verb)
        if verb is None:
            raise RejectedError(f"the simulated robot cannot {job.verb}")
        if self._closed or self._life is None:
            raise DeviceLostError("the simulated robot is closed", "start the session again")
        if job.verb == "fault":
            return self._break(job.args)
        now = self._advance()
        self._admit(verb.lane, now)
        hang = self._faults.use_up("hang", verb.lane, now)
        if hang is not None:
            await self._hold_out(hang.seconds)
        return await self._performers[job.verb](job)

    async def stop(self, scope: Scope) -> StopReport | None:
        """Freeze at once. While `deaf`, that is confirmed late, and an unplugged part never is."""
        now = self._advance()
        self._stops[scope] += 1
        if scope is Scope.ALL:
            self._body.freeze()
        else:
            self._body.base.freeze()
        deaf = self._faults.holding("deaf", "", now)
        if deaf is not None:
            await self._pace.sleep(deaf.end - now)
        unplugged = self._faults.partial("disconnect", now)
        return StopReport(missing=(unplugged.part,)) if unplugged is not None else None

    async def rest(self) -> None:
        """Home pose, gently; `DeviceLostError` while the hardware is gone."""
        now = self._advance()
        self._admit("body", now)
        if self._body.torque:
            self._body.go(self._home_pose(), REST_SECONDS)
        stops = self._stops[Scope.ALL]
        while self._body.moving and self._stops[Scope.ALL] == stops and not self._closed:
            await self._pace.sleep(SLICE)
            self._advance()

    async def close(self) -> None:
        """End the ticking. A second time does nothing."""
        self._closed = True
        life, self._life = self._life, None
        await end_tasks(life)

    async def _live(self) -> None:
        due = self._pace.now()
        while True:
            self._tick()
            due = max(due + TICK, self._pace.now() - TICK)
            await self._pace.sleep(due - self._pace.now())

    def _tick(self) -> None:
        now = self._advance()
        self._tell_arrivals()
        self._faults.expire(now)
        self._report_health(now)
        samples = self._visitor.step(self._world(now)) if self._visitor else []
        if self._failure(now) is None:
            self._show_face()
            if not self.settings.voice_only:
                self._publisher.body(self._body, now)
            self._publisher.samples(samples, now)
            if self._microphone is not None:
                self._microphone.hear(samples, now)
        if self._visitor is not None:
            self._listen(self._visitor, now)
            self._draw(self._visitor, now)

    def _draw(self, visitor: SimulatedVisitor, now: float) -> None:
        """What its camera sees of the visitor, unless it is unplugged."""
        if self._camera is not None and self._failure(now) is None:
            person = DrawnPerson(visitor.distance, visitor.side, visitor.looking, visitor.talking)
            self._camera.show(person if visitor.present else None)

    def _listen(self, visitor: SimulatedVisitor, now: float) -> None:
        """What the microphone makes of the visitor's voice, unless it is unplugged."""
        speech, failure = visitor.speech(), self._failure(now)
        if failure is not None:
            self._speech_messages.break_off(self._world(now), failure)
            return
        self.context.sensor("loudness", "speaking" if visitor.hearing.ends.speaks else "quiet")
        self._speech_messages.publish(speech)

    def _report_health(self, now: float) -> None:
        failure = self._failure(now)
        alarm = self._faults.partial("disconnect", now) or self._faults.any("overheat", now)
        if failure is not None:
            self._body.freeze()
            self.context.health(Health.LOST, failure, _LOST_REMEDY)
        elif now < self._opened + self.settings.connect_after:
            self.context.health(Health.CONNECTING, "simulated hardware")
        elif alarm is not None:
            self.context.health(Health.FAULTED, *_alarm(alarm))
        else:
            what = "a voice" if self.settings.voice_only else f"{len(self._body.joints)} joints"
            self.context.health(Health.CONNECTED, f"simulated, {what}")
            if not self.settings.voice_only:
                self.context.mode(self.mode)

    # -- voice and sound ------------------------------------------------------------------------

    async def _say(self, job: Job) -> Sent:
        spoken = utterance(job.args["text"], self.settings.characters_per_second)
        if not spoken.text:
            raise RejectedError("nothing to say", "give the utterance a text")
        if self._visitor is not None:  # who hears it
            self._visitor.hear(self._world(self._pace.now()), spoken.seconds, spoken.text)
        await self._spend(job, spoken.seconds, marks=_word_marks(spoken))
        return {"text": spoken.text, "seconds": round(spoken.seconds, 3), "volume": self.volume}

    async def _utter(self, job: Job) -> Sent:
        """Makes no sound, but takes the time of one, and moves the mouth as that would."""
        seconds, seed = job.args["seconds"], job.args.get("seed", 0)
        valence, arousal = emotion_sound.mood(job.args)
        levels = emotion_sound.voiced_level(
            emotion_sound.emotion_sound(valence, arousal, seconds, seed), TICK
        )
        speed = self._rate(self._advance())
        self._levels.put(VoiceLevels(self.context.clock.now_us(), TICK / speed, levels))
        self._voice = VoiceLevels(round(self._body.now * 1e6), TICK, levels)
        try:
            await self._spend(job, seconds)
        finally:
            self._levels.put(VoiceLevels())
            self._voice = VoiceLevels()
            self._show_face()
        return {**job.args, "valence": valence, "arousal": arousal, "seed": seed}

    async def _sound(self, job: Job) -> Sent:
        seconds = self._sound_seconds(job.args)
        await self._spend(job, seconds)
        return {"file": job.args["file"], "seconds": round(seconds, 3)}

    def _sound_seconds(self, args: Mapping[str, Any]) -> float:
        seconds = sound_seconds(file(args, "file", self.context.folder))
        return UNKNOWN_SOUND if seconds is None else seconds

    async def _set_volume(self, job: Job) -> Sent:
        self.volume = job.args["level"]
        return {"level": self.volume}

    async def _consent(self, job: Job) -> Sent:
        name, given = _face_name(job), job.args["given"]
        if given or self._visitor is None:
            return {"name": name, "given": given}
        return {"name": name, "given": False, "deleted": self._visitor.forget_face(name)}

    async def _learn_face(self, job: Job) -> Sent:
        name = _face_name(job)
        await self._spend(job, FACE_LEARNT_SECONDS)
        visitor = self._visitor
        if visitor is None or visitor.recognised_as(name):
            raise RejectedError(f"{name} is somebody else's face", "choose another name")
        if not visitor.learn_face(name):
            raise DriverError("nobody shows a face", "wait until somebody stands before the robot")
        return {"name": name}

    # -- body -----------------------------------------------------------------------------------

    async def _play(self, job: Job) -> Sent:
        name, amplitude = job.args["move"], job.args["amplitude"]
        move = self._moves[name]
        seconds = move.seconds / job.args["speed"]
        poses = [(share * seconds, self._from_home(pose, amplitude)) for share, pose in move.keys]
        if any(goals for _, goals in poses):
            self._need_torque()
        self._body.trace(poses)
        names = {name for _, goals in poses for name in goals}
        await self._move(job, seconds, names, marks=_stroke(move, seconds))
        return {"move": name, "seconds": round(seconds, 3), "amplitude": amplitude}

    async def _pose(self, job: Job) -> Sent:
        return await self._go(job, known_joints(job.args["joints"], self._body.joints))

    async def _home(self, job: Job) -> Sent:
        return await self._go(job, self._home_pose())

    async def _poses(self, job: Job) -> Sent:
        self._need_torque()
        at = 0.0
        path = []
        for pose in job.args["poses"]:
            at += max(pose.get("seconds", 0.5), 0.02)
            path.append((at, known_joints(pose["joints"], self._body.joints)))
        self._body.trace(path)
        names = {name for _, goals in path for name in goals}
        await self._move(job, at, names)
        return {"joints": self._angles(names), "seconds": round(at, 3)}

    async def _go(self, job: Job, goals: Mapping[str, float]) -> Sent:
        self._need_torque()
        needed = self._body.go(goals, job.args["seconds"])
        await self._move(job, needed, goals)
        return {"joints": self._angles(goals), "seconds": round(needed, 3)}

    async def _move(
        self, job: Job, seconds: float, names: Collection[str], marks: Marks = ()
    ) -> None:
        """Wait until the tracks are through and the joints there; broken off, they stand still."""
        try:
            await self._spend(job, seconds, marks=marks)
            if not self._body.still(names):
                await self._spend(job, LAG, lambda: self._body.still(names))
        except (DriverError, asyncio.CancelledError):
            self._body.hold(names)
            raise

    async def _torque(self, job: Job) -> Sent:
        self._body.torque = job.args["on"]
        if not self._body.torque:
            self._body.hold(self._body.joints)
        return {"on": self._body.torque}

    async def _gaze(self, job: Job) -> Sent:
        sent = self._aim({role: at for role, at in job.args.items() if role in self._roles})
        names = [self._roles[role] for role in sent]
        goals = {name: self._body.joints[name].goal for name in names}
        self._gazes.append((goals, job, job.goes_on()))
        return sent

    def _tell_arrivals(self) -> None:
        """Tell of gazes whose joints are there, or have been given another goal."""
        going_on = []
        for goals, job, tell in self._gazes:
            if any(self._body.joints[name].goal != goal for name, goal in goals.items()):
                tell("the head has another goal now")
            elif self._body.still(goals):
                job.evidence("measured")
                tell("")
            else:
                going_on.append((goals, job, tell))
        self._gazes = going_on

    async def _nudge(self, job: Job) -> Sent:
        return self._step(job.args)

    async def _hip(self, job: Job) -> Sent:
        steps = {"hip": job.args["pitch"], "roll": job.args["roll"]}
        sent = self._step(steps)
        return {{"hip": "pitch"}.get(role, role): degrees for role, degrees in sent.items()}

    def _step(self, steps: Mapping[str, float]) -> Sent:
        for role, step in steps.items():
            if step and role not in self._roles:
                raise RejectedError(
                    f"this robot has no joint for {role}", "its robot file names its joints"
                )
        steps = {role: step for role, step in steps.items() if step}
        return self._aim(
            {role: self._body.joints[self._roles[role]].goal + step for role, step in steps.items()}
        )

    def _aim(self, angles: Mapping[str, float]) -> Sent:
        self._need_torque()
        self._body.jump({self._roles[role]: degrees for role, degrees in angles.items()})
        return {role: round(self._body.joints[self._roles[role]].goal, 2) for role in angles}

    def _from_home(self, pose: Mapping[str, float], amplitude: float) -> dict[str, float]:
        return {
            name: self.settings.joints[name].home + pose[role] * amplitude
            for role, name in self._roles.items()
            if role in pose
        }

    def _home_pose(self) -> dict[str, float]:
        """Degrees by joint of the home pose."""
        return {name: joint.home for name, joint in self.settings.joints.items()}

    def _angles(self, names: Collection[str]) -> Json:
        return {name: round(self._body.joints[name].present, 2) for name in sorted(names)}

    def _need_torque(self) -> None:
        if not self._body.torque:
            raise RejectedError("the motors are off", "switch them on first: `torque: on`")

    # -- face, screen, base ---------------------------------------------------------------------

    async def _emotion(self, job: Job) -> Sent:
        await self._spend(job, FACE_SECONDS)
        emotion, intensity = job.args["emotion"], job.args.get("intensity")
        self._expression = (emotion, 1.0 if intensity is None else intensity)
        self._show_face()
        return job.args

    def _show_face(self) -> None:
        """What the face expresses, with the mouth as its voice is; said on a change."""
        if self.settings.voice_only:
            return
        shown = looks.face(*self._expression, self._voice.at(self._body.now))
        if shown != self._face:
            self._face = shown
            self.context.show(shown)

    async def _eyes(self, job: Job) -> Sent:
        shown = color(job.args, "color")
        await self._spend(job, SCREEN_SECONDS)
        return {**job.args, "color": shown}

    async def _screen(self, job: Job) -> Sent:
        file(job.args, "file", self.context.folder)
        await self._spend(job, SCREEN_SECONDS)
        return job.args

    async def _drive(self, job: Job) -> Sent:
        x, y, turn = (job.args[name] for name in ("x", "y", "turn"))
        seconds = max(
            (x * x + y * y) ** 0.5 / self.settings.drive_speed,
            abs(turn) / self.settings.turn_speed,
        )
        if not seconds:
            raise RejectedError("no distance and no turn is given", "give x, y or turn")
        base = self._body.base
        begin = (base.x, base.y)
        base.drive(self._body.now, seconds, x, y, turn)
        try:
            await self._spend(job, seconds)
        finally:
            base.freeze()
        way = ((base.x - begin[0]) ** 2 + (base.y - begin[1]) ** 2) ** 0.5
        return {"x": x, "y": y, "turn": turn, "seconds": round(seconds, 3), "way": round(way, 3)}

    async def _mode(self, job: Job) -> Sent:
        was = self.mode
        self.mode = job.args["mode"]
        self.context.mode(self.mode)
        return {"mode": self.mode, "was": was}

    # -- time -----------------------------------------------------------------------------------

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """What it takes its time for, with words and strokes, on a robot that is not broken."""
        pace = self._rate(self._pace.now())
        match verb:
            case "say":
                spoken = utterance(args["text"], self.settings.characters_per_second)
                seconds, marks = spoken.seconds, _word_marks(spoken)
            case "play":
                move = self._moves[args["move"]]
                seconds = move.seconds / args["speed"]
                marks = _stroke(move, seconds)
            case "sound":
                seconds = self._sound_seconds(args)
                marks = ()
            case "utter":
                seconds, marks = args["seconds"], ()
            case "emotion" | "eyes" | "screen":
                seconds, marks = FACE_SECONDS if verb == "emotion" else SCREEN_SECONDS, ()
            case _:
                return Forecast()
        return Forecast(seconds / pace, tuple((at / pace, sort, text) for at, sort, text in marks))

    async def _spend(
        self,
        job: Job,
        seconds: float,
        done: Callable[[], bool] | None = None,
        marks: Marks = (),
    ) -> None:
        """Let `seconds` of the robot's time pass, less once `done`; raises what breaks it. `marks`
        are told in their time.
        """
        coming = deque(marks)
        lane = self._verbs[job.verb].lane
        scopes = (Scope.ALL, Scope.DRIVE) if self._verbs[job.verb].drives else (Scope.ALL,)
        stops = [self._stops[scope] for scope in scopes]
        now = self._advance()
        failing = self._faults.use_up("fail", lane, now) is not None
        job.expects(seconds / self._rate(now))
        began = self._body.now
        end = began + (seconds / 2 if failing else seconds)
        while self._body.now < end - 1e-9 and not (done and done()):
            while coming and began + coming[0][0] <= self._body.now + 1e-9:
                job.mark(*coming.popleft()[1:])
            due = min(end, began + coming[0][0]) if coming else end
            await self._pace.sleep(min(SLICE, max(BLINK, (due - self._body.now) / self._rate(now))))
            now = self._advance()
            self._check_link(lane, now)
            if stops != [self._stops[scope] for scope in scopes]:
                raise DriverError("cut short by the stop")
        if failing:
            raise DriverError(f"{job.verb} failed half-way (simulated fault)", "try it again")

    async def _learn_room(self, job: Job) -> Mapping[str, Json]:
        """Learn the room's noise, in ticks of the simulated world."""
        if self._microphone is None:
            raise RejectedError("a robot without a visitor has no microphone")
        self._tick()  # what was heard before does not count
        with self._microphone.lesson(job.args["seconds"]) as lesson:
            await self._spend(job, lesson.seconds, lesson.done)
            self._tick()
            return self._microphone.adopt(lesson)

    def _advance(self) -> float:
        """Move the body on to now, and return that in seconds of the pace."""
        now = self._pace.now()
        self._body.advance(self._body.now + (now - self._looked) * self._rate(self._looked))
        self._looked = now
        return now

    def _rate(self, now: float) -> float:
        slow = self._faults.holding("slow", "", now)
        return self.settings.speed / (SLOWNESS if slow else 1.0)

    def _world(self, now: float) -> float:
        return (now - self._opened) * self.settings.speed

    def _clock_us(self, world: float) -> int:
        """The session's clock at a second of the simulated world."""
        ago = self._pace.now() - (self._opened + world / self.settings.speed)
        return self.context.clock.now_us() - round(ago * 1_000_000)

    async def _hold_out(self, seconds: float) -> None:
        """Take `seconds`, cancelled or not; the cancellation counts afterwards."""
        end = self._pace.now() + seconds
        cancelled = False
        while (left := end - self._pace.now()) > 0:
            try:
                await self._pace.sleep(max(left, BLINK))
            except asyncio.CancelledError:
                cancelled = True
        if cancelled:
            raise asyncio.CancelledError

    # -- break-downs ----------------------------------------------------------------------------

    def _failure(self, now: float) -> str | None:
        return (
            "unplugged (simulated fault)" if self._faults.holding("disconnect", "", now) else None
        )

    def _admit(self, lane: str, now: float) -> None:
        if now < self._opened + self.settings.connect_after:
            raise DeviceLostError(
                "the simulated robot is not connected yet", "wait until it is there"
            )
        self._check_link(lane, now)
        if self._faults.holding("refuse", lane, now):
            raise RejectedError("refused (simulated fault)", "wait until the fault is over")

    def _check_link(self, lane: str, now: float) -> None:
        if self._faults.holding("disconnect", lane, now):
            raise DeviceLostError(f"the simulated robot's {lane} is unplugged", _LOST_REMEDY)

    def _break(self, args: Mapping[str, Any]) -> Mapping[str, Json]:
        kind, seconds, part = args["kind"], args["seconds"], args["part"]
        now = self._advance()
        if kind == "clear":
            self._faults.clear()
        else:
            parts = verbs.breakable(self.settings, kind)
            if part and part not in parts:
                raise RejectedError(f"unknown part {part!r}", did_you_mean(part, sorted(parts)))
            self._faults.add(kind, seconds, part, now)
        self._report_health(now)
        return args


def _face_name(job: Job) -> str:
    name: str = job.args["name"].strip()
    if not name:
        raise RejectedError("a face needs a name", "give a code, such as V7")
    return name


def _word_marks(spoken: Utterance) -> Marks:
    return tuple((at, "word", word) for at, word in word_times(spoken))


def _stroke(move: SimulatedMove, seconds: float) -> Marks:
    """A gesture's stroke: where it is for the first time as far from home as it goes."""
    reach = [sum(abs(degrees) for degrees in pose.values()) for _, pose in move.keys]
    if not any(reach):
        return ()
    return ((move.keys[reach.index(max(reach))][0] * seconds, "stroke", ""),)


def _alarm(fault: Fault) -> tuple[str, str]:
    if fault.kind == "overheat":
        return f"{fault.part or 'a motor'} is too hot", "let it rest"
    return f"{fault.part} does not answer", _LOST_REMEDY
