"""`woz dictate` at work: a voice in, texts to the session."""

from __future__ import annotations

import asyncio
import time
import wave
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from woz_tui.client import WozClient, WozRefusedError
from woz_tui.drivers.contract import DriverError, FileTranscriber
from woz_tui.features.dictation.kinds import AskDictated, DictationListens
from woz_tui.features.dictation.speech_pieces import RATE, SpeechPieces
from woz_tui.system.tasks import end_tasks

#: Pieces that wait to be understood; what comes beside them is left out. Bytes read at once.
WAITING, _READ = 4, 3200
#: What whoever dictates is told.
OPEN = "woz dictate: listens; what you say comes into the field"
CLOSED = "woz dictate: waits; a key of the console opens the field (dictate in its list of keys)"


class Dictating:
    """Understands one piece after the other, of what is said while the field is open.

    Args:
        client: The session.
        transcriber: What turns a WAV file into text.
        folder: For that file, which is removed at once.
        say: Called with a sentence for whoever dictates.
        threshold: As of `SpeechPieces`.
    """

    def __init__(
        self,
        client: WozClient,
        transcriber: FileTranscriber,
        folder: Path,
        say: Callable[[str], None],
        threshold: float,
    ) -> None:
        self._client, self._transcriber = client, transcriber
        self._folder, self._say = folder, say
        self._threshold = threshold
        #: Of what is said now; None: the field is not open, and nothing of it is looked at.
        self._pieces: SpeechPieces | None = None
        self._waiting: asyncio.Queue[tuple[bytes, float]] = asyncio.Queue(WAITING)

    async def run(self, voice: BinaryIO) -> None:
        """Until the voice ends. Raises `WozConnectionError`: the session is over."""
        work = asyncio.create_task(self._understand(), name="dictation")
        follow = asyncio.create_task(self._follow(), name="field of dictation")
        try:
            while data := await asyncio.to_thread(voice.read, _READ):
                for piece in self._pieces.add(data) if self._pieces is not None else ():
                    self._put(piece)
                if work.done() or follow.done():
                    break
            self._end_piece()
            done = asyncio.create_task(self._waiting.join())
            await asyncio.wait({work, done}, return_when=asyncio.FIRST_COMPLETED)
            await end_tasks(done)
            for each in (work, follow):
                if each.done():
                    each.result()
        finally:
            await end_tasks(work, follow)

    async def _follow(self) -> None:
        """Whether the field is open. Ends with the session."""
        listens = self._client.messages(DictationListens, held=True)
        self._say(CLOSED)
        async for message in listens:
            if message.on:
                self._pieces = SpeechPieces(self._threshold)
                self._say(OPEN)
            else:
                self._end_piece()
                self._say(CLOSED)

    def _end_piece(self) -> None:
        """What was being said counts, as far as it came; what is said from now on does not."""
        pieces, self._pieces = self._pieces, None
        for piece in pieces.end() if pieces is not None else ():
            self._put(piece)

    def _put(self, piece: bytes) -> None:
        try:
            self._waiting.put_nowait((piece, time.monotonic()))
        except asyncio.QueueFull:
            self._say("woz dictate: the recogniser is too slow; something was left out")

    async def _understand(self) -> None:
        file = self._folder / "dictated.wav"
        while True:
            piece, ended = await self._waiting.get()
            try:
                await asyncio.to_thread(_write, file, piece)
                text = " ".join((await self._transcriber.text_of(file)).split())
                if text:
                    took = round((time.monotonic() - ended) * 1e6)
                    lasted = round(len(piece) / 2 / RATE * 1e6)
                    asked = AskDictated(text=text, lasted_us=lasted, took_us=took)
                    await self._client.request(asked)
                    self._say(text)
            except (DriverError, WozRefusedError) as error:
                self._say(f"woz dictate: {error}")
            finally:
                file.unlink(missing_ok=True)
                self._waiting.task_done()


def _write(file: Path, piece: bytes) -> None:
    with wave.open(str(file), "wb") as sound:
        sound.setnchannels(1)
        sound.setsampwidth(2)
        sound.setframerate(RATE)
        sound.writeframes(piece)
