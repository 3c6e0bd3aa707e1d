"""Publishes segments of speech in order, with the times of their sound, and keeps their files."""

from __future__ import annotations

import asyncio
import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec

from woz_drivers.microphone.segment_files import SegmentFiles
from woz_drivers.microphone.speech_detection import BLOCK_S
from woz_drivers.microphone.transcriber import HeardVoice, SpeechToTranscribe, Transcriber
from woz_drivers.sound import pcm_audio
from woz_tui.drivers.contract import DriverContext
from woz_tui.drivers.own_voice import ROBOT_SPEECH, RobotSpeech
from woz_tui.protocol.messages import SpeechEnded, SpeechStarted
from woz_tui.sensing.speech_endpoint import SpeechEnd, SpeechStart
from woz_tui.system.tasks import READ_AGAIN_S, STOOD_STILL_S

BLOCK_US = round(BLOCK_S * 1_000_000)

#: The promptest block of this many, and of as many before them, tells what the clock said when the
#: sound began: 5 s. A converter's clock drifts by a millisecond in that time at most.
_WINDOW = 250
#: The end of an utterance is published after this time at most, in seconds, file or no file: the
#: robot reacts to it. A moment more where this process stood still.
_FILE_S = 0.15
#: The robot's own voice is understood if it is so many blocks long: programs make words of less.
_LEAST_OWN = 15


@dataclass(frozen=True, slots=True)
class _Block:
    """A block on the tape: its RMS, and its sound if that is wanted."""

    level: float
    pcm: bytes


@dataclass(slots=True)
class _PendingEnd:
    """The end of a segment whose file may be on its way; when `late` it is published without."""

    message: SpeechEnded
    file: asyncio.Future[Path] | None
    name: str
    clock_us: int
    said: str = ""
    late: bool = False
    timer: asyncio.TimerHandle | None = None


class SpeechSegments:
    """The tape of the last seconds, and what is cut out of it.

    `keep`: WAV files of what is said stay in the session's folder for media. With a `transcriber`
    each segment is understood too, and what was said of it so far while the transcriber has
    nothing else to do. `drop`: of the robot's own voice nothing is told.
    """

    def __init__(
        self,
        driver: str,
        rate: int,
        context: DriverContext,
        keep: bool,
        transcriber: Transcriber | None,
        *,
        drop: bool = False,
    ) -> None:
        self._driver = driver
        self._context = context
        self._keep = keep
        self._drop = drop
        self._transcriber = transcriber
        self._files = SegmentFiles(rate, self._warn_unsafe)
        self._time = SoundClock()
        self._tape: deque[_Block] = deque()
        self._first = 0
        self._segment = 0
        self._began = 0
        #: First block of the segment under way; None: nobody speaks.
        self._open: int | None = None
        self._voice = HeardVoice()
        self._robots = context.feed(ROBOT_SPEECH)
        self._partial_blocks = round(transcriber.partial_s / BLOCK_S) if transcriber else 0
        self._warned_not_kept = False
        self._warned_unsafe = False
        self._unpublished: deque[SpeechStarted | _PendingEnd] = deque()

    def forget(self) -> None:
        """A new stream begins, with block 0."""
        self._time.forget()
        self._tape.clear()
        self._first = 0
        self._open = None

    def gap(self) -> None:
        """Sound is missing between the last block and the next."""
        self._time.forget()

    def add(self, samples: pcm_audio.Samples, level: float, clock_us: int) -> None:
        """The next block, and the clock when it came."""
        wanted = self._keep or self._transcriber is not None
        pcm = pcm_audio.encode(samples, "S16_LE") if wanted else b""
        self._tape.append(_Block(level, pcm))
        self._time.arrived(self._first + len(self._tape) - 1, clock_us)

    @property
    def open(self) -> int | None:
        """The first block of the segment under way; None: nobody speaks."""
        return self._open

    @property
    def latest(self) -> int:
        """The last block."""
        return self._first + len(self._tape) - 1

    def level(self, block: int) -> float:
        """A block's RMS; those of the open segment and its pre-roll are there."""
        return self._tape[block - self._first].level

    def t(self, block: int) -> int:
        """When a block began, on the axis of `t`."""
        return self._context.t(self._time.begins(block))

    def happened(
        self, event: SpeechStart | SpeechEnd | None, earliest: int, voice: HeardVoice
    ) -> None:
        """What began or ended with that block, and whose voice begins; blocks before `earliest` are
        not needed any more.
        """
        if isinstance(event, SpeechStart):
            self._started(event, voice)
        elif isinstance(event, SpeechEnd):
            self.ended(event, "cut: it goes on in the next segment" if event.cut else "")
        elif self._open is not None:
            self._ask_so_far(self._open)
        while self._first < earliest and self._tape:
            self._tape.popleft()
            self._first += 1

    def ended(self, event: SpeechEnd, detail: str) -> None:
        """A segment is over; `detail` says why, where it is not because of silence."""
        self._open = None
        if self._left_out:
            return
        blocks = [self._tape[n - self._first] for n in range(event.first, event.last + 1)]
        message = SpeechEnded(
            driver=self._driver,
            segment=self._segment,
            began=self._began,
            ended=self._began + len(blocks) * BLOCK_US,
            loudest=max(block.level for block in blocks),
            detail=detail,
            own=self._voice.own,
            overlap=self._voice.overlap,
        )
        name = f"{self._driver}-{self._segment:04d}.wav"
        media = self._context.media
        file = self._save(blocks, media / name)
        ending = _PendingEnd(message, file, f"{media.name}/{name}", self._context.clock.now_us())
        ending.said = self._said(message) if message.own else ""
        ending.late = not self._keep
        if file is not None and not ending.late:
            file.add_done_callback(lambda _: self._publish())
            loop = asyncio.get_running_loop()
            due = loop.time() + _FILE_S
            ending.timer = loop.call_at(due, self._give_up_file, ending, due)
        self._unpublished.append(ending)
        self._publish()

    async def close(self) -> None:
        """Publish what is left, whatever the disk does; lent files are deleted."""
        for message in self._unpublished:
            if isinstance(message, _PendingEnd):
                message.late = True
        self._publish()
        if self._transcriber is not None:
            await self._transcriber.close()
        self._files.close()

    # -- publishing, in order -------------------------------------------------------------------

    @property
    def _left_out(self) -> bool:
        return self._drop and bool(self._voice.own)

    def _started(self, event: SpeechStart, voice: HeardVoice) -> None:
        self._open, self._voice = event.first, voice
        if self._left_out:
            return
        self._segment += 1
        self._began = self.t(event.first)
        message = SpeechStarted(
            driver=self._driver,
            segment=self._segment,
            began=self._began,
            own=voice.own,
            overlap=voice.overlap,
        )
        self._unpublished.append(message)
        self._publish()

    def _ask_so_far(self, first: int) -> None:
        """Have the transcriber say what was said so far, if it is time and has nothing to do."""
        count = self._first + len(self._tape) - first
        every, transcriber = self._partial_blocks, self._transcriber
        if not every or count % every or transcriber is None or not transcriber.idle:
            return
        if self._voice.own:  # nobody is to read what the robot says as a visitor's words
            return
        pcm = b"".join(self._tape[n - self._first].pcm for n in range(first, first + count))
        file = self._files.lend(f"{self._driver}-{self._segment:04d}-{count}.wav", pcm)
        transcriber.add(
            SpeechToTranscribe(
                *(self._segment, file, self._began, self._context.clock.now_us()),
                self._files.give_back,
                goes_on=True,
                voice=self._voice,
            )
        )

    def _give_up_file(self, ending: _PendingEnd, due: float) -> None:
        loop = asyncio.get_running_loop()
        if loop.time() - due > STOOD_STILL_S:
            # It may be there, and nobody has read yet that it is: once more.
            ending.timer = loop.call_later(READ_AGAIN_S, self._give_up_file, ending, math.inf)
            return
        ending.late = True
        self._publish()

    def _publish(self) -> None:
        """Publish what has happened, up to the first end whose file is still being written."""
        while self._unpublished:
            message = self._unpublished[0]
            if isinstance(message, _PendingEnd) and not (message.late or _written(message)):
                return
            self._unpublished.popleft()
            if isinstance(message, _PendingEnd):
                self._publish_end(message)
            else:
                self._context.tell(message)

    def _publish_end(self, ending: _PendingEnd) -> None:
        if ending.timer is not None:
            ending.timer.cancel()
        self._context.tell(self._with_file(ending))
        if self._transcriber is not None and ending.file is not None:
            back = None if self._keep else self._files.give_back
            end = ending.message
            self._transcriber.add(
                SpeechToTranscribe(
                    *(end.segment, ending.file, end.began, ending.clock_us, back),
                    voice=HeardVoice(end.own, end.overlap, ending.said),
                )
            )

    def _said(self, message: SpeechEnded) -> str:
        """What the robot said in that time."""
        speech = self._robots.latest().value
        if not isinstance(speech, RobotSpeech):
            return ""
        return speech.said_within(message.began, message.ended)

    # -- files ---------------------------------------------------------------------------------

    def _save(self, blocks: Sequence[_Block], path: Path) -> asyncio.Future[Path] | None:
        pcm = b"".join(block.pcm for block in blocks)
        if self._keep:
            return self._files.keep(path, pcm)
        if self._transcriber is None or (self._voice.own and len(blocks) < _LEAST_OWN):
            return None
        return self._files.lend(path.name, pcm)

    def _with_file(self, ending: _PendingEnd) -> SpeechEnded:
        """The end of a segment with its file, or with why there is none."""
        message, file = ending.message, ending.file
        if not self._keep or file is None:
            return message
        if not file.done():
            return _with_detail(message, f"the disk is slow: {ending.name} is still being written")
        error = file.exception()
        self._warn_not_kept(error)
        if error is not None:
            return _with_detail(message, f"not kept: {_reason(error)}")
        return msgspec.structs.replace(message, file=ending.name)

    def _warn_not_kept(self, error: BaseException | None) -> None:
        """Tell the wizard once, and again only after a file could be kept in between."""
        if error is not None and not self._warned_not_kept:
            self._context.notice(
                "warning",
                f"speech is not kept: {_reason(error)}",
                "make room beside the log; everything else goes on",
            )
        self._warned_not_kept = error is not None

    def _warn_unsafe(self, error: OSError) -> None:
        """Tell the wizard once that the disk has not taken what it was given."""
        if not self._warned_unsafe:
            self._context.notice(
                "warning",
                f"a file of speech may be lost in a power cut: {_reason(error)}",
                "the disk may be failing: copy the recordings soon; everything else goes on",
            )
        self._warned_unsafe = True


def _written(ending: _PendingEnd) -> bool:
    """Whether there is nothing to wait for: the file is there, or will never be."""
    return ending.file is None or ending.file.done()


def _with_detail(message: SpeechEnded, why: str) -> SpeechEnded:
    detail = f"{message.detail}; {why}" if message.detail else why
    return msgspec.structs.replace(message, detail=detail)


def _reason(error: BaseException) -> str:
    return (isinstance(error, OSError) and error.strerror) or str(error)


class SoundClock:
    """Ties the blocks of a stream to a clock.

    A block can be late, because pipes and busy machines hold it back, but never early: of the
    blocks of the last seconds, that which took the least time to arrive is right for all of them.
    """

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """A new stream begins, or the old one after a gap."""
        self._count = 0
        self._before: int | None = None
        self._now: int | None = None

    def arrived(self, block: int, clock_us: int) -> None:
        """Block number `block` has come; `clock_us` is a reading of the clock."""
        zero = clock_us - (block + 1) * BLOCK_US
        if self._count == _WINDOW:
            self._before, self._now, self._count = self._now, None, 0
        self._count += 1
        self._now = zero if self._now is None else min(self._now, zero)

    def begins(self, block: int) -> int:
        """When a block's first sample was heard, on the clock; blocks to come included."""
        known = [zero for zero in (self._before, self._now) if zero is not None]
        if not known:
            raise ValueError("no block has arrived yet")
        return min(known) + block * BLOCK_US
