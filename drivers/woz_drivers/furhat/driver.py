"""The driver: which parts a Furhat is made of, and what it does when it comes and goes."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

from woz_drivers.furhat import doctor
from woz_drivers.furhat.camera import FurhatCamera
from woz_drivers.furhat.face import FurhatFace
from woz_drivers.furhat.head import FurhatHead
from woz_drivers.furhat.hearing import FurhatHearing
from woz_drivers.furhat.light import FurhatLight
from woz_drivers.furhat.link import FurhatLink
from woz_drivers.furhat.senses import FurhatSenses
from woz_drivers.furhat.settings import FurhatSettings
from woz_drivers.furhat.speech import FurhatSpeech
from woz_tui.drivers import confirmed_stop
from woz_tui.drivers.background import Background
from woz_tui.drivers.contract import (
    KEPT,
    LEAVES,
    DeviceLostError,
    DriverContext,
    DriverFacts,
    Finding,
    Offer,
    Probe,
)
from woz_tui.drivers.robot_parts import RobotOfParts
from woz_tui.drivers.robot_verbs import known_by

#: How often it is looked what has changed by itself, in seconds.
_LOOK_S = 1.0

#: Verbs of whose end the robot tells; faces and lights only go out to it.
_TOLD = ("say", "sound", "utter", "voice", "gaze", "nudge", "follow", "listen", "picture", "talk")


class Furhat(RobotOfParts[FurhatLink, FurhatSettings]):
    """A Furhat over its Realtime API, or a simulated one."""

    PARTS = (
        *(FurhatSpeech, FurhatFace, FurhatHead, FurhatLight),
        *(FurhatHearing, FurhatSenses, FurhatCamera),
    )
    called = "a Furhat"
    Settings = FurhatSettings
    summary = "A Furhat by its Realtime API, or a simulated one"
    facts = DriverFacts(
        robot=True,
        needs="the robot's address, and the key of its Realtime API",
        simulated="address: simulated, with a visitor",
        stop="the robot's own events, by part: speech, gesture, gaze",
        page="docs/how-to/furhat.md",
        example="address: simulated",
        shown=("stop", "loss", "return"),
    )

    def __init__(self, name: str, settings: FurhatSettings, context: DriverContext) -> None:
        link = FurhatLink(settings, context, get_ready=self._get_ready, on_lost=self._lost)
        about = (link, settings, context)
        head = FurhatHead(*about)
        self._hearing = FurhatHearing(*about)
        parts = (
            *(FurhatSpeech(*about), FurhatFace(*about, head), head, FurhatLight(*about)),
            *(self._hearing, FurhatSenses(*about, head), FurhatCamera(*about)),
        )
        super().__init__(name, settings, context, link, parts)
        self._settings_task = Background("reading what changes by itself", context)

    @classmethod
    def people_data(cls, settings: FurhatSettings) -> Iterable[tuple[str, str]]:
        if settings.listening.on:
            yield KEPT, "what people say, as the robot understands it, in the log"
            yield LEAVES, "this file does not say which service the robot's own recogniser asks"

    @classmethod
    def offer(cls, settings: FurhatSettings) -> Offer:
        """Speech, sounds, gestures, gaze, expression, light, listening, camera; the robot tells of
        the end of some alone.
        """
        offered = super().offer(settings)
        return replace(offered, verbs=tuple(known_by("reported", offered.verbs, *_TOLD)))

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Look whether the robot gives access, and what it has, without moving anything."""
        return await doctor.examine(probe)

    def _taken(self) -> Sequence[asyncio.Future[Any]]:
        """The robot takes requests in order: with this answer it has taken those of the stop."""
        return (self._stops.start(self._link.authenticate(confirmed_stop.STOP_S)),)

    async def rest(self) -> None:
        """A neutral face that looks at nobody."""
        if self._link.ready:
            with contextlib.suppress(DeviceLostError):
                await self._link.send("request.speak.stop")
                await self._link.send("request.face.reset")
                await self._link.send("request.attend.nobody")

    async def _end_own(self) -> None:
        await self._settings_task.close()

    async def _get_ready(self) -> str:
        await self._connected()
        self._settings_task.start(self._watch_settings())
        words = [self._link.shown, *(str(self._shown.get(name, "")) for name in ("voice", "face"))]
        return ", ".join(word for word in words if word)

    def _lost(self) -> None:
        self._settings_task.cancel()
        super()._lost()

    async def _watch_settings(self) -> None:
        """What changes by itself: whom it looks at, whether it listens."""
        while True:
            await asyncio.sleep(_LOOK_S)
            with contextlib.suppress(DeviceLostError):  # until it is back this is begun anew
                await self._hearing.go_on()
            self._show()
