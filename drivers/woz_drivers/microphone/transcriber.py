"""What a segment of speech says, by any program: whisper.cpp, vosk, a script, `ssh other ...`.

It is started for each segment, or stays loaded. One segment at a time, and never in anybody's way:
it has the lowest priority and a time limit, and what waits too long is left out. Each segment that
is handed in gets exactly one answer.
"""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Protocol

import msgspec

from woz_drivers.programs import child_process, command_lines
from woz_drivers.programs.resident_program import ResidentProgram
from woz_tui.drivers.contract import SPEECH, DriverContext, DriverError
from woz_tui.drivers.own_voice import is_robots
from woz_tui.protocol.messages import SpeechText, SpokenWord
from woz_tui.sensing.sample_values import agreed
from woz_tui.system.tasks import end_tasks

log = logging.getLogger(__name__)

#: So many segments wait for the one that is being understood; the oldest is left out.
WAITING = 4
#: Longer texts are cut off, in characters and in words with times: it is one utterance.
LONGEST = 2000
_MOST_WORDS = 400
_MOST_BYTES = 65_536
#: How long a file may take to get to the disk before its text is given up, in seconds.
_FILE_S = 10.0


#: The sensor that tells how the program is, and the delay of its last text in seconds.
TRANSCRIBER = "transcriber"
#: What is understood so far is published this often at most, in microseconds.
_PARTIAL_EVERY_US = 300_000


@dataclass(frozen=True, slots=True)
class HeardVoice:
    """Whose voice a segment is, as in `speech.started`; and what the robot said in that time, if it
    is its own.
    """

    own: bool | None = None
    overlap: bool = False
    said: str = ""

    def with_words(self, text: str) -> HeardVoice:
        """The same once its words are known: those that are not the robot's are a visitor's."""
        if not self.own or is_robots(text, self.said):
            return self
        return HeardVoice(own=False, overlap=True)


@dataclass(frozen=True, slots=True)
class SpeechToTranscribe:
    """A segment to be understood: its number, its file once that is there, when it began on the
    axis of `t` and ended on the clock, what becomes of the file afterwards, whether it goes on
    (then its text is shown and not kept), and whose voice it is.
    """

    segment: int
    file: asyncio.Future[Path]
    began: int
    ended_us: int
    done_with: Callable[[Path], object] | None = None
    goes_on: bool = False
    voice: HeardVoice = HeardVoice()


class TranscribedWord(msgspec.Struct, frozen=True):
    """A word; `begin` and `end` in seconds from the beginning of the file."""

    word: str
    begin: float
    end: float
    confidence: float | None = None


class Transcript(msgspec.Struct, frozen=True):
    """What a program says of a file. `confidence` 0 to 1; `language` in which it was understood."""

    text: str = ""
    words: list[TranscribedWord] = []
    confidence: float | None = None
    language: str = ""


@dataclass(slots=True)
class TextsSoFar:
    """What was shown of a segment before its text: how many there were, how many took back a word
    of the one before, and the moment of the first, on the axis of `t`.
    """

    segment: int = 0
    shown: int = 0
    revised: int = 0
    first: int | None = None
    last: str = ""

    def show(self, text: str, t: int) -> None:
        """This is shown now."""
        self.shown += 1
        self.revised += len(agreed(self.last, text).split()) < len(self.last.split())
        self.first = t if self.first is None else self.first
        self.last = text


class TranscribingProgram(Protocol):
    """How a program is asked."""

    @property
    def name(self) -> str:
        """How it is named in sentences."""

    @property
    def warned(self) -> bool:
        """Whether it has told the wizard itself that it is not there."""

    def start(self) -> None:
        """The session begins."""

    async def transcribe(self, file: Path, on_part: Callable[[str], None]) -> Transcript:
        """What is said in a file; `on_part` hears the text so far. Raises `DriverError`."""

    async def close(self) -> None:
        """End it."""


class ProgramForEachSegment:
    """Runs `words` for each segment; what it prints is the text."""

    warned = False

    def __init__(self, words: tuple[str, ...], limit_s: float, folder: Path) -> None:
        self._words = words
        self._limit_s = limit_s
        self._folder = folder

    @property
    def name(self) -> str:
        """The program's."""
        return self._words[0]

    def start(self) -> None:
        """It is started later."""

    async def close(self) -> None:
        """It has ended with its segment."""

    async def transcribe(self, file: Path, on_part: Callable[[str], None]) -> Transcript:
        """Run it once."""
        output = bytearray()

        def collect(data: bytes) -> None:
            output.extend(data[: _MOST_BYTES - len(output)])

        words = command_lines.fill(self._words, {"file": str(file)})
        running = await child_process.start(words, self._folder, on_output=collect, humble=True)
        try:
            async with asyncio.timeout(self._limit_s):
                status = await running.wait()
                await running.output_ended()
        except TimeoutError:
            raise DriverError(
                f"{self.name} took longer than {self._limit_s:g} s",
                "take a smaller model, or raise transcribe_limit",
            ) from None
        finally:
            await running.end()
        if status:
            raise DriverError(f"{self.name} ended: {running.reason(status)}")
        return Transcript(output.decode("utf-8", "replace"))


class ResidentTranscriber:
    """A program that stays loaded; the sensor `transcriber` tells how it is.

    Request: `file`, and `language` if one is wanted. Answer: a `Transcript`.
    """

    def __init__(
        self, words: tuple[str, ...], limit_s: float, language: str, context: DriverContext
    ) -> None:
        self._limit_s = limit_s
        self._request = {"language": language} if language else {}
        self._context = context
        self._program = ResidentProgram(words, context.folder, self._state, humble=True)
        self.warned = False

    @property
    def name(self) -> str:
        """The program's."""
        return self._program.program

    def start(self) -> None:
        """Load it."""
        self._program.start()

    async def close(self) -> None:
        """End it."""
        await self._program.close()

    async def transcribe(self, file: Path, on_part: Callable[[str], None]) -> Transcript:
        """Ask it."""

        def part(line: Mapping[str, Any]) -> None:
            on_part(str(line.get("text", "")))

        request = {"file": str(file), **self._request}
        transcript = await self._program.ask(request, Transcript, self._limit_s, part)
        self.warned = False
        if transcript.language or "language" not in self._request:
            return transcript
        return msgspec.structs.replace(transcript, language=self._request["language"])

    def _state(self, state: str, why: str, remedy: str) -> None:
        if state == "lost":
            self._context.sensor(TRANSCRIBER, "stale", why)
            if not self.warned:
                self._context.notice("warning", f"{why}; it is started again", remedy)
            self.warned = True
        elif state == "loading":
            self._context.sensor(TRANSCRIBER, "loading", why)
        else:
            self._context.sensor(TRANSCRIBER, "ready", why)


class Transcriber:
    """Has a program understand segments, and tells the context what came out.

    `partial_s`: how often it is to be asked what was said so far; 0: never.
    """

    def __init__(
        self,
        driver: str,
        program: TranscribingProgram,
        context: DriverContext,
        partial_s: float = 0.0,
    ) -> None:
        self.partial_s = partial_s
        self._driver = driver
        self._program = program
        self._context = context
        self._waiting: deque[SpeechToTranscribe] = deque()
        self._news = asyncio.Event()
        self._warned = False
        self._busy = False
        self._task: asyncio.Task[None] | None = None
        #: When a text so far was published last, and those of the segment under way.
        self._shown_us = 0
        self._so_far = TextsSoFar()

    @property
    def idle(self) -> bool:
        """Whether nothing waits or is under way."""
        return not self._waiting and not self._busy

    def start(self) -> None:
        """Begin to work."""
        self._program.start()
        self._task = asyncio.create_task(self._work())

    def add(self, heard: SpeechToTranscribe) -> None:
        """Understand this segment too; what waits longest is left out if it becomes too much."""
        self._waiting.append(heard)
        if len(self._waiting) > WAITING:
            late = self._waiting.popleft()
            self._answer(late, Transcript(), f"not recognised: {self._program.name} is too slow")
            self._finish_with(late)
        self._news.set()

    async def close(self) -> None:
        """End the program; what is not understood by now never is."""
        task, self._task = self._task, None
        await end_tasks(task)
        await self._program.close()
        while self._waiting:
            ended = self._waiting.popleft()
            self._answer(ended, Transcript(), "the session ended before its turn")

    async def _work(self) -> None:
        while True:
            await self._news.wait()
            self._news.clear()
            while self._waiting:
                self._busy = True
                try:
                    await self._transcribe(self._waiting.popleft())
                finally:
                    self._busy = False

    async def _transcribe(self, heard: SpeechToTranscribe) -> None:
        transcript, trouble = Transcript(), DriverError("the session ended meanwhile")
        try:
            file = await _written_file(heard.file)
            transcript = await self._program.transcribe(file, partial(self._show, heard))
        except DriverError as error:
            trouble = error
        except Exception as error:  # one segment that cannot be read must not cost all later ones
            log.exception("segment %d was not understood", heard.segment)
            trouble = DriverError(f"{type(error).__name__}: {error}")
        else:
            trouble = DriverError("")
        finally:
            self._answer(heard, transcript, trouble.what)
            self._finish_with(heard)
        self._warn_once(trouble)

    def _warn_once(self, trouble: DriverError) -> None:
        """Tell the wizard once, and again only after it has worked in between."""
        if trouble.what and not self._warned and not self._program.warned:
            self._context.notice(
                "warning",
                f"speech is not recognised: {trouble.what}",
                trouble.remedy or "try the command of `transcribe` in a terminal",
            )
        self._warned = bool(trouble.what)

    def _show(self, heard: SpeechToTranscribe, text: str) -> None:
        """Publish what is understood of it so far, unless it is the robot's own voice."""
        if heard.voice.own:
            return
        if self._so_far.segment != heard.segment:
            self._so_far = TextsSoFar(heard.segment)
        text, now = one_line(text), self._context.clock.now_us()
        if text and text != self._so_far.last and now - self._shown_us >= _PARTIAL_EVERY_US:
            self._shown_us = now
            self._so_far.show(text, self._context.t(now))
            self._context.reading(SPEECH, None, text=text)

    def _answer(self, heard: SpeechToTranscribe, transcript: Transcript, detail: str) -> None:
        if heard.goes_on:
            self._show(heard, transcript.text)
            return
        took_us = max(0, self._context.clock.now_us() - heard.ended_us)
        if not detail:
            self._context.reading(TRANSCRIBER, round(took_us / 1_000_000, 2), unit="s")
        voice = heard.voice.with_words(transcript.text)
        so_far = self._so_far if self._so_far.segment == heard.segment else TextsSoFar()
        if so_far.shown and not detail:  # the text so far has become this one
            self._context.reading(SPEECH, None, text=one_line(transcript.text))
        message = SpeechText(
            driver=self._driver,
            segment=heard.segment,
            text=one_line(transcript.text),
            took_us=took_us,
            detail=detail,
            words=[_placed(word, heard.began) for word in transcript.words[:_MOST_WORDS]],
            confidence=transcript.confidence,
            own=voice.own,
            overlap=voice.overlap,
            language=one_line(transcript.language),
            partials=so_far.shown,
            revised=so_far.revised,
            first_us=None if so_far.first is None else max(0, so_far.first - heard.began),
        )
        self._context.tell(message)

    def _finish_with(self, heard: SpeechToTranscribe) -> None:
        def over(file: asyncio.Future[Path]) -> None:
            if heard.done_with is not None and not file.cancelled() and file.exception() is None:
                heard.done_with(file.result())

        heard.file.add_done_callback(over)


def _placed(word: TranscribedWord, began: int) -> SpokenWord:
    """A word at its time on the axis of `t`; the segment began at `began`."""
    return SpokenWord(
        text=one_line(word.word),
        began=began + round(word.begin * 1_000_000),
        ended=began + round(word.end * 1_000_000),
        confidence=word.confidence,
    )


def one_line(text: str) -> str:
    """A program's output as one line that a screen can show: no control characters, one blank
    between two words, cut off where it is far too long for an utterance.
    """
    visible = "".join(letter if letter.isprintable() else " " for letter in text)
    line = " ".join(visible.split())
    return line if len(line) <= LONGEST else f"{line[: LONGEST - 1]}…"


async def _written_file(file: asyncio.Future[Path]) -> Path:
    """The file, once it is written. Raises `DriverError`."""
    try:
        return await asyncio.wait_for(asyncio.shield(file), _FILE_S)
    except TimeoutError:
        why = f"not within {_FILE_S:g} s"
    except OSError as error:
        why = error.strerror or str(error)
    raise DriverError(f"its sound was not written: {why}", "check the disk")
