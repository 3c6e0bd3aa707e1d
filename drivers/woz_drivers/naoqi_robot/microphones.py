"""The robot's microphones: recordings on the robot, its sound here as a file and live."""

from __future__ import annotations

import asyncio
import contextlib
import secrets
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any, Protocol

from woz_drivers.naoqi_robot.link import Methods, RobotRefusedError, Unsubscribe, binary
from woz_drivers.naoqi_robot.memory import stamped, within
from woz_drivers.naoqi_robot.parts import WITHIN_S, NaoqiPart, RobotCalls
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_drivers.pictures.picture_files import stamp
from woz_drivers.sound.sound_file import SoundFile
from woz_tui.drivers.background import Background, BackgroundTasks
from woz_tui.drivers.contract import (
    Argument,
    DriverContext,
    DriverError,
    HeardSound,
    Job,
    Offer,
    RejectedError,
    Verb,
)
from woz_tui.drivers.sound_feeds import SoundOffer
from woz_tui.protocol.messages import Json

#: Of the recordings on the robot.
_RECORDED_HZ = 16000
#: Left, right, front, rear: all four.
_ALL = [1, 1, 1, 1]
_FAREWELL_S = 0.5
_ON = Argument("on", "flag", "begin or end", required=True)


@dataclass(slots=True)
class _Recording:
    """One on the robot."""

    path: str
    t_us: int


class MicrophonesPart(NaoqiPart):
    """`record_sound` has the robot write a file of its own, `listen` brings its sound here as a
    file; who listens live (`woz listen`) gets it without a file.
    """

    name = "microphones"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        self._folder = settings.recordings
        self._offer = SoundOffer(context, LIVE_HZ)
        self._live: SoundSubscription | None = None
        self._watching = Background("the live sound", context)
        self._recording: _Recording | None = None
        self._listening: SoundRecording | None = None
        #: Those that ended without being waited for.
        self._abandoned: list[SoundRecording] = []

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """Recording there, listening here."""
        return Offer(
            verbs=(
                Verb(
                    "record_sound", "record its microphones to a file on the robot", (_ON,), "watch"
                ),
                Verb(
                    "listen", "its front microphone to a WAV file beside the log", (_ON,), "watch"
                ),
            )
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Begin or end one of the two. `file`, `t` (of its beginning), and `seconds` at its end."""
        on = bool(job.args["on"])
        match job.verb:
            case "record_sound":
                return await (self._record() if on else self._end_record())
            case "listen":
                return await (self._listen() if on else self._end_listen())
        return await super().perform(job)

    async def connected(self) -> None:
        """Look whether somebody listens."""
        await self._watching.close()
        self._live = None
        self._watching.start(self._follow_listeners())

    def lost(self) -> None:
        """A recording may go on without us; the file here ends."""
        self._watching.cancel()
        self._live = None
        recording, self._recording = self._recording, None
        if recording is not None:
            self._warn_recording(recording)
        listening, self._listening = self._listening, None
        if listening is not None:
            self._leave(listening)
            text = f"the robot's sound in {listening.file} ends here: the robot is disconnected"
            self._context.notice("warning", text, "play listen again when it is connected")

    async def read(self) -> Mapping[str, Json]:
        """What is under way."""
        active = [
            *([f"recording {self._recording.path}"] if self._recording else []),
            *([f"listening to {self._listening.file}"] if self._listening else []),
        ]
        return {"microphones": ", ".join(active) or "off"}

    async def close(self) -> None:
        """End all; a robot that does not confirm it may record on: a notice says so."""
        await self._watching.close()
        await self._end_live()
        if self._listening is not None:
            with contextlib.suppress(DriverError):  # it is written as far as it came
                await self._end_listen()
        for abandoned in self._abandoned:
            await abandoned.close()
        recording = self._recording
        if recording is not None:
            try:
                await self._end_record(within=_FAREWELL_S)
            except DriverError:
                self._recording = None
                self._warn_recording(recording)

    # -- live ----------------------------------------------------------------------------------

    async def _follow_listeners(self) -> None:
        trouble = ""
        while True:
            if not self._offer.wanted:
                await self._end_live()
            elif self._live is None:
                self._live = SoundSubscription(self._link, LIVE_HZ, self._take_live)
                try:
                    await self._live.begin()
                    trouble = ""
                except DriverError as error:
                    if trouble != error.what:
                        trouble = error.what
                        text = f"no live sound: {error.what}"
                        self._context.notice("warning", text, error.remedy)
                    await self._end_live()
                    await asyncio.sleep(_AGAIN_S)
            await asyncio.sleep(_LOOK_S)

    def _take_live(self, channels: Any, samples: Any, stamp_: Any, buffer: Any) -> None:
        received = block(channels, samples, stamp_, buffer)
        if isinstance(received, SoundBlock) and self._offer.wanted:
            self._offer.add(front(received))

    async def _end_live(self) -> None:
        live, self._live = self._live, None
        if live is not None:
            await live.end()

    # -- on the robot --------------------------------------------------------------------------

    async def _record(self) -> Mapping[str, Json]:
        if self._recording is not None:
            raise RejectedError(
                f"it is recording already, to {self._recording.path}", "end that one first"
            )
        name = f"woz-{stamp(self._context.clock.wall())}.wav"
        path = str(PurePosixPath(self._folder) / name)
        t_us = self._context.clock.now_us()
        try:
            await self._link.call(
                "ALAudioRecorder", "startMicrophonesRecording", path, "wav", _RECORDED_HZ, _ALL
            )
        except RejectedError:
            raise
        except DriverError as error:
            remedy = error.remedy or "record_sound off ends what it may be recording still"
            raise type(error)(f"no recording was begun: {error.what}", remedy) from None
        self._recording = _Recording(path, t_us)
        return {"file": path, "t": self._context.t(t_us)}

    async def _end_record(self, within: float = 2.0) -> Mapping[str, Json]:
        """Also without one of ours: an earlier program may have left one."""
        await self._link.call("ALAudioRecorder", "stopMicrophonesRecording", within=within)
        recording, self._recording = self._recording, None
        if recording is None:
            return {"file": ""}
        seconds = (self._context.clock.now_us() - recording.t_us) / 1_000_000
        start = self._context.t(recording.t_us)
        return {"file": recording.path, "t": start, "seconds": round(seconds, 3)}

    def _warn_recording(self, recording: _Recording) -> None:
        text = f"the robot may still be recording to {recording.path}"
        self._context.notice("warning", text, "when it is there again: record_sound off")

    # -- here ----------------------------------------------------------------------------------

    async def _listen(self) -> Mapping[str, Json]:
        if self._listening is not None:
            raise RejectedError(
                f"it is listening already, to {self._listening.file}", "end it first"
            )
        listening = SoundRecording(self._link, self._context)
        self._listening = listening
        try:
            return await listening.begin()
        except BaseException:
            if self._listening is listening:
                self._listening = None
            self._leave(listening)
            raise

    async def _end_listen(self) -> Mapping[str, Json]:
        listening, self._listening = self._listening, None
        if listening is None:
            return {"file": ""}
        return await listening.end()

    def _leave(self, listening: SoundRecording) -> None:
        listening.abandon()
        self._abandoned.append(listening)


# -- sent to this machine --------------------------------------------------------------------------

#: How the service of ours begins that the robot sends its sound to. Each has a name of its own: a
#: robot that was cut off holds on to those of before for a while.
SERVICE = "WozTuiMicrophones"
_RATE_HZ = 48000
#: Live sound is for the ear: a third of it; and for a line.
LIVE_HZ = 16000
#: How often is looked whether somebody listens, and the pause after a trouble, in seconds.
_LOOK_S, _AGAIN_S = 0.1, 5.0
#: ALAudioDevice's number for the front microphone, and for samples channel by channel: no.
_FRONT, _NOT_DEINTERLEAVED = 3, 0
#: Sound has to come within this, in seconds.
_COMES_WITHIN_S = 3.0


class SoundCalls(Protocol):
    """The part of `RobotCalls` by which sound comes."""

    async def call(self, service: str, method: str, *args: Any, within: float = WITHIN_S) -> Any:
        """Call a method of a service of the robot."""
        ...

    async def serve(self, name: str, methods: Methods) -> Unsubscribe:
        """Offer the robot a service of ours."""
        ...


class SoundSubscription:
    """The front microphone's sound, sent to a service of ours.

    Args:
        robot: Its calls `call` and `serve`.
        rate: Frames a second.
        take: Called with each buffer, as `processRemote` is.
    """

    def __init__(self, robot: SoundCalls, rate: int, take: Callable[..., None]) -> None:
        self._link = robot
        self._rate = rate
        self._take = take
        self._service = f"{SERVICE}_{secrets.token_hex(4)}"
        self._withdraw: Unsubscribe | None = None

    async def begin(self) -> None:
        """Have the robot send it. Raises `DriverError`; `end` is called then, too."""
        self._withdraw = await self._link.serve(
            self._service, {"processRemote": ("(iimr)", self._take)}
        )
        await self._link.call(
            *("ALAudioDevice", "setClientPreferences"),
            *(self._service, self._rate, _FRONT, _NOT_DEINTERLEAVED),
        )
        await self._link.call("ALAudioDevice", "subscribe", self._service)

    async def end(self) -> None:
        """Have it send nothing more; never raises."""
        with contextlib.suppress(DriverError):  # it is not there, and sends nothing then
            await self._link.call("ALAudioDevice", "unsubscribe", self._service, within=_FAREWELL_S)
        withdraw, self._withdraw = self._withdraw, None
        if withdraw is not None:
            await withdraw()


async def heard(robot: SoundCalls, seconds: float) -> HeardSound:
    """So much sound of the front microphone. Raises `DriverError`."""
    sound, enough = bytearray(), asyncio.Event()

    def take(channels: Any, samples: Any, stamp_: Any, buffer: Any) -> None:
        received = block(channels, samples, stamp_, buffer)
        if isinstance(received, SoundBlock):
            sound.extend(front(received))
        if len(sound) >= _WIDTH * LIVE_HZ * seconds:
            enough.set()

    subscription = SoundSubscription(robot, LIVE_HZ, take)
    try:
        await subscription.begin()
        async with asyncio.timeout(_COMES_WITHIN_S + seconds):
            await enough.wait()
    except TimeoutError:
        raise DriverError(f"no sound came within {_COMES_WITHIN_S:g} s") from None
    finally:
        await subscription.end()
    return HeardSound(LIVE_HZ, bytes(sound))


class SoundRecording:
    """The front microphone's sound on its way into one file in the media folder."""

    def __init__(self, robot: RobotCalls, context: DriverContext) -> None:
        self._context = context
        self._path = context.media / f"robot-{stamp(context.clock.wall())}.wav"
        #: The file as results and messages name it.
        self.file = f"{context.media.name}/{self._path.name}"
        self._subscription = SoundSubscription(robot, _RATE_HZ, self._take_buffer)
        self._sound: SoundFile | None = None
        self._first: asyncio.Future[SoundBlock] = asyncio.get_running_loop().create_future()
        self._t_us = 0
        self._bad = 0
        self._over = False
        self._endings = BackgroundTasks("ending the sound of the robot")

    async def begin(self) -> Mapping[str, Json]:
        """Return when the first sound has come; `t` is the moment of its first sample.

        Raises `DriverError` if none comes.
        """
        try:
            await self._subscription.begin()
            async with asyncio.timeout(_COMES_WITHIN_S):
                first = await asyncio.shield(self._first)
        except TimeoutError:
            raise DriverError(
                f"no sound came within {_COMES_WITHIN_S:g} s",
                "record_sound works on the robot itself",
            ) from None
        return {**self._about(), "channels": first.channels, "robot_time": first.robot_s}

    def _about(self) -> dict[str, Json]:
        return {"file": self.file, "t": self._context.t(self._t_us), "rate": _RATE_HZ}

    def _take_buffer(self, channels: Any, samples: Any, stamp_: Any, buffer: Any) -> None:
        """What the robot calls for each buffer."""
        received = block(channels, samples, stamp_, buffer)
        if self._over:
            return
        if isinstance(received, str) or (self._sound and received.channels != self._sound.channels):
            self._bad += 1
            if self._bad == 1:
                why = (
                    received
                    if isinstance(received, str)
                    else f"{received.channels} channels instead of the number before"
                )
                self._context.notice("warning", f"a part of the robot's sound is missing: {why}")
            return
        if self._sound is None:
            lasted_us = received.samples * 1_000_000 // _RATE_HZ
            self._t_us = self._context.clock.now_us() - lasted_us
            self._sound = SoundFile(self._path, _RATE_HZ, received.channels, self._failed)
            self._sound.begin()
            self._first.set_result(received)
        self._sound.write_block(received.data)

    def _failed(self, why: str) -> None:
        text = f"the robot's sound is not kept any more, {self.file}: {why}"
        self._context.notice("error", text, "check the disk, then play listen off and on")

    async def end(self) -> Mapping[str, Json]:
        """Return when the file is whole. Raises `DriverError` if something of it is missing."""
        await self._leave()
        if self._sound is None:
            return {"file": ""}
        progress = await self._sound.finish()
        if progress.trouble:
            raise DriverError(
                f"{self.file} ends too early, after {progress.frames / _RATE_HZ:.1f} s:"
                f" {progress.trouble}",
                "check the disk",
            )
        seconds = round(progress.frames / _RATE_HZ, 3)
        return {**self._about(), "seconds": seconds, "missing": self._bad}

    async def _leave(self) -> None:
        """Have the robot send nothing more; the service here is gone in any case."""
        self._over = True
        self._endings.start(self._subscription.end())
        await self._endings.settled(WITHIN_S)
        await self._endings.close()

    def abandon(self) -> None:
        """End it without waiting: what came is in the file."""
        self._over = True
        self._endings.start(self._subscription.end())
        if self._sound is not None:
            self._sound.end()

    async def close(self) -> None:
        """Return when nothing of it is under way any more."""
        await self._endings.settled(WITHIN_S)
        await self._endings.close()
        if self._sound is not None:
            await self._sound.finish()


# -- as ALAudioDevice sends it ---------------------------------------------------------------------
# doc.aldebaran.com, "naoqi/audio/alaudiodevice": `processRemote(channels, samples of each, [s, us],
# 16-bit samples)` is called for every buffer, about six times a second.

#: Bytes of a sample.
_WIDTH = 2
#: Of one buffer: four microphones, and a second of 48 kHz. They bound what waits for a disk.
_MOST_CHANNELS, _MOST_SAMPLES = 4, 48_000


@dataclass(frozen=True, slots=True)
class SoundBlock:
    """One buffer: `data` holds `samples` frames of `channels` samples. `robot_s`: its time stamp by
    the robot's clock, in seconds since 1970.
    """

    channels: int
    samples: int
    data: bytes
    robot_s: float | None


def front(received: SoundBlock) -> bytes:
    """Its first channel."""
    return memoryview(received.data).cast("h")[:: received.channels].tobytes()


def block(channels: Any, samples: Any, stamp: Any, buffer: Any) -> SoundBlock | str:
    """What the robot sent, or why it is no sound. Never raises."""
    some, many = within(channels, 1, _MOST_CHANNELS), within(samples, 1, _MOST_SAMPLES)
    if some is None or many is None or some != int(some) or many != int(many):
        return f"{channels!r} channels of {samples!r} samples are no sound"
    try:
        data = binary(buffer)
    except (RobotRefusedError, UnicodeEncodeError) as trouble:
        return f"the robot's sound: {trouble}"
    if len(data) != int(some) * int(many) * _WIDTH:
        return f"{len(data)} bytes for {int(some)} channels of {int(many)} samples are no sound"
    at = stamped(stamp)
    return SoundBlock(int(some), int(many), data, None if at is None else at[0] + at[1] / 1_000_000)
