"""The simulated robot as a driver: its life, its break-downs, and time passing under both."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Mapping

from woz_drivers import room
from woz_drivers.simulated import doctor, values, verbs
from woz_drivers.simulated import settings as _settings
from woz_drivers.simulated.body import Body
from woz_drivers.simulated.ears import Ears
from woz_drivers.simulated.faults import MEANING, SLOWNESS, Fault, Faults
from woz_drivers.simulated.pace import Pace
from woz_drivers.simulated.performance import Performance
from woz_drivers.simulated.publishing import Publisher
from woz_drivers.simulated.sight import Person, Sight
from woz_drivers.simulated.telling import Teller
from woz_drivers.simulated.visitor import Visitor
from woz_tui.core.driver import (
    SPEECH,
    Driver,
    DriverError,
    Finding,
    Health,
    Job,
    Lost,
    Outlet,
    Probe,
    Rejected,
    Scope,
    StopReport,
    Verb,
)
from woz_tui.core.fields import Range
from woz_tui.core.messages import Json

#: Readings go out this often while something moves, in seconds.
TICK = 0.1

#: A running command looks this often whether something broke it, in seconds.
SLICE = 0.05

#: No pause is shorter, in seconds, so that rounding cannot make a loop spin.
BLINK = 0.001

#: The home pose is taken this gently when the robot is left alone, in seconds.
REST_SECONDS = 1.5

_LOST_REMEDY = "it comes back by itself; `fault: clear` brings it back at once"


class SimulatedRobot(Driver):
    """A robot without hardware."""

    Settings = _settings.Settings
    summary = "A robot without hardware, to write and rehearse experiments"
    settings: _settings.Settings

    def __init__(
        self, name: str, settings: _settings.Settings, outlet: Outlet, *, pace: Pace | None = None
    ) -> None:
        super().__init__(name, settings, outlet)
        self._pace = pace or Pace()
        self._verbs = {verb.name: verb for verb in self.verbs(settings)}
        self._faults = Faults()
        self._body = Body(settings.joints)
        self._body.torque = settings.torque
        self._visitor = Visitor(settings.seed) if settings.visitor else None
        self._publisher = Publisher(outlet, self._faults)
        self._teller = Teller(name, outlet, self._clock_us)
        visitor = self._visitor
        self._sight = Sight(outlet) if visitor else None
        self._ears = Ears(name, outlet, self._publisher, visitor.hearing) if visitor else None
        self._performance = Performance(settings, self._body, outlet.folder, self)
        self._opened = self._looked = self._pace.now()
        self._stops = {Scope.ALL: 0, Scope.DRIVE: 0}
        self._life: asyncio.Task[None] | None = None
        self._closed = False

    @classmethod
    def verbs(cls, settings: _settings.Settings) -> tuple[Verb, ...]:
        """The common verbs, as far as the joints go, and `fault`."""
        return verbs.offered(settings)

    @classmethod
    def sensors(cls, settings: _settings.Settings) -> tuple[str, ...]:
        """Joints, base, and the visitor's traces if there is one."""
        return verbs.sensors(settings)

    @classmethod
    def joints(cls, settings: _settings.Settings) -> Mapping[str, Range]:
        """Joints with their limits in degrees, so that `woz check` finds impossible poses."""
        return {
            name: Range(joint.low, joint.high, "degrees") for name, joint in settings.joints.items()
        }

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
        self.outlet.health(Health.CONNECTING, "simulated hardware")
        self._tell_health(now)
        if self._ears is not None:
            self._ears.tell_threshold()
            self.outlet.sensor(SPEECH, "ready", "it tells itself when somebody speaks")
        self._life = asyncio.create_task(self._live(), name=f"{self.name} simulated")

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Carry out one command, unless a break-down prevents it."""
        verb = self._verbs.get(job.verb)
        if verb is None:
            raise Rejected(f"the simulated robot does not know {job.verb!r}")
        if self._closed or self._life is None:
            raise Lost("the simulated robot is closed", "start the session again")
        if job.verb == "fault":
            return self._break(job.args)
        now = self._advance()
        self._admit(verb.lane, now)
        hang = self._faults.use_up("hang", verb.lane, now)
        if hang is not None:
            await self._hold_out(hang.seconds)
        return await self._performance.act(job)

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
        """Home pose, gently; `Lost` while the hardware is gone."""
        now = self._advance()
        self._admit("body", now)
        if self._body.torque:
            self._body.go(self._performance.home_pose(), REST_SECONDS)
        self._performance.emotion = self.settings.emotions[0]
        stops = self._stops[Scope.ALL]
        while self._body.moving and self._stops[Scope.ALL] == stops and not self._closed:
            await self._pace.sleep(SLICE)
            self._advance()

    async def close(self) -> None:
        """End the ticking. A second time does nothing."""
        self._closed = True
        life, self._life = self._life, None
        if life is not None:
            life.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await life

    async def _live(self) -> None:
        due = self._pace.now()
        while True:
            self._tick()
            due = max(due + TICK, self._pace.now() - TICK)
            await self._pace.sleep(due - self._pace.now())

    def _tick(self) -> None:
        now = self._advance()
        self._faults.expire(now)
        self._tell_health(now)
        samples = self._visitor.step(self._world(now)) if self._visitor else []
        if self._gone(now) is None:
            if not self.settings.voice_only:
                self._publisher.body(self._body, now)
            self._publisher.samples(samples, now)
            if self._ears is not None:
                self._ears.hear(samples, now)
        if self._visitor is not None:
            self._listen(self._visitor, now)
            self._look(self._visitor, now)

    def _look(self, visitor: Visitor, now: float) -> None:
        """What its camera sees of the visitor, unless it is unplugged."""
        if self._sight is not None and self._gone(now) is None:
            seen = Person(visitor.distance, visitor.side, visitor.looking, visitor.talking)
            self._sight.look(seen if visitor.present else None)

    def _listen(self, visitor: Visitor, now: float) -> None:
        """What the microphone makes of the visitor's voice, unless it is unplugged."""
        speech, gone = visitor.speech(), self._gone(now)
        if gone is not None:
            self._teller.break_off(self._world(now), gone)
            return
        self.outlet.sensor("loudness", "speaking" if visitor.hearing.speaks else "quiet")
        self._teller.tell(speech)

    def _tell_health(self, now: float) -> None:
        gone = self._gone(now)
        alarm = self._faults.partial("disconnect", now) or self._faults.any("overheat", now)
        if gone is not None:
            self._body.freeze()
            self.outlet.health(Health.LOST, gone, _LOST_REMEDY)
        elif now < self._opened + self.settings.connect_after:
            self.outlet.health(Health.CONNECTING, "simulated hardware")
        elif alarm is not None:
            self.outlet.health(Health.FAULTED, *_alarm(alarm))
        else:
            what = "a voice" if self.settings.voice_only else f"{len(self._body.joints)} joints"
            self.outlet.health(Health.CONNECTED, f"simulated, {what}")
            if not self.settings.voice_only:
                self.outlet.mode(self._performance.mode)

    # -- time -----------------------------------------------------------------------------------

    async def spend(self, job: Job, seconds: float, done: Callable[[], bool] | None = None) -> None:
        """Let `seconds` of the robot's time pass, less once `done`; raises what breaks it."""
        lane = self._verbs[job.verb].lane
        scopes = (Scope.ALL, Scope.DRIVE) if self._verbs[job.verb].drives else (Scope.ALL,)
        stops = [self._stops[scope] for scope in scopes]
        now = self._advance()
        failing = self._faults.use_up("fail", lane, now) is not None
        job.expects(seconds / self._rate(now))
        end = self._body.now + (seconds / 2 if failing else seconds)
        while self._body.now < end - 1e-9 and not (done and done()):
            await self._pace.sleep(min(SLICE, max(BLINK, (end - self._body.now) / self._rate(now))))
            now = self._advance()
            self._check_link(lane, now)
            if stops != [self._stops[scope] for scope in scopes]:
                raise DriverError("cut short by the stop")
        if failing:
            raise DriverError(f"{job.verb} failed half-way, as asked for", "try it again")

    def mode_changed(self, mode: str) -> None:
        """Tell which mode holds now."""
        self.outlet.mode(mode)

    def spoke(self, text: str, seconds: float) -> None:
        """A visitor hears it."""
        if self._visitor is not None:
            self._visitor.hear(self._world(self._pace.now()), seconds, text)

    def learn_face(self, name: str) -> None:
        """The present visitor is called `name` from now on."""
        visitor = self._visitor
        if visitor is None or visitor.recognised_as(name):
            raise Rejected(f"{name} is somebody else's face", "choose another name")
        if not visitor.learn_face(name):
            raise DriverError("nobody shows a face", "wait until somebody stands before the robot")

    async def learn_room(self, job: Job) -> Mapping[str, Json]:
        """Learn the room's noise, in ticks of the simulated world."""
        if self._ears is None:
            raise Rejected("a robot without a visitor has no microphone")
        self._tick()  # what was heard before does not count
        with self._ears.lesson(room.seconds(job.args)) as lesson:
            await self.spend(job, lesson.seconds, lesson.done)
            self._tick()
            return self._ears.adopt(lesson)

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
        return self.outlet.clock.now_us() - round(ago * 1_000_000)

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

    def _gone(self, now: float) -> str | None:
        return "unplugged on purpose" if self._faults.holding("disconnect", "", now) else None

    def _admit(self, lane: str, now: float) -> None:
        if now < self._opened + self.settings.connect_after:
            raise Lost("the simulated robot is still being looked for", "wait until it is there")
        self._check_link(lane, now)
        if self._faults.holding("refuse", lane, now):
            raise Rejected("refused, as asked for", "wait, or `fault: clear`")

    def _check_link(self, lane: str, now: float) -> None:
        if self._faults.holding("disconnect", lane, now):
            raise Lost(f"the simulated robot's {lane} is unplugged", _LOST_REMEDY)

    def _break(self, args: Mapping[str, Json]) -> Mapping[str, Json]:
        kind = values.word(args, "kind", MEANING)
        seconds = values.positive(args, "seconds", 5.0)
        part = values.text(args, "part")
        now = self._advance()
        if kind == "clear":
            self._faults.clear()
        else:
            if part:
                values.word({"part": part}, "part", verbs.breakable(self.settings, kind))
            self._faults.add(kind, seconds, part, now)
        self._tell_health(now)
        return {"kind": kind, "seconds": seconds, "part": part}


def _alarm(fault: Fault) -> tuple[str, str]:
    if fault.kind == "overheat":
        return f"{fault.part or 'a motor'} is too hot", "let it rest"
    return f"{fault.part} does not answer", _LOST_REMEDY
