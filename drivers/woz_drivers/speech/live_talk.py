"""A person's voice through the loudspeaker, live, while `talk` is played; changed by a program of
the lab's if one is named. What comes too late is dropped: nothing is heard that was said long ago.
"""

from __future__ import annotations

import asyncio
import contextlib
import fcntl
import os
from collections.abc import AsyncIterator, Callable, Mapping
from dataclasses import dataclass

import numpy as np

from woz_drivers import child_process
from woz_drivers.byte_stream import ByteStream, ChunkCutter, StreamCommand, StreamListener
from woz_drivers.child_process import Child
from woz_drivers.picture_files import stamp
from woz_drivers.sound_file import SoundFile
from woz_drivers.speech.settings import TalkSettings
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverContext,
    DriverError,
    Job,
    RejectedError,
    Verb,
)
from woz_tui.drivers.sound_feeds import VOICE, VOICE_STATE, WIDTH, SoundReader, VoiceState
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
#: Without a voice for so long the sensor says that none comes; a program that gives nothing back
#: for so long, while one comes, is started again. In seconds.
_SILENT_S, _STUCK_S = 1.0, 3.0
#: What the player has when a voice is switched off is played to its end, within so many seconds.
_LAST_WORDS_S = 1.0
#: So much silence pushes the last of a voice out of a program, in seconds.
_FLUSH_S = 0.5
_SENDER = "arecord -f S16_LE -r {rate} -c 1 | ssh ROBOT woz talk"

VERBS = (
    Verb(
        "talk",
        "let somebody talk through the loudspeaker, until `end_talk`",
        lane="talk",
        drives=True,
        waits=False,
        limit_s=3700.0,
    ),
    Verb("end_talk", "end `talk`", lane="end_talk", brief=True),
)


@dataclass(slots=True)
class _Tally:
    """What became of one voice; frames."""

    began_us: int
    rate: int
    played: int = 0
    dropped: int = 0
    #: When a voice came last, and who sent it.
    came_us: int = 0
    by: str = ""
    #: What the sender had dropped by itself when it began, and by now, in seconds.
    lost_before_s: float | None = None
    lost_s: float = 0.0
    #: How old sound was when it was given to the player or the program: the sum, and pieces.
    age_us: int = 0
    pieces: int = 0
    file: str = ""

    def result(self, now_us: int) -> dict[str, Json]:
        """What the log has of it, in seconds."""
        at_sender = self.lost_s - (self.lost_before_s or 0.0)
        age_s = self.age_us / max(1, self.pieces) / 1_000_000
        return {
            "seconds": round((now_us - self.began_us) / 1_000_000, 3),
            "played": round(self.played / self.rate, 3),
            "dropped": round(self.dropped / self.rate + max(0.0, at_sender), 3),
            "delay": round(age_s, 3),
            "by": self.by,
            **({"file": self.file} if self.file else {}),
        }


@dataclass(slots=True)
class _Player:
    """The program that is heard, and the pipe to it."""

    child: Child
    pipe: int
    #: Bytes that the pipe takes.
    room: int
    sound: SoundFile | None = None
    #: Frames.
    played: int = 0
    dropped: int = 0

    def give(self, pcm: bytes) -> None:
        """Have samples played, as far as there is room: what has no room is dropped."""
        old = max(0, len(pcm) - self.room)
        self.dropped += old // WIDTH
        pcm = pcm[old:]
        for start in range(0, len(pcm), _PIECE):
            piece = pcm[start : start + _PIECE]
            try:
                os.write(self.pipe, piece)
            except (BlockingIOError, BrokenPipeError):  # an ended player is noticed elsewhere
                self.dropped += len(piece) // WIDTH
                continue
            self.played += len(piece) // WIDTH
            if self.sound is not None:
                self.sound.write_block(piece)


class LiveTalk:
    """`talk` and `end_talk` of one loudspeaker.

    Args:
        settings: Of `talk`.
        device: ALSA's, for the usual player.
        context: The driver's.
        volume: How loud the loudspeaker is set, 0 to 1.
    """

    def __init__(
        self,
        settings: TalkSettings,
        device: str,
        context: DriverContext,
        volume: Callable[[], float],
    ) -> None:
        self._settings = settings
        self._device = device
        self._context = context
        self._volume = volume
        self._voice = context.feed(VOICE)
        self._state = context.feed(VOICE_STATE)
        self._state.put(VoiceState(settings.rate))
        self._player: _Player | None = None
        self._ending: asyncio.Event | None = None
        self._through: ByteStream | None = None
        #: Why the program that changes the voice cannot be used; None: it can.
        self._trouble: DriverError | None = None
        self._cutter = self._fresh_cutter()
        #: Since when the program owes sound; None: it does not.
        self._owed_us: int | None = None
        self._shown: tuple[str, str] | None = None

    # -- the program that changes it -----------------------------------------------------------

    def start(self) -> None:
        """Start the program that changes the voice, if one is named."""
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
        return ChunkCutter(round(0.02 * self._settings.rate) * WIDTH, self._hear)

    def _begun(self) -> None:
        self._cutter = self._fresh_cutter()

    def _ready(self) -> None:
        self._trouble = None
        self._owed_us = None
        self._show("off" if self._player is None else "on")

    def _lost(self, trouble: DriverError) -> None:
        self._trouble = trouble
        self._show("stale", trouble.what)

    def _came_back(self, pcm: bytes) -> None:
        self._owed_us = None
        self._cutter.feed(pcm)

    def _flush(self) -> None:
        """What the program still has of a voice comes out now, and is not heard next time."""
        if self._through is not None and self._trouble is None:
            self._through.write(bytes(round(_FLUSH_S * self._settings.rate) * WIDTH))

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
        if self._player is None:
            return
        volume = self._volume()
        if volume != 1.0:
            samples = np.frombuffer(pcm, "<i2")
            pcm = (samples * volume).astype("<i2").tobytes()
        self._player.give(pcm)

    @contextlib.asynccontextmanager
    async def _playing(self, audible: set[Child]) -> AsyncIterator[_Player]:
        """The player's program runs; it ends with the block, and at once if that is cancelled."""
        settings = self._settings
        words = settings.play_words(self._device)
        reading, writing = os.pipe2(os.O_CLOEXEC)
        try:
            os.set_blocking(writing, False)
            room = round(_WAITING_S * settings.rate) * WIDTH
            fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, room)  # the kernel makes a page of it at least
            child = await child_process.start(words, self._context.folder, stdin=reading)
        except BaseException:
            os.close(writing)
            raise
        finally:
            os.close(reading)
        audible.add(child)
        player = self._player = _Player(child, writing, room)
        if settings.keep:
            path = self._context.media / f"talk-{stamp(self._context.clock.wall())}.wav"
            player.sound = SoundFile(path, settings.rate, 1, self._not_kept)
            player.sound.begin()
        open_pipe = [writing]
        try:
            yield player
            self._player = None
            os.close(open_pipe.pop())
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(_LAST_WORDS_S):
                    await child.wait()
        finally:
            self._player = None
            for pipe in open_pipe:
                os.close(pipe)
            if player.sound is not None:
                player.sound.end()
            audible.discard(child)
            await child.end()

    def _not_kept(self, why: str) -> None:
        self._context.notice(
            "error", f"the voice is not kept any more: {why}", "check the disk; it is still heard"
        )

    # -- the verbs -----------------------------------------------------------------------------

    async def talk(self, job: Job, audible: set[Child]) -> Mapping[str, Json]:
        """Play the voice that comes, until `end_talk`. `audible` has the player while it runs.

        Raises `DeviceLostError` without the program that changes the voice: it is never heard
        unchanged where one is named.
        """
        if self._trouble is not None:
            raise DeviceLostError(
                f"nobody can talk: {self._trouble.what}",
                self._trouble.remedy or "press the key again in a moment",
            )
        clock, rate = self._context.clock, self._settings.rate
        tally = _Tally(clock.now_us(), rate)
        ending = self._ending = asyncio.Event()
        why = "stopped"
        try:
            async with self._playing(audible) as player:
                if player.sound is not None:
                    media = self._context.media.name
                    tally.file = f"{media}/{player.sound.path.name}"
                self._state.put(VoiceState(rate, on=True))
                self._show("on")
                try:
                    why = await self._forward(player, tally, ending)
                finally:
                    tally.played += player.played
                    tally.dropped += player.dropped
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
            self._flush()
        return result

    async def _forward(self, player: _Player, tally: _Tally, ending: asyncio.Event) -> str:
        """Hand on what comes; why it is over."""
        clock, settings = self._context.clock, self._settings
        reader = SoundReader(self._voice)
        published_us = 0
        tally.came_us = tally.began_us
        while True:
            now, last = clock.now_us(), ending.is_set()
            if now - tally.began_us > settings.longest * 1_000_000:
                return f"it was on for {settings.longest:g} s"
            if not player.child.running:
                status = await player.child.wait()
                raise DriverError(
                    f"{player.child.program} ended: {player.child.reason(status)}",
                    "check the sound card, or `talk.play` in the robot file",
                )
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
            silent = now - tally.came_us > _SILENT_S * 1_000_000
            if self._trouble is None:
                why = f"no voice comes: {_SENDER.format(rate=settings.rate)}"
                self._show("silent", why) if silent else self._show("on")
            if self._owed_us is not None and now - self._owed_us > _STUCK_S * 1_000_000:
                await self._start_again()
                raise DriverError(
                    f"{settings.through_words()[0]} gave no sound for {_STUCK_S:g} s",
                    "it is started again; press the key again",
                )
            if last:  # what was said before the key counts
                return "switched off"
            await asyncio.sleep(_LOOK_S)

    def _change(self, pcm: bytes, tally: _Tally) -> None:
        if self._through is None:
            self._hear(pcm)
        elif self._trouble is not None:  # it died: nobody hears an unchanged voice
            tally.dropped += len(pcm) // WIDTH
        else:
            if self._owed_us is None:
                self._owed_us = self._context.clock.now_us()
            self._through.write(pcm)

    def end(self) -> Mapping[str, Json]:
        """End `talk`. Raises `RejectedError` if nobody talks."""
        if self._ending is None:
            raise RejectedError("nobody talks", "press the key of `talk` first")
        self._ending.set()
        return {}

    async def stop(self) -> None:
        """Fall silent at once, for what is on its way, too."""
        if self._player is not None:
            self._player.child.kill()
            await self._start_again()

    async def close(self) -> None:
        """End the program."""
        through, self._through = self._through, None
        if through is not None:
            await through.close()
