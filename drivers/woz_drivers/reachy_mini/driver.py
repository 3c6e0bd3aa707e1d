"""The driver: which parts a Reachy Mini is made of, and what it does when it comes and goes."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Iterable, Mapping
from dataclasses import replace

from woz_drivers.reachy_mini import doctor
from woz_drivers.reachy_mini.body import ReachyBody
from woz_drivers.reachy_mini.daemon_link import DaemonLink
from woz_drivers.reachy_mini.motion import ReachyMotion
from woz_drivers.reachy_mini.moves import data_set_and_name
from woz_drivers.reachy_mini.senses import ReachySenses
from woz_drivers.reachy_mini.settings import ReachyMiniSettings
from woz_drivers.reachy_mini.sounds import ReachySounds
from woz_drivers.speech.settings import voice_remarks
from woz_drivers.speech.voice_list import voices
from woz_tui.drivers.contract import (
    UNKNOWN,
    DeviceLostError,
    DriverContext,
    DriverError,
    DriverFacts,
    Finding,
    Offer,
    Probe,
    RejectedError,
    VoiceFound,
    Written,
)
from woz_tui.drivers.robot_parts import RefusalAllowed, RobotOfParts
from woz_tui.drivers.robot_verbs import known_by
from woz_tui.drivers.sound_feeds import LISTEN
from woz_tui.protocol.messages import Json

#: The robot is let go within so many seconds.
FAREWELL_S = 1.0
#: At the end other drivers let go of camera and microphones within so many seconds: the daemon,
#: which takes them back, does not try again.
_OTHERS_END_S = 0.5
_SILENT = (
    "no speech and sounds are heard: the daemon runs without media",
    "start it without --no-media, or look at its log; with a simulated robot they are silent",
)


class ReachyMini(RobotOfParts[DaemonLink, ReachyMiniSettings]):
    """One Reachy Mini behind its daemon."""

    PARTS = (ReachyMotion, ReachySounds, ReachySenses)
    called = "a Reachy Mini"
    Settings = ReachyMiniSettings
    summary = "Pollen Robotics' Reachy Mini by its daemon, or a simulated one"
    facts = DriverFacts(
        robot=True,
        needs="the address of its daemon; espeak-ng, or another voice",
        simulated="address: simulated, with a visitor",
        stop="its daemon runs no move, its pose stands still, its sound has ended",
        page="docs/how-to/reachy-mini.md",
        example="address: simulated",
        shown=("stop", "loss", "return", "units"),
    )

    def __init__(self, name: str, settings: ReachyMiniSettings, context: DriverContext) -> None:
        link = DaemonLink(
            settings,
            context,
            get_ready=self._get_ready,
            on_status=self._show,
            on_lost=self._when_lost,
        )
        about = (link, settings, context)
        self._body = ReachyBody(*about)
        self._sounds = ReachySounds(*about, self._body)
        senses = ReachySenses(*about, self._body, self._sounds)
        self._motion = ReachyMotion(*about, self._body, senses, show=self._show)
        super().__init__(name, settings, context, link, (self._motion, self._sounds, senses))
        #: Whether it was there and went: nobody knows what it does now.
        self._was_lost = False
        self._told_silent = False

    @classmethod
    def offer(cls, settings: ReachyMiniSettings) -> Offer:
        """Its daemon answers each when it is over, but gets setpoints of where it looks. Its
        microphones are another driver's.
        """
        ears = (
            "its microphones are heard by a driver of `type: microphone` where they are connected;"
            " docs/how-to/reachy-mini-camera.md has the lines"
        )
        offered = super().offer(settings)
        verbs = known_by("timed", known_by("reported", offered.verbs), "gaze", "nudge")
        return replace(offered, verbs=tuple(verbs), lacks={LISTEN: ears, **offered.lacks})

    @classmethod
    def remarks(cls, settings: ReachyMiniSettings, written: Written) -> Iterable[Finding]:
        """A recorded move that is written as none; what the voice does not take."""
        yield from voice_remarks(settings.voice, written)
        move = written.args.get("move") if written.verb == "recorded" else None
        if isinstance(move, str) and UNKNOWN not in move:
            try:
                data_set_and_name(move)
            except RejectedError as error:
                yield Finding("warning", "move", error.what, error.remedy)

    @classmethod
    async def voices(cls, probe: Probe) -> list[VoiceFound]:
        """Those of the synthesisers of this machine."""
        return await voices(probe.folder)

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Look whether the daemon is there and what it lacks, without moving anything."""
        return await doctor.examine(probe)

    # -- life ------------------------------------------------------------------------------------

    async def open(self) -> None:
        """Begin to look for the daemon."""
        self._sounds.start()
        await super().open()

    async def prepare_say(self, utterances: list[Mapping[str, Json]]) -> None:
        """Synthesise what will be said, and send it to the robot."""
        await self._sounds.prepare(utterances)

    async def _farewell(self) -> None:
        """It does nothing by itself."""
        if not self._link.ready:
            return
        with contextlib.suppress(DriverError, TimeoutError):
            async with asyncio.timeout(FAREWELL_S):
                await self._link.ask("POST", "media/tracking/disable")
                await self._link.ask("POST", "media/wobbling/disable")
        if self.settings.release_media:
            with contextlib.suppress(DeviceLostError), RefusalAllowed(self.context):
                await self._link.pause(_OTHERS_END_S)
                await self._link.hold_media(True)

    # -- the daemon ------------------------------------------------------------------------------

    async def _get_ready(self) -> None:
        """The daemon is there, for the first time or again."""
        self._sounds.forget()
        if self._was_lost:
            # A daemon that was frozen goes on with what it did, where it would be by now.
            await self._link.end_any()
            await self._link.end_running()
            await self._sounds.stop()
        self._was_lost = False
        if self.settings.release_media:
            with RefusalAllowed(self.context):
                await self._link.hold_media(False)
        await self._motion.switch_wobbling_and_tracking()
        if self._link.status.silent and not self._told_silent:
            self._told_silent = True
            self.context.notice("warning", *_SILENT)
        await self._connected()

    def _show(self) -> None:
        if self._link.ready:  # else nobody knows
            super()._show()

    def _when_lost(self, error: DeviceLostError) -> None:
        self._was_lost = True
        self._sounds.fail(error)
        self._lost()
