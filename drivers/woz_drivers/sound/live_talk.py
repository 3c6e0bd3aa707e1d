"""A person's voice through a loudspeaker, live, while `talk` is played; changed by a program of the
lab's if one is named. What comes too late is dropped: nothing is heard that was said long ago.

The loudspeaker is a program's (`program_loudspeaker`) or a robot's own (`SentVoice`).
"""

from __future__ import annotations

import asyncio
import contextlib
import fcntl
import os
from array import array
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from typing import Annotated, Protocol

from woz_drivers.pictures.picture_files import stamp
from woz_drivers.programs import child_process, command_lines
from woz_drivers.programs.byte_stream import ByteStream, ChunkCutter, StreamCommand, StreamListener
from woz_drivers.programs.child_process import Child
from woz_drivers.programs.command_lines import Command
from woz_drivers.programs.resident_program import resident_words
from woz_drivers.sound.sound_file import SoundFile
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverContext,
    DriverError,
    Job,
    Offer,
    RejectedError,
    Verb,
)
from woz_tui.drivers.fields import Doc, Range, Seconds
from woz_tui.drivers.sound_feeds import (
    TALK_UNWRITTEN,
    VOICE,
    VOICE_STATE,
    WIDTH,
    SoundReader,
    VoiceState,
)
from woz_tui.protocol.messages import Json

#: How old a voice is when it is handed on to what plays it, in seconds; and its state: off, on,
#: silent (on, and none comes), loading and stale (the program that changes it starts, or ended).
TALK = "talk"
#: How often new sound is looked for, in seconds.
_LOOK_S = 0.01
#: So much sound may wait for the player, in seconds; and pieces in which it is given, in bytes:
#: the kernel takes one whole or not at all.
_WAITING_S, _PIECE = 0.1, 2048
#: How old sound is when it is handed on is published this often, in seconds.
_PUBLISHED_S = 0.5
#: Without a voice for so long the sensor says that none comes, in seconds.
_SILENT_S = 1.0
#: What the player has when a voice is switched off is played to its end, within so many seconds.
_LAST_WORDS_S = 1.0
#: So much silence pushes the last of a voice out of a program, in seconds.
_FLUSH_S = 0.5
#: What comes back from a program is handed on in pieces of so many seconds.
_CHUNK_S = 0.02
_SENDER = "arecord -f S16_LE -r {rate} -c 1 | ssh ROBOT woz talk"

VERBS = (
    Verb(
        "talk",
        "let somebody talk through the loudspeaker, until `end_talk`",
        lane="talk",
        drives=True,
        waits=False,
        limit_s=3700.0,
        evidence="reported",
    ),
    Verb("end_talk", "end `talk`", lane="end_talk", brief=True, evidence=""),
)
NAMES = frozenset(verb.name for verb in VERBS)


def offered(settings: TalkSettings | None) -> Offer:
    """The verbs, with how old a voice is when it is sent; without settings: how to have them."""
    if settings is None:
        return Offer(lacks=TALK_UNWRITTEN)
    return Offer(verbs=VERBS, sensors=(TALK,))


@dataclass(frozen=True, slots=True)
class TalkSettings:
    """How somebody talks through a loudspeaker live, with `woz talk`."""

    through: Annotated[
        Command,
        Doc("program that changes the voice: raw S16_LE, one channel, from stdin to stdout"),
    ] = ""
    rate: Annotated[int, Range(8_000, 48_000, "Hz"), Doc("frames a second of the voice")] = 16_000
    longest: Annotated[
        float, Seconds(1, 3600), Doc("it ends by itself after this time without `end_talk`")
    ] = 600.0
    keep: Annotated[
        bool, Doc("keep what is heard as WAV files beside the log; mind your ethics approval")
    ] = False

    def through_words(self) -> tuple[str, ...]:
        """The program that changes the voice, or (). Raises `DriverError`."""
        return resident_words(self.through, "talk.through")

    def problems(self) -> list[tuple[str, str]]:
        """What is wrong with the command: pairs of the setting's path and a sentence."""
        return [*command_lines.setting_problems(("talk.through", self.through_words))]


@dataclass(slots=True)
class VoiceTally:
    """What became of one voice; frames."""

    began_us: int
    rate: int
    heard: int = 0
    dropped: int = 0
    #: When a voice came last, and who sent it.
    came_us: int = 0
    by: str = ""
    #: What the sender had dropped by itself when it began, and by now, in seconds.
    lost_before_s: float | None = None
    lost_s: float = 0.0
    #: How old sound was when it was given to the loudspeaker or the program: the sum, and pieces.
    age_us: int = 0
    pieces: int = 0
    #: Where what is heard is kept.
    sound: SoundFile | None = None

    def hear(self, pcm: bytes) -> None:
        """The loudspeaker has these samples."""
        self.heard += len(pcm) // WIDTH
        if self.sound is not None:
            self.sound.write_block(pcm)

    def drop(self, size: int) -> None:
        """So many bytes came too late for it."""
        self.dropped += size // WIDTH

    def result(self, now_us: int) -> dict[str, Json]:
        """What the log has of it, in seconds."""
        at_sender = self.lost_s - (self.lost_before_s or 0.0)
        age_s = self.age_us / max(1, self.pieces) / 1_000_000
        return {
            "seconds": round((now_us - self.began_us) / 1_000_000, 3),
            "played": round(self.heard / self.rate, 3),
            "dropped": round(self.dropped / self.rate + max(0.0, at_sender), 3),
            "delay": round(age_s, 3),
            "by": self.by,
        }


class TalkOutlet(Protocol):
    """Where a voice goes while it is on. It tells the tally what is heard, and what is dropped."""

    def give(self, pcm: bytes) -> None:
        """Have samples heard now, as far as there is room."""
        ...

    async def check(self) -> None:
        """Raise `DriverError` if nothing can be heard any more."""
        ...

    async def finish(self) -> None:
        """Return when what it has was heard, soon in any case."""
        ...

    def silence(self) -> None:
        """Nothing is heard from now on."""
        ...


#: Opens a loudspeaker; it closes at once, whatever it has, when the block is left.
Loudspeaker = Callable[[VoiceTally], AbstractAsyncContextManager[TalkOutlet]]


class _Player:
    """A program that is heard, and the pipe to it."""

    def __init__(self, child: Child, pipe: int, room: int, tally: VoiceTally) -> None:
        self._child = child
        self._pipe = pipe
        #: Bytes that the pipe takes.
        self._room = room
        self._tally = tally

    def give(self, pcm: bytes) -> None:
        """What has no room in the pipe is dropped."""
        old = max(0, len(pcm) - self._room)
        self._tally.drop(old)
        pcm = pcm[old:]
        for start in range(0, len(pcm), _PIECE):
            piece = pcm[start : start + _PIECE]
            try:
                os.write(self._pipe, piece)
            except (BlockingIOError, BrokenPipeError):  # an ended player is noticed elsewhere
                self._tally.drop(len(piece))
            else:
                self._tally.hear(piece)

    async def check(self) -> None:
        """It has to run."""
        if not self._child.running:
            status = await self._child.wait()
            raise DriverError(
                f"{self._child.program} ended: {self._child.reason(status)}",
                "check the sound card, or `talk.play` in the robot file",
            )

    async def finish(self) -> None:
        """The program ends when it has played what is in the pipe."""
        self.close()
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(_LAST_WORDS_S):
                await self._child.wait()

    def silence(self) -> None:
        """Kill it."""
        self._child.kill()

    def close(self) -> None:
        """Nothing more comes."""
        if self._pipe >= 0:
            os.close(self._pipe)
            self._pipe = -1


def program_loudspeaker(
    words: Callable[[], tuple[str, ...]], context: DriverContext
) -> Loudspeaker:
    """A program that plays raw samples from its standard input."""

    @contextlib.asynccontextmanager
    async def opened(tally: VoiceTally) -> AsyncIterator[TalkOutlet]:
        reading, writing = os.pipe2(os.O_CLOEXEC)
        try:
            os.set_blocking(writing, False)
            room = round(_WAITING_S * tally.rate) * WIDTH
            fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, room)  # the kernel makes a page of it at least
            child = await child_process.start(words(), context.folder, stdin=reading)
        except BaseException:
            os.close(writing)
            raise
        finally:
            os.close(reading)
        player = _Player(child, writing, room, tally)
        try:
            yield player
        finally:
            player.close()
            await child.end()

    return opened


class SentVoice:
    """A voice that is sent to a robot piece by piece: the next one when the robot has taken the one
    before. What waits for longer than a moment is dropped.

    Args:
        tally: What becomes of it.
        send: Sends one piece; returns, when the robot has taken it, whether it is heard: the robot
            may have too much already. Raises `DriverError`.
    """

    def __init__(self, tally: VoiceTally, send: Callable[[bytes], Awaitable[bool]]) -> None:
        self._tally = tally
        self._send = send
        self._most = round(_WAITING_S * tally.rate) * WIDTH
        self._waiting = bytearray()
        self._more = asyncio.Event()
        self._taken = asyncio.Event()
        self._taken.set()
        self._trouble: DriverError | None = None
        self._task = asyncio.create_task(self._run(), name="a live voice")

    def give(self, pcm: bytes) -> None:
        """Only the newest of what waits is kept."""
        self._waiting += pcm
        if (over := len(self._waiting) - self._most) > 0:
            del self._waiting[:over]
            self._tally.drop(over)
        self._more.set()
        self._taken.clear()

    async def check(self) -> None:
        """Raise what the robot said, or why it is gone."""
        if self._trouble is not None:
            raise self._trouble

    async def finish(self) -> None:
        """Everything is at the robot."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(_LAST_WORDS_S):
                await self._taken.wait()

    def fail(self, trouble: DriverError) -> None:
        """The robot is gone, or takes no more."""
        self._trouble = self._trouble or trouble
        self.silence()

    def silence(self) -> None:
        """Send nothing more."""
        self._task.cancel()
        self._tally.drop(len(self._waiting))
        self._waiting.clear()

    async def close(self) -> None:
        """The same, and it has ended."""
        self.silence()
        await asyncio.gather(self._task, return_exceptions=True)

    async def _run(self) -> None:
        while True:
            await self._more.wait()
            piece = bytes(self._waiting)
            self._waiting.clear()
            self._more.clear()
            try:
                heard = await self._send(piece)
            except DriverError as error:
                self._trouble = self._trouble or error
                return
            except asyncio.CancelledError:
                self._tally.drop(len(piece))
                raise
            if heard:
                self._tally.hear(piece)
            else:
                self._tally.drop(len(piece))
            if not self._waiting:
                self._taken.set()


class LiveTalk:
    """`talk` and `end_talk` of one loudspeaker.

    Args:
        settings: Of `talk`.
        context: The driver's.
        loudspeaker: Opens it.
        volume: How loud the voice is made here, 0 to 1.
    """

    def __init__(
        self,
        settings: TalkSettings,
        context: DriverContext,
        loudspeaker: Loudspeaker,
        volume: Callable[[], float] = lambda: 1.0,
    ) -> None:
        self._settings = settings
        self._context = context
        self._loudspeaker = loudspeaker
        self._volume = volume
        self._voice = context.feed(VOICE)
        self._state = context.feed(VOICE_STATE)
        self._state.put(VoiceState(settings.rate))
        self._outlet: TalkOutlet | None = None
        #: Why it has to end, though the loudspeaker says nothing of that.
        self._failure: DriverError | None = None
        self._ending: asyncio.Event | None = None
        self._through: ByteStream | None = None
        #: Why the program that changes the voice cannot be used; None: it can.
        self._trouble: DriverError | None = None
        self._cutter = self._fresh_cutter()
        self._shown: tuple[str, str] | None = None

    # -- the program that changes it -----------------------------------------------------------

    def start(self) -> None:
        """Start the program that changes the voice, if one is named; a second time: nothing."""
        if self._through is not None:
            return
        words = self._settings.through_words()
        self._show("loading" if words else "off")
        if not words:
            return
        self._trouble = DriverError(f"{words[0]} is starting")
        remedy = f"try it in a terminal: {' '.join(words)}"
        command = StreamCommand(words, self._context.folder, "no sound", remedy, fed=True)
        listener = StreamListener(
            self._begun, self._came_back, lambda why: None, self._lost, self._ready
        )
        self._through = ByteStream(command, self._context.clock, listener)
        self._through.start()

    def _fresh_cutter(self) -> ChunkCutter:
        return ChunkCutter(round(_CHUNK_S * self._settings.rate) * WIDTH, self._hear)

    def _begun(self) -> None:
        self._cutter = self._fresh_cutter()

    def _ready(self) -> None:
        self._trouble = None
        self._show("on" if self.on else "off")

    def _lost(self, trouble: DriverError) -> None:
        self._trouble = trouble
        self._show("stale", trouble.what)

    def _came_back(self, pcm: bytes) -> None:
        self._cutter.feed(pcm)

    def _flush(self, seconds: float = _FLUSH_S) -> None:
        """What the program still has of a voice comes out: so much silence follows it."""
        if self._through is not None and self._trouble is None:
            self._through.write(bytes(round(seconds * self._settings.rate) * WIDTH))

    async def _start_again(self) -> None:
        """What the program still has of a voice is never heard."""
        through, self._through = self._through, None
        if through is not None:
            await through.close()
            self.start()

    def _show(self, state: str, why: str = "") -> None:
        if self._shown != (state, why):
            self._shown = state, why
            self._context.sensor(TALK, state, why)

    # -- the loudspeaker -----------------------------------------------------------------------

    def _hear(self, pcm: bytes) -> None:
        """Samples that are to be heard now."""
        if self._outlet is None:
            return
        volume = self._volume()
        if volume != 1.0:
            samples = memoryview(pcm).cast("h")
            pcm = array("h", (int(sample * volume) for sample in samples)).tobytes()
        self._outlet.give(pcm)

    @contextlib.asynccontextmanager
    async def _playing(self, tally: VoiceTally) -> AsyncIterator[TalkOutlet]:
        """The loudspeaker is open. What it has is played to its end if the block ends well."""
        if self._settings.keep:
            path = self._context.media / f"talk-{stamp(self._context.clock.wall())}.wav"
            tally.sound = SoundFile(path, tally.rate, 1, self._not_kept)
        async with self._loudspeaker(tally) as outlet:
            if tally.sound is not None:
                tally.sound.begin()
            self._outlet = outlet
            try:
                yield outlet
                self._outlet = None
                await outlet.finish()
            finally:
                self._outlet = None
                if tally.sound is not None:
                    tally.sound.end()

    def _not_kept(self, why: str) -> None:
        self._context.notice(
            "error", f"the voice is not kept any more: {why}", "check the disk; it is still heard"
        )

    # -- the verbs -----------------------------------------------------------------------------

    @property
    def on(self) -> bool:
        """Whether somebody can be heard."""
        return self._outlet is not None

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """One of `VERBS`. Raises as `talk`, and `RejectedError` if `end_talk` finds nobody."""
        return self.end() if job.verb == "end_talk" else await self.talk()

    async def talk(self) -> Mapping[str, Json]:
        """Play the voice that comes, until `end_talk`.

        Raises `DeviceLostError` without the program that changes the voice: it is never heard
        unchanged where one is named.
        """
        if self._trouble is not None:
            raise DeviceLostError(
                f"nobody can talk: {self._trouble.what}",
                self._trouble.remedy or "press the key again in a moment",
            )
        clock, rate = self._context.clock, self._settings.rate
        self._failure = None
        tally = VoiceTally(clock.now_us(), rate)
        ending = self._ending = asyncio.Event()
        why = "stopped"
        try:
            async with self._playing(tally) as outlet:
                self._state.put(VoiceState(rate, on=True))
                self._show("on")
                why = await self._forward(outlet, tally, ending)
        except DriverError as error:
            why = error.what
            raise
        finally:
            self._ending = None
            self._state.put(VoiceState(rate))
            result = tally.result(clock.now_us())
            heard = f"{result['seconds']} s, {result['dropped']} s dropped"
            by = f" by {tally.by}" if tally.by else ""
            self._show("off", f"{why}: {heard}{by}")
            self._flush()  # and is not heard the next time
        if (sound := tally.sound) is not None:
            await sound.finish()
            if sound.frames or not sound.trouble:
                result["file"] = f"{self._context.media.name}/{sound.path.name}"
        return result

    async def _forward(self, outlet: TalkOutlet, tally: VoiceTally, ending: asyncio.Event) -> str:
        """Hand on what comes; why it is over."""
        clock, settings = self._context.clock, self._settings
        reader = SoundReader(self._voice)
        published_us = silence_us = chunks = 0
        tally.came_us = tally.began_us
        while True:
            now, last = clock.now_us(), ending.is_set()
            if now - tally.began_us > settings.longest * 1_000_000:
                return f"it was on for {settings.longest:g} s"
            if self._failure is not None:  # before what it silenced is found ended
                raise self._failure
            await outlet.check()
            if (taken := reader.take()) is not None:
                piece, sound = taken
                tally.came_us, tally.by, tally.lost_s = now, sound.source, sound.lost_s
                if tally.lost_before_s is None:
                    tally.lost_before_s = sound.lost_s
                tally.age_us += now - piece.t_us
                tally.pieces += 1
                tally.dropped += piece.lost
                if now - published_us >= _PUBLISHED_S * 1_000_000:
                    published_us = now
                    age_s = (now - piece.t_us) / 1_000_000
                    self._context.reading(TALK, round(age_s, 3), unit="s")
                self._change(piece.pcm, tally)
                silence_us = now + round(_SILENT_S * 1_000_000)
                chunks = round(_FLUSH_S / _CHUNK_S)
            silent = now - tally.came_us > _SILENT_S * 1_000_000
            if self._trouble is None:
                why = f"no voice comes: {_SENDER.format(rate=settings.rate)}"
                self._show("silent", why) if silent else self._show("on")
            # The last words are heard, too: silence follows them no faster than it is played. After
            # a delay only as much is made up for as has room.
            silence_us = max(silence_us, now - round((_WAITING_S - _CHUNK_S) * 1_000_000))
            while chunks and silence_us <= now:
                self._flush(_CHUNK_S)
                silence_us += round(_CHUNK_S * 1_000_000)
                chunks -= 1
            if last:  # what was said before the key counts
                return "switched off"
            await asyncio.sleep(_LOOK_S)

    def _change(self, pcm: bytes, tally: VoiceTally) -> None:
        if self._through is None:
            self._hear(pcm)
        elif self._trouble is not None:  # it died: nobody hears an unchanged voice
            tally.drop(len(pcm))
        else:
            self._through.write(pcm)

    def end(self) -> Mapping[str, Json]:
        """End `talk`. Raises `RejectedError` if nobody talks."""
        if self._ending is None:
            raise RejectedError("nobody talks", "press the key of `talk` first")
        self._ending.set()
        return {}

    def fail(self, failure: DriverError) -> None:
        """The robot is gone: who talks is not heard any more, and has to press the key again."""
        self._failure = failure
        if self._outlet is not None:
            self._outlet.silence()

    async def stop(self) -> None:
        """Fall silent at once, for what is on its way, too."""
        if self._outlet is not None:
            self._outlet.silence()
            await self._start_again()

    async def close(self) -> None:
        """End the program."""
        through, self._through = self._through, None
        if through is not None:
            await through.close()
