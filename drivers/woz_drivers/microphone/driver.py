"""Loudness and speech from any program that writes raw sound (arecord, parec, `ssh other ...`), or
from the microphone of a robot.
"""

from __future__ import annotations

import asyncio
import shlex
from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from woz_drivers.microphone import arecord_words, doctor
from woz_drivers.microphone.file_transcriber import file_transcriber
from woz_drivers.microphone.own_voice import OwnVoiceGate
from woz_drivers.microphone.robot_ears import RobotEars
from woz_drivers.microphone.settings import MicrophoneSettings
from woz_drivers.microphone.speech_detection import BLOCK_S, SpeechDetector
from woz_drivers.microphone.speech_segments import SpeechSegments
from woz_drivers.microphone.transcriber import (
    TRANSCRIBER,
    ProgramForEachSegment,
    ResidentTranscriber,
    Transcriber,
    TranscribingProgram,
)
from woz_drivers.programs.byte_stream import ByteStream, ChunkCutter, StreamCommand, StreamListener
from woz_drivers.sound import pcm_audio, room_threshold
from woz_tui.drivers.contract import (
    KEPT,
    LEAVES,
    SPEECH,
    SPEECH_TEXT,
    DeviceLostError,
    DriverContext,
    DriverError,
    DriverFacts,
    FileTranscriber,
    Finding,
    Health,
    Job,
    Offer,
    PassiveDriver,
    Probe,
    RejectedError,
)
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.drivers.sound_feeds import SoundOffer
from woz_tui.protocol.messages import Json
from woz_tui.sensing.speech_endpoint import SpeechEnd

SENSOR = "loudness"

#: Sound may come this much faster than real time before it is slowed down, in seconds. A device
#: never gets there; a file played back as a microphone would flood the log.
_AHEAD_S = 2.0
_STARTING = "starting the microphone's command"
_CHECK = "try its command in a terminal; `woz doctor` lists the devices"


class Microphone(PassiveDriver):
    """One sound source.

    Publishes `loudness` and `loudness.threshold` (RMS, 0 to 1 of full scale) and moves the state of
    the first between quiet, speaking, clipping (speaking, too loud for the converter), silent (only
    zeros come) and stale (nothing comes). Tells when somebody begins and ends to speak, and what
    they say if a program is there that understands it. Time is counted in blocks of sound, so a
    busy machine delays values but drops none.
    """

    Settings = MicrophoneSettings
    summary = "loudness and speech from a microphone"
    facts = DriverFacts(
        needs="a recording program such as arecord, or a robot with live sound",
        page="docs/explanation/engagement-sound.md",
    )
    settings: MicrophoneSettings

    def __init__(self, name: str, settings: MicrophoneSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._speaking = SpeechDetector(settings.ear)
        self._blocks = self._fresh_blocks()
        self._levels: list[float] = []
        self._learning: _Learning | None = None
        self._blocks_heard = 0
        self._warned = False
        self._resume: asyncio.TimerHandle | None = None
        self._source: ByteStream | RobotEars | None = None
        program = _transcribing_program(settings, context)
        self._transcriber = (
            Transcriber(name, program, context, settings.partial_texts)
            if program is not None
            else None
        )
        #: Of a robot's microphone its own driver has it.
        self._live = None if settings.from_ else SoundOffer(context, settings.rate)
        self._segments = SpeechSegments(
            *(name, settings.rate, context, settings.segments, self._transcriber),
            drop=settings.while_speaking == "drop",
        )
        self._gate = OwnVoiceGate(
            *(context, self._speaking, self._segments),
            onset=settings.onset,
            pre_roll=settings.pre_roll,
            keep=settings.while_speaking == "keep",
        )

    @classmethod
    def people_data(cls, settings: Any) -> Iterable[tuple[str, str]]:
        if settings.segments:
            yield KEPT, "what people say, as sound: a WAV file of each utterance, beside the log"
        else:
            yield KEPT, "no sound of anybody (segments: false)"
        program = settings.resident_transcriber or settings.transcribe
        if program:
            words = program if isinstance(program, str) else shlex.join(program)
            yield KEPT, "what people say, as text, in the log"
            yield (
                LEAVES,
                f"this file does not say whether `{words}`, which gets the sound, sends it on",
            )

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        """It can learn the room's noise. It publishes the loudness, the threshold of speech on the
        same scale, segments of speech, and their texts where a program understands them.
        """
        return Offer(
            verbs=(common_verb(room_threshold.NAME, evidence="measured"),),
            sensors=(
                SENSOR,
                room_threshold.THRESHOLD,
                SPEECH,
                *(
                    (SPEECH_TEXT, TRANSCRIBER)
                    if settings.transcribe or settings.resident_transcriber
                    else ()
                ),
            ),
        )

    @classmethod
    def transcriber(cls, settings: Any, folder: Path) -> FileTranscriber | None:
        """The program of its own settings, in a process of its own."""
        return file_transcriber(settings, folder)

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Listen for a second; say how loud it is."""
        return await doctor.examine(probe)

    async def open(self) -> None:
        """Start the command, and again whenever it ends."""
        settings = self.settings
        starting = f"waiting for sound of {settings.from_}" if settings.from_ else _STARTING
        self.context.health(Health.CONNECTING, starting)
        self.context.reading(room_threshold.THRESHOLD, self._speaking.threshold)
        self.context.sensor(SPEECH, "ready", "it reports speech by itself")
        listener = StreamListener(self._begun, self._received, self._stale, self._lost)
        if settings.from_:
            self._source = RobotEars(settings.from_, settings.rate, self.context, listener)
        else:
            command = StreamCommand(
                *(settings.words, self.context.folder, "no sound", _CHECK),
                least=settings.block_bytes,
                advise=partial(arecord_words.remedy, settings),
            )
            self._source = ByteStream(command, self.context.clock, listener)
        self._source.start()
        if self._transcriber is not None:
            self._transcriber.start()

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Learn the room."""
        if job.verb != room_threshold.NAME:
            raise RejectedError(f"{self.name} is a microphone; it cannot {job.verb}")
        if self._source is None or not self._source.running or not self._blocks_heard:
            raise DeviceLostError(
                f"{self.name} delivers no sound", "see the driver's health for the reason"
            )
        learning = _Learning(job.args["seconds"])
        self._learning = learning
        job.expects(learning.seconds)
        try:
            levels = await learning.done
        finally:
            self._learning = None
        return self._adopt(levels)

    async def close(self) -> None:
        """End the command."""
        if self._source is not None:
            await self._source.close()
            self._source = None
        self._cancel_pause()
        self._break_off("the session ended")
        await self._segments.close()

    # -- the command ---------------------------------------------------------------------------

    def _begun(self) -> None:
        self._blocks = self._fresh_blocks()
        self._speaking.forget()
        self._segments.forget()
        self._levels = []
        self._blocks_heard = 0

    def _stale(self, why: str) -> None:
        self._break_off(why)
        self._segments.gap()
        self.context.sensor(SENSOR, "stale", why)

    def _break_off(self, why: str) -> None:
        """Nobody can know whether they speak on: an utterance that never ends helps nobody."""
        ended = self._speaking.break_off()
        if ended is not None:
            self._segments.ended(ended, f"the sound stopped: {why}")

    def _lost(self, trouble: DriverError) -> None:
        self._cancel_pause()
        self.context.health(Health.LOST, trouble.what, trouble.remedy)
        self._stale(trouble.what)
        if self._learning is not None:
            self._learning.fail(DeviceLostError(trouble.what, trouble.remedy))

    # -- sound ---------------------------------------------------------------------------------

    def _fresh_blocks(self) -> ChunkCutter:
        return ChunkCutter(self.settings.block_bytes, self._process)

    def _received(self, data: bytes) -> None:
        self._blocks.feed(data)
        self._slow_down()

    def _process(self, block: bytes) -> None:
        settings = self.settings
        if not self._blocks_heard:
            self.context.health(
                Health.CONNECTED,
                f"{settings.source}, {settings.rate} Hz, {settings.format},"
                f" {settings.channels} channel{'s' if settings.channels > 1 else ''}",
            )
        self._blocks_heard += 1
        samples = settings.samples(block)
        if self._live is not None and self._live.wanted:
            self._live.add(pcm_audio.encode(samples, "S16_LE"))
        level = self._speaking.judge(samples)
        self.context.sensor(SENSOR, self._speaking.state, self._reason(level))
        self._cut(samples, level)
        if self._learning is not None:
            self._learning.add(level)
        self._levels.append(level)
        if self._blocks_heard * BLOCK_S * settings.publish >= 1 + self._published():
            self._publish()

    def _cut(self, samples: pcm_audio.Samples, level: float) -> None:
        self._segments.add(samples, level, self.context.clock.now_us())
        self._gate.take()
        event = self._speaking.event
        if isinstance(event, SpeechEnd):
            self._warn_if_endless(event.cut)

    def _warn_if_endless(self, cut: bool) -> None:
        """Say once that somebody speaks without a pause, or that it is not speech at all."""
        if cut and not self._warned:
            self.context.notice(
                "warning",
                f"loud for {self.settings.longest:g} s without a pause: is that speech?",
                "if not, play listen_room while nobody speaks, or raise threshold",
                tells=("loudness",),
            )
        self._warned = cut

    def _published(self) -> int:
        """How many values were due before this block."""
        return int((self._blocks_heard - 1) * BLOCK_S * self.settings.publish)

    def _publish(self) -> None:
        levels, self._levels = self._levels, []
        if self.settings.measure == "max":
            value = max(levels)
        else:
            value = (sum(level * level for level in levels) / len(levels)) ** 0.5
        self.context.reading(SENSOR, value)

    def _reason(self, level: float) -> str:
        match self._speaking.state:
            case "silent":
                return (
                    "the sound has only zeros: the microphone is muted, unplugged or the wrong one"
                )
            case "clipping":
                return "too loud for the converter: turn the gain down"
            case _:
                return f"RMS {level:.4f}, threshold {self._speaking.threshold:.4f}"

    def _slow_down(self) -> None:
        """Let a source that is faster than real time wait."""
        if self._source is None:
            return
        ahead = self._blocks_heard * BLOCK_S - self._source.lasted_us / 1_000_000
        if ahead > _AHEAD_S:
            self._cancel_pause()
            self._source.hold(True)
            loop = asyncio.get_running_loop()
            self._resume = loop.call_later(ahead - _AHEAD_S, self._source.hold, False)

    def _cancel_pause(self) -> None:
        """It has begun anew, or ended: nothing is to go on any more."""
        if self._resume is not None:
            self._resume.cancel()
            self._resume = None

    # -- learning the room ---------------------------------------------------------------------

    def _adopt(self, levels: list[float]) -> Mapping[str, Json]:
        keeping = "write threshold: {threshold} into the robot file to keep it"
        noise = room_threshold.room_noise(levels)
        learnt = room_threshold.LearntThreshold(
            self.name, noise, self.settings.sensitivity, BLOCK_S, keeping
        )
        published = learnt.publish(self.context, self._speaking.threshold)
        self._speaking.threshold = learnt.threshold
        return published


def _transcribing_program(
    settings: MicrophoneSettings, context: DriverContext
) -> TranscribingProgram | None:
    """What turns speech into text, if anything does."""
    limit = settings.transcribe_limit
    if settings.resident_words:
        return ResidentTranscriber(settings.resident_words, limit, settings.language, context)
    if settings.transcriber:
        return ProgramForEachSegment(settings.transcriber, limit, context.folder)
    return None


class _Learning:
    """Collects levels for some seconds of sound."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.done: asyncio.Future[list[float]] = asyncio.get_running_loop().create_future()
        self._wanted = max(1, round(seconds / BLOCK_S))
        self._levels: list[float] = []

    def add(self, level: float) -> None:
        self._levels.append(level)
        if len(self._levels) >= self._wanted and not self.done.done():
            self.done.set_result(self._levels)

    def fail(self, error: DriverError) -> None:
        if not self.done.done():
            self.done.set_exception(error)
