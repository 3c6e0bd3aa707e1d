"""The driver: hands verbs to parts, stops all of them at once, and tells what the robot has."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Mapping
from typing import Any

from woz_drivers.furhat import doctor
from woz_drivers.furhat.camera import FurhatCamera
from woz_drivers.furhat.face import FurhatFace
from woz_drivers.furhat.head import FurhatHead
from woz_drivers.furhat.hearing import FurhatHearing
from woz_drivers.furhat.light import FurhatLight
from woz_drivers.furhat.link import FurhatLink
from woz_drivers.furhat.moves import FACE_PARAMETERS, offered_moves
from woz_drivers.furhat.parts import FurhatPart
from woz_drivers.furhat.senses import FurhatSenses
from woz_drivers.furhat.settings import FurhatSettings
from woz_drivers.furhat.speech import FurhatSpeech
from woz_tui.drivers import confirmed_stop
from woz_tui.drivers.background import Background, BackgroundTasks
from woz_tui.drivers.confirmed_stop import confirmed_within, succeeded
from woz_tui.drivers.contract import (
    DeviceLostError,
    Driver,
    DriverContext,
    DriverError,
    DriverFacts,
    Finding,
    Forecast,
    Job,
    Probe,
    RejectedError,
    Scope,
    StopReport,
    Verb,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_verbs import known_by
from woz_tui.drivers.sound_feeds import TALK_UNWRITTEN
from woz_tui.protocol.messages import Json, SettingsShown
from woz_tui.protocol.robot_outline import RobotOutline, Setting
from woz_tui.system.tasks import wait_at_most

#: How often it is looked what has changed by itself, in seconds.
_LOOK_S = 1.0

_PARTS: tuple[type[FurhatPart], ...] = (
    *(FurhatSpeech, FurhatFace, FurhatHead, FurhatLight),
    *(FurhatHearing, FurhatSenses, FurhatCamera),
)
#: Verbs of whose end the robot tells; faces and lights only go out to it.
_TOLD = ("say", "sound", "voice", "gaze", "nudge", "follow", "listen", "picture", "talk")
_SETTINGS = (
    Setting(
        name="voice",
        section="Voice",
        label="Voice",
        verb="voice",
        argument="name",
        help="name of a voice, or a part of it",
    ),
    Setting(
        name="volume",
        section="Voice",
        label="Volume",
        verb="volume",
        argument="level",
        kind="number",
        help="how loud it is",
    ),
    Setting(
        name="listening",
        section="Voice",
        label="Listens",
        verb="listen",
        argument="on",
        kind="flag",
        help="recognises what is said, but not while it speaks itself",
    ),
    Setting(
        name="face",
        section="Face",
        label="Face",
        verb="face",
        argument="face",
        help="mask and character, such as adult - Isabel",
    ),
    Setting(
        name="eyes",
        section="Face",
        label="LED ring",
        verb="eyes",
        argument="color",
        kind="color",
        help="a name or #rrggbb; off",
    ),
    Setting(
        name="attends",
        section="Face",
        label="Looks at",
        verb="follow",
        argument="user",
        help="closest, nobody, or a user's id",
    ),
    Setting(name="seen", section="Face", label="Sees", help="who is there, by id"),
)


class Furhat(Driver):
    """A Furhat over its Realtime API, or a simulated one."""

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
    settings: FurhatSettings

    def __init__(self, name: str, settings: FurhatSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._link = FurhatLink(settings, context, get_ready=self._get_ready, on_lost=self._lost)
        about = (self._link, settings, context)
        head = FurhatHead(*about)
        self._hearing = FurhatHearing(*about)
        self._parts: tuple[FurhatPart, ...] = (
            *(FurhatSpeech(*about), FurhatFace(*about, head), head, FurhatLight(*about)),
            *(self._hearing, FurhatSenses(*about, head), FurhatCamera(*about)),
        )
        self._by_verb = {verb.name: part for part in self._parts for verb in part.verbs(settings)}
        self._settings_task = Background("reading what changes by itself", context)
        self._shown: dict[str, Json] = {}
        self._closed = False

    @classmethod
    def verbs(cls, settings: FurhatSettings) -> tuple[Verb, ...]:
        """Speech, sounds, gestures, gaze, expression, light, listening, camera; the robot tells of
        the end of some alone.
        """
        verbs = (verb for part in _PARTS for verb in part.verbs(settings))
        return tuple(known_by("reported", verbs, *_TOLD))

    @classmethod
    def lacks(cls, settings: FurhatSettings) -> Mapping[str, str]:
        """A live voice, unless the file says so."""
        return {} if settings.talk is not None else TALK_UNWRITTEN

    @classmethod
    def sensors(cls, settings: FurhatSettings) -> tuple[str, ...]:
        """People, loudness, speech."""
        return tuple(sensor for part in _PARTS for sensor in part.sensors(settings))

    @classmethod
    def joints(cls, settings: FurhatSettings) -> Mapping[str, Range]:
        """Face parameters, 0 to 1; those of neck and gaze in degrees."""
        return FACE_PARAMETERS

    @classmethod
    def outline(cls, settings: FurhatSettings) -> dict[str, Json]:
        """Settings that can be shown and changed, gestures, the camera."""
        moves = list(offered_moves(settings.gestures))
        return RobotOutline(settings=list(_SETTINGS), moves=moves, camera=True).as_json()

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Look whether the robot gives access, and what it has, without moving anything."""
        return await doctor.examine(probe)

    async def open(self) -> None:
        """Begin to look for the robot."""
        self._link.start()

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """As its part says; speech and the robot's own gestures about so long."""
        part = self._by_verb.get(verb)
        return Forecast() if part is None else await part.predict(verb, args)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Carry out a verb by its part. Raises `DeviceLostError` while no robot is connected."""
        part = self._by_verb.get(job.verb)
        if part is None and not self._closed:
            raise RejectedError(f"a Furhat cannot {job.verb!r}")
        self._link.need()
        if part is None:
            raise DeviceLostError(f"{self._link.shown} was let go", "start the session again")
        try:
            return await part.perform(job)
        finally:
            self._show()

    async def stop(self, scope: Scope) -> StopReport | None:
        """End speech and gestures and hold the gaze; each confirms with the robot's own event."""
        if scope is not Scope.ALL:
            return None
        for part in self._parts:
            part.hold()
        if not self._link.ready:
            return None
        loop = asyncio.get_running_loop()
        until = loop.time() + confirmed_stop.STOP_S
        tasks = BackgroundTasks("a stop")
        halts = [tasks.start(part.halt()) for part in self._parts]
        try:
            await wait_at_most(halts, until - loop.time(), confirmed_stop.AGAIN_S)
            # The robot takes requests in order: with this answer it has taken those of the stop.
            taken = tasks.start(self._link.authenticate(confirmed_stop.STOP_S))
            unknown = loop.create_future()  # what would end a part that has not said it yet
            ends = {
                part.name: [taken, halt, *(halt.result() if succeeded(halt) else (unknown,))]
                for part, halt in zip(self._parts, halts, strict=True)
                if part.name
            }
            return await confirmed_within(until - loop.time(), ends)
        finally:
            tasks.cancel()

    async def rest(self) -> None:
        """A neutral face that looks at nobody."""
        if self._link.ready:
            with contextlib.suppress(DeviceLostError):
                await self._link.send("request.speak.stop")
                await self._link.send("request.face.reset")
                await self._link.send("request.attend.nobody")

    async def close(self) -> None:
        """End everything of this driver; the robot stays as it is."""
        self._closed = True
        self._by_verb = {}
        await self._settings_task.close()
        for part in self._parts:
            await part.close()
        await self._link.close()

    # -- the line --------------------------------------------------------------------------------

    async def _get_ready(self) -> str:
        """Have every part apply what was asked for; what the robot did not take is told."""
        for part in self._parts:
            try:
                await part.connected()
            except DeviceLostError:
                raise
            except DriverError as error:
                self.context.notice("warning", error.what, error.remedy)
        self._settings_task.start(self._watch_settings())
        self._show()
        words = [self._link.shown, *(str(self._shown.get(name, "")) for name in ("voice", "face"))]
        return ", ".join(word for word in words if word)

    def _lost(self) -> None:
        if self._closed:
            return
        self._settings_task.cancel()
        for part in self._parts:
            part.lost()

    async def _watch_settings(self) -> None:
        """What changes by itself: whom it looks at, whether it listens."""
        while True:
            await asyncio.sleep(_LOOK_S)
            with contextlib.suppress(DeviceLostError):  # until it is back this is begun anew
                await self._hearing.go_on()
            self._show()

    def _show(self) -> None:
        """The settings as the robot has them, if they have changed."""
        if self._closed:
            return
        shown: dict[str, Json] = {}
        for part in self._parts:
            shown |= part.shown()
        if shown != self._shown:
            self._shown = shown
            self.context.show(SettingsShown(values=shown))
