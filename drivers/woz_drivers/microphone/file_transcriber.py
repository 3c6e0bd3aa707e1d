"""The recogniser of a microphone for files of somebody else, such as what a wizard dictates.

It has a process of its own: the visitor's text does not wait for it.
"""

from __future__ import annotations

from pathlib import Path

from woz_drivers.microphone.settings import MicrophoneSettings
from woz_drivers.microphone.transcriber import ProgramForEachSegment, Transcript
from woz_drivers.programs.resident_program import ResidentProgram
from woz_tui.drivers.contract import FileTranscriber


class ResidentFileTranscriber:
    """A program that stays loaded."""

    def __init__(self, settings: MicrophoneSettings, folder: Path) -> None:
        self._limit_s = settings.transcribe_limit
        self._request = {"language": settings.language} if settings.language else {}
        self._program = ResidentProgram(settings.resident_words, folder, humble=True)

    async def text_of(self, file: Path) -> str:
        """Ask it; it is loaded with the first question."""
        request = {"file": str(file), **self._request}
        return (await self._program.ask(request, Transcript, self._limit_s)).text

    async def close(self) -> None:
        """End it."""
        await self._program.close()


class ProgramForEachFile:
    """A program that is started for each file."""

    def __init__(self, settings: MicrophoneSettings, folder: Path) -> None:
        self._program = ProgramForEachSegment(
            settings.transcriber, settings.transcribe_limit, folder
        )

    async def text_of(self, file: Path) -> str:
        """Run it."""
        return (await self._program.transcribe(file, _unread)).text

    async def close(self) -> None:
        """It has ended with its file."""
        await self._program.close()


def file_transcriber(settings: MicrophoneSettings, folder: Path) -> FileTranscriber | None:
    """What these settings name, if anything."""
    if settings.resident_words:
        return ResidentFileTranscriber(settings, folder)
    return ProgramForEachFile(settings, folder) if settings.transcriber else None


def _unread(text: str) -> None:
    """Of a text so far, which nobody waits for."""
