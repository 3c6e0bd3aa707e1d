"""A person's voice through the robot's own loudspeaker, live: `talk` and `end_talk`."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator, Mapping

from woz_drivers.naoqi_robot.parts import NaoqiPart, RobotCalls
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_drivers.sound import live_talk
from woz_drivers.sound.live_talk import LiveTalk, SentVoice, VoiceTally
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverContext,
    DriverError,
    Job,
    Offer,
    RejectedError,
    Scope,
)
from woz_tui.drivers.robot_parts import Pending
from woz_tui.drivers.sound_feeds import WIDTH
from woz_tui.protocol.messages import Json

_DEVICE = "ALAudioDevice"


class TalkPart(NaoqiPart):
    """Sends a voice to ALAudioDevice, piece by piece; the robot plays each as it comes."""

    name = "live voice"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        self._talk: LiveTalk | None = None
        if settings.talk is not None:
            self._talk = LiveTalk(settings.talk, context, self._open)
        #: Whether the robot has had some of a voice since it was connected.
        self._sent = False

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """`talk` and `end_talk`, where the file says so; how old a voice is when it is sent."""
        return live_talk.offered(settings.talk)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Let somebody talk, or end that."""
        if self._talk is None:
            raise RejectedError("nobody can talk through it", "write `talk: {}` into its settings")
        await self._cleaned_up()
        return await self._talk.perform(job)

    async def halt(self, scope: Scope) -> Pending:
        """Fall silent, for what the robot has in store, too; while no wizard watches only if
        somebody talks, or was just cut short: the robot's own sounds would be flushed as well.
        """
        if self._talk is None or not self._sent:
            return None
        if scope is Scope.DRIVE and not (self._talk.on or self._clean_up):
            return None
        await self._talk.stop()
        await self._flush()
        return ()

    async def connected(self) -> None:
        """Start the program that changes the voice."""
        if self._talk is not None:
            self._talk.start()

    def lost(self) -> None:
        """Who talks is not heard any more, and has to press the key again."""
        self._sent = False
        if self._talk is not None:
            self._talk.fail(DeviceLostError("the robot is disconnected"))

    async def close(self) -> None:
        """End the program."""
        if self._talk is not None:
            await self._talk.close()
        await super().close()

    @contextlib.asynccontextmanager
    async def _open(self, tally: VoiceTally) -> AsyncIterator[SentVoice]:
        await self._link.call(_DEVICE, "setParameter", "outputSampleRate", tally.rate)
        voice = SentVoice(tally, self._send)
        try:
            yield voice
        except BaseException:
            voice.silence()
            if self._sent:
                self._clean_up.start(self._flush())
            raise
        finally:
            await voice.close()

    async def _send(self, pcm: bytes) -> bool:
        self._sent = True
        both = bytearray(2 * len(pcm))  # the same to the left and to the right
        both[0::4] = both[2::4] = pcm[0::2]
        both[1::4] = both[3::4] = pcm[1::2]
        frames = len(pcm) // WIDTH
        if await self._link.call(_DEVICE, "sendRemoteBufferToOutput", frames, bytes(both)) is False:
            raise DriverError("the robot does not play the voice", "is its sound muted or in use?")
        return True

    async def _flush(self) -> None:
        await self._link.call(_DEVICE, "flushAudioOutputs")
