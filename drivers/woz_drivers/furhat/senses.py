"""Who stands before a Furhat, how loud it is there, and what its microphone hears."""

from __future__ import annotations

import asyncio
import base64
import binascii
import contextlib
import math

from woz_drivers.furhat.head import FurhatHead, direction_of
from woz_drivers.furhat.link import FurhatLink, FurhatPart
from woz_drivers.furhat.realtime_events import AudioData, DetectedUser, UsersData
from woz_drivers.furhat.settings import FurhatSettings
from woz_drivers.sound import pcm_audio
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError, Offer
from woz_tui.drivers.sound_feeds import WIDTH, SoundOffer

#: Of people, as the engagement model calls them.
PEOPLE = ("presence", "people", "distance", "direction", "gaze")
#: Ten readings a second are plenty, in microseconds; what comes in between waits so long.
_APART_US, _LOOK_S = 90_000, 0.1
#: When nothing was told of people for so long they are asked for, in seconds.
_QUIET_S = 1.0
#: From this share on somebody counts as looking at the robot.
_LOOKS = 0.5
#: Nobody is seen farther away, in metres.
_REACH_M = 30.0
_RATE = 16000


class FurhatSenses(FurhatPart):
    """People by the robot's camera, loudness by its microphone."""

    def __init__(
        self,
        link: FurhatLink,
        settings: FurhatSettings,
        context: DriverContext,
        head: FurhatHead,
    ) -> None:
        super().__init__(link, settings, context)
        self._head = head
        self._published_us = {"people": -_APART_US, "loudness": -_APART_US}
        self._heard_us = 0
        #: What was told of people too soon after what was published.
        self._waiting: UsersData | None = None
        self._watching = self.background("reading who is there")
        self._offer = SoundOffer(context, _RATE)
        self._following = self.background("the live sound")
        link.on(UsersData, self._users)
        link.on(AudioData, self._sound)

    @classmethod
    def offer(cls, settings: FurhatSettings) -> Offer:
        """What is read with these settings."""
        senses = settings.senses
        return Offer(
            sensors=(*(PEOPLE if senses.users else ()), *(("loudness",) if senses.loudness else ()))
        )

    async def connected(self) -> None:
        """Have the robot tell who is there, and what it hears."""
        if self._settings.senses.users:
            await self._link.send("request.users.start")
            self._heard_us = self._context.clock.now_us()
            self._watching.start(self._watch())
        if self._settings.senses.loudness:
            await self._send_sound(True)
        else:
            self._following.start(self._follow_listeners())

    def lost(self) -> None:
        """Nothing is known any more."""
        self._watching.cancel()
        self._following.cancel()
        self._waiting = None
        self._head.sees({})
        self._stale(self.offer(self._settings).sensors, "the robot is not connected")

    def _stale(self, sensors: tuple[str, ...], why: str) -> None:
        for sensor in sensors:
            self._context.sensor(sensor, "stale", why)

    async def _watch(self) -> None:
        """Publish what had to wait; ask a robot that tells of people on a change alone."""
        while True:
            await asyncio.sleep(_LOOK_S)
            if self._waiting is not None:
                self._publish(self._waiting)
            if self._context.clock.now_us() - self._heard_us < _QUIET_S * 1e6:
                continue
            try:
                await self._link.ask("request.users.once", UsersData)
            except DriverError as error:
                self._stale(PEOPLE, error.what)

    # -- people --------------------------------------------------------------------------------

    def _users(self, data: UsersData) -> None:
        self._heard_us = self._context.clock.now_us()
        places = {str(user.id): place for user in data.users if (place := user.place) is not None}
        self._head.sees(places)
        if not self._settings.senses.users:
            return
        if self._heard_us - self._published_us["people"] < _APART_US:
            self._waiting = data
        else:
            self._publish(data)

    def _publish(self, data: UsersData) -> None:
        self._waiting = None
        self._published_us["people"] = self._context.clock.now_us()
        nearest = min(data.users, key=_metres, default=None)
        says = nearest is None or nearest.attending is not None
        for sensor in PEOPLE:
            if sensor != "gaze" or says:
                self._context.sensor(sensor, "ok")
        reading = self._context.reading
        reading("presence", float(bool(data.users)))
        reading("people", float(len(data.users)))
        if nearest is None:
            reading("distance", None, unit="m")
            reading("gaze", 0.0)
            return
        metres = _metres(nearest)
        reading("distance", round(metres, 3) if metres < _REACH_M else None, unit="m")
        place = nearest.place
        if place is not None:
            yaw, _ = direction_of(place, mirrored=self._settings.attention.mirrored)
            reading("direction", round(yaw, 1), unit="deg")
        if nearest.attending is None:
            self._context.sensor("gaze", "stale", "the robot does not say whether they look")
        else:
            reading("gaze", float(nearest.attending >= _LOOKS), raw=float(nearest.attending))

    # -- sound ---------------------------------------------------------------------------------

    async def _send_sound(self, on: bool) -> None:
        """Have it send what its microphone hears, or no more."""
        if on:
            shape = {"sample_rate": _RATE, "microphone": True, "speaker": False}
            await self._link.send("request.audio.start", **shape)
        else:
            await self._link.send("request.audio.stop")

    async def _follow_listeners(self) -> None:
        """Its sound is wanted only while somebody listens live."""
        sends = False
        with contextlib.suppress(DeviceLostError):  # until it is back this is begun anew
            while True:
                if self._offer.wanted is not sends:
                    sends = not sends
                    await self._send_sound(sends)
                await asyncio.sleep(_LOOK_S)

    def _sound(self, data: AudioData) -> None:
        with contextlib.suppress(binascii.Error):
            pcm = base64.b64decode(data.microphone or "")
            pcm = pcm[: len(pcm) // WIDTH * WIDTH]
            if self._offer.wanted:
                self._offer.add(pcm)
            if self._settings.senses.loudness and pcm:
                self._publish_loudness(pcm)

    def _publish_loudness(self, pcm: bytes) -> None:
        now_us = self._context.clock.now_us()
        if now_us - self._published_us["loudness"] >= _APART_US:
            self._published_us["loudness"] = now_us
            self._context.sensor("loudness", "ok")
            samples = pcm_audio.decode(pcm, "S16_LE", 1)
            self._context.reading("loudness", round(pcm_audio.rms(samples), 6))


def _metres(user: DetectedUser) -> float:
    """How far away somebody is; who has no distance comes last."""
    if user.distance is not None:
        found = user.distance
    else:
        place = user.place
        found = _REACH_M if place is None else math.hypot(place.x, place.y, place.z)
    return found if 0 < found < _REACH_M else _REACH_M
