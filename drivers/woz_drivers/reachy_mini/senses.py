"""What the robot perceives, as readings: joints, a face, the direction of sound, speech."""

from __future__ import annotations

import asyncio
import math

from woz_drivers.reachy_mini.body import ReachyBody
from woz_drivers.reachy_mini.daemon_link import DaemonLink, ReachyPart
from woz_drivers.reachy_mini.pose import LIMITS
from woz_drivers.reachy_mini.settings import ReachyMiniSettings
from woz_drivers.reachy_mini.sounds import ReachySounds
from woz_drivers.sound.noticed_speech import NoticedSpeech
from woz_tui.drivers.contract import SPEECH, DriverContext, DriverError, Offer
from woz_tui.motion.body_feeds import SEEN, Sighting
from woz_tui.motion.safety import finite_number

FACE, DIRECTION = ("presence", "face.x", "face.y"), ("direction",)
#: The daemon looks for faces only while it follows them, a little at least. With this weight the
#: head does not move by it: a face at the edge of the picture turns it by a tenth of a degree.
_WATCHES = 0.003
#: Speech ends when none was noticed for so long, in seconds.
_SILENCE_S = 0.8
#: With this a face or a sound that the robot cannot tell of is said once.
_ABSENT = {
    FACE[0]: "the robot's camera is not there for its daemon",
    DIRECTION[0]: "the robot's microphones tell no direction",
}


class ReachySenses(ReachyPart):
    """Asks the daemon `settings.rate` times a second while it is there."""

    def __init__(
        self,
        link: DaemonLink,
        settings: ReachyMiniSettings,
        context: DriverContext,
        body: ReachyBody,
        sounds: ReachySounds,
    ) -> None:
        super().__init__(link, settings, context)
        self._body = body
        self._sounds = sounds
        self._seen = context.feed(SEEN)
        self._frame = 0
        #: Whether the head follows faces; None: the daemon does not look for any.
        self.tracks: bool | None = None
        #: Held while the daemon is asked to follow faces or not.
        self._switches = asyncio.Lock()
        #: The newest of these requests, which comes last.
        self._switching: asyncio.Future[None] | None = None
        self._polling = self.background("reading the robot's senses")
        self._speech = NoticedSpeech(context)
        #: When speech was heard last, in the time of the log.
        self._heard_us = 0
        self._states: dict[str, str] = {}

    @classmethod
    def offer(cls, settings: ReachyMiniSettings) -> Offer:
        """Names of the readings."""
        joints = tuple(f"{kind}.{name}" for name in LIMITS for kind in _kinds(settings))
        face = FACE if settings.looks else ()
        direction = DIRECTION if settings.direction else ()
        return Offer(
            sensors=(*joints, *face, *direction, *((SPEECH,) if settings.hears_speech else ()))
        )

    async def connected(self) -> None:
        """Look and listen, again and again."""
        self._states.clear()
        self._polling.start(self._poll())

    @property
    def may_track(self) -> bool:
        """Whether the head may follow faces: unless the daemon confirmed last that it does not."""
        newest = self._switching
        if newest is None or not newest.done() or newest.cancelled():
            return True
        return newest.exception() is not None or self.tracks is True

    async def track(self, on: bool) -> None:
        """Have the head follow faces, or leave it alone. Raises `DriverError` without a camera.

        Cancelled, it is carried out all the same, before the next one: the daemon has the request.
        """
        self._switching = asyncio.ensure_future(self._switch(on))
        await asyncio.shield(self._switching)

    async def _switch(self, on: bool) -> None:
        async with self._switches:
            await self._switch_now(on)

    async def _switch_now(self, on: bool) -> None:
        watches = on or self._settings.looks
        status = self._link.status
        if watches and not (status.silent or status.released):
            weight = 1.0 if on else _WATCHES
            answer = await self._link.ask("POST", "media/tracking/enable", json={"weight": weight})
            there = isinstance(answer, dict) and answer.get("enabled") is True
        else:
            await self._link.ask("POST", "media/tracking/disable")
            there = False
        self.tracks = on if there else None
        if on and not there:
            remedy = "start the daemon with its media"
            if status.released:
                remedy = "give it back to the daemon: release_media: false"
            raise DriverError(_ABSENT[FACE[0]], remedy)

    def lost(self) -> None:
        """Nobody knows whether they speak on."""
        self._polling.cancel()
        self._speech.end("the robot is not connected", self._heard_us)
        for sensor in ("presence", "direction", SPEECH):
            if sensor in self._states:
                self._state(sensor, "stale", "the robot is not connected")

    async def close(self) -> None:
        """Look no more; the head is left where it is."""
        await super().close()
        if self._switching is not None:
            await asyncio.wait({self._switching}, timeout=0.5)
            self._switching.cancel()
        self._speech.end("the session ended", self._heard_us)

    async def _poll(self) -> None:
        while True:
            self._tell_joints()
            for asks, fails in ((self._hear, self._unheard), (self._see, self._unseen)):
                try:
                    await asks()
                except DriverError as error:
                    fails("stale", error.what)
            await asyncio.sleep(1 / self._settings.rate)

    def _tell_joints(self) -> None:
        if not self._link.tells_poses:
            return
        poses = {"joint": self._link.pose, "setpoint": self._body.setpoint}
        for kind in _kinds(self._settings):
            for name, at in poses[kind].items():
                unit = "mm" if LIMITS[name].high <= 30 else "deg"
                self._context.reading(f"{kind}.{name}", round(at, 2), unit=unit)

    # -- sound -----------------------------------------------------------------------------------

    async def _hear(self) -> None:
        if not self._settings.direction:
            return
        match await self._link.ask("GET", "state/doa"):
            case {"angle": int() | float() as angle, "speech_detected": bool(speech)}:
                # On the wire 0 is left, a quarter turn ahead and half a turn right.
                degrees = 90.0 - math.degrees(angle)
                self._state(DIRECTION[0], "ok")
                speaks = speech and not self._sounds.heard
                if speaks:
                    self._context.reading(DIRECTION[0], round(degrees, 1), unit="deg", raw=angle)
                if self._settings.hears_speech:
                    self._state(SPEECH, "ready", "the microphones tell when somebody speaks")
                    self._hear_speech(speaks)
            case None:
                self._unheard("silent", _ABSENT[DIRECTION[0]])
            case other:
                raise DriverError(f"the direction of sound is {repr(other)[:60]}")

    def _unheard(self, state: str, why: str) -> None:
        """Nobody knows whether they speak on: after a while they do not."""
        self._state(DIRECTION[0], state, why)
        if self._settings.hears_speech:
            self._state(SPEECH, state, why)
            self._hear_speech(False, why)

    def _hear_speech(self, speaks: bool, why: str = "") -> None:
        now = self._speech.now_us
        if speaks:
            self._heard_us = now
            self._speech.begin()
        elif now - self._heard_us > _SILENCE_S * 1e6:
            self._speech.end(why, self._heard_us)

    # -- faces -----------------------------------------------------------------------------------

    async def _see(self) -> None:
        if not self._settings.looks:
            return
        if self.tracks is None or self._link.status.released:
            self._unseen("silent", _ABSENT[FACE[0]])
            return
        match await self._link.ask("GET", "media/tracking/face"):
            case {"face_target": {"detected": bool(detected), **where}}:
                x, y = finite_number(where.get("x")), finite_number(where.get("y"))
                seen = detected and x is not None and y is not None
                if not seen:
                    x = y = None
                self._state(FACE[0], "ok")
                for sensor, value in zip(FACE, (float(seen), x, y), strict=True):
                    self._context.reading(sensor, value)
                # For a body whose `camera` this driver is.
                self._frame += 1
                self._seen.put(Sighting(self._context.clock.now_us(), self._frame, x, y))
            case other:
                raise DriverError(f"the tracked face is {repr(other)[:60]}")

    def _unseen(self, state: str, why: str) -> None:
        self._state(FACE[0], state, why)

    def _state(self, sensor: str, state: str, why: str = "") -> None:
        if self._states.get(sensor) != state:
            self._states[sensor] = state
            self._context.sensor(sensor, state, why)


def _kinds(settings: ReachyMiniSettings) -> tuple[str, ...]:
    """A body that is followed tells the setpoints itself."""
    return ("joint",) if settings.follows else ("joint", "setpoint")
