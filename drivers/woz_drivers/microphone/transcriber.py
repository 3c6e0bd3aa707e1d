"""What a segment of speech says, by any program: whisper.cpp, vosk, a script, `ssh other ...`.

One segment at a time, and never in anybody's way: it has the lowest priority and a time limit, and
what waits too long is left out. Each segment that is handed in gets exactly one answer.
"""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from woz_drivers import child_process, command_lines
from woz_tui.drivers.contract import DriverContext, DriverError
from woz_tui.protocol.messages import SpeechText

log = logging.getLogger(__name__)

#: So many segments wait for the one that is being understood; the oldest is left out.
WAITING = 4
#: Longer texts are cut off, in characters: it is one utterance.
LONGEST = 2000
_MOST_BYTES = 65_536
#: How long a file may take to get to the disk before its text is given up, in seconds.
_FILE_S = 10.0


@dataclass(frozen=True, slots=True)
class SpeechToTranscribe:
    """A segment to be understood: its number, its file once that is there, when it ended on the
    clock, and what becomes of the file afterwards.
    """

    segment: int
    file: asyncio.Future[Path]
    ended_us: int
    done_with: Callable[[Path], object] | None = None


class Transcriber:
    """Runs `words` for each segment and tells the context what came out."""

    def __init__(
        self, driver: str, words: tuple[str, ...], limit_s: float, context: DriverContext
    ) -> None:
        self._driver = driver
        self._words = words
        self._limit_s = limit_s
        self._context = context
        self._waiting: deque[SpeechToTranscribe] = deque()
        self._news = asyncio.Event()
        self._warned = False
        self._task: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Begin to work."""
        self._task = asyncio.create_task(self._work())

    def add(self, heard: SpeechToTranscribe) -> None:
        """Understand this segment too; what waits longest is left out if it becomes too much."""
        self._waiting.append(heard)
        if len(self._waiting) > WAITING:
            late = self._waiting.popleft()
            self._answer(late, "", f"not recognised: {self._words[0]} is too slow")
            self._finish_with(late)
        self._news.set()

    async def close(self) -> None:
        """End the program; what is not understood by now never is."""
        task, self._task = self._task, None
        if task is not None:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
        while self._waiting:
            self._answer(self._waiting.popleft(), "", "the session ended before its turn")

    async def _work(self) -> None:
        while True:
            await self._news.wait()
            self._news.clear()
            while self._waiting:
                await self._transcribe(self._waiting.popleft())

    async def _transcribe(self, heard: SpeechToTranscribe) -> None:
        text, trouble = "", DriverError("the session ended meanwhile")
        try:
            text = await self._run(await _written_file(heard.file))
        except DriverError as error:
            trouble = error
        except Exception as error:  # one segment that cannot be read must not cost all later ones
            log.exception("segment %d was not understood", heard.segment)
            trouble = DriverError(f"{type(error).__name__}: {error}")
        else:
            trouble = DriverError("")
        finally:
            self._answer(heard, text, trouble.what)
            self._finish_with(heard)
        self._warn_once(trouble)

    def _warn_once(self, trouble: DriverError) -> None:
        """Tell the wizard once, and again only after it has worked in between."""
        if trouble.what and not self._warned:
            self._context.notice(
                "warning",
                f"speech is not recognised: {trouble.what}",
                trouble.remedy or "try the command of `transcribe` in a terminal",
            )
        self._warned = bool(trouble.what)

    def _answer(self, heard: SpeechToTranscribe, text: str, detail: str) -> None:
        took_us = max(0, self._context.clock.now_us() - heard.ended_us)
        message = SpeechText(
            driver=self._driver, segment=heard.segment, text=text, took_us=took_us, detail=detail
        )
        self._context.tell(message)

    def _finish_with(self, heard: SpeechToTranscribe) -> None:
        def over(file: asyncio.Future[Path]) -> None:
            if heard.done_with is not None and not file.cancelled() and file.exception() is None:
                heard.done_with(file.result())

        heard.file.add_done_callback(over)

    async def _run(self, file: Path) -> str:
        """What the program says of the file. Raises `DriverError`."""
        output = bytearray()

        def collect(data: bytes) -> None:
            output.extend(data[: _MOST_BYTES - len(output)])

        program = self._words[0]
        words = command_lines.fill(self._words, {"file": str(file)})
        running = await child_process.start(
            words, self._context.folder, on_output=collect, humble=True
        )
        try:
            async with asyncio.timeout(self._limit_s):
                status = await running.wait()
                await running.output_ended()
        except TimeoutError:
            raise DriverError(
                f"{program} took longer than {self._limit_s:g} s",
                "take a smaller model, or raise transcribe_limit",
            ) from None
        finally:
            await running.end()
        if status:
            raise DriverError(f"{program} ended: {running.reason(status)}")
        return one_line(output.decode("utf-8", "replace"))


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
