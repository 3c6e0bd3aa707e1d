"""Joins a session with the recording of another program, such as that of an EEG."""

from __future__ import annotations

import abc
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from woz_tui.export.event_model import ExportSession, JoinedRecording
from woz_tui.export.log_sources import ExportError, LogSource
from woz_tui.feature import pieces
from woz_tui.log.log_reader import Damage, LogLine


@dataclass(frozen=True, slots=True)
class OtherRecording:
    """The file of another program. `stream`: whose first value is the beginning of its time; empty:
    the reader chooses.
    """

    path: Path
    stream: str = ""


class RecordingReader(abc.ABC):
    """Reads the recordings of one program."""

    @abc.abstractmethod
    def join(
        self, recording: OtherRecording, session: ExportSession, lines: Iterable[LogLine]
    ) -> JoinedRecording:
        """How the session lies in the recording. `lines`: of its log, samples left out.

        Raises `ExportError`: the session is not in it, or it cannot be read.
        """


def readers() -> dict[str, RecordingReader]:
    """Of all features, by how the names of the files end (`.xdf`)."""
    return {end: each for some in pieces("recordings", dict).values() for end, each in some.items()}


def joined(recording: OtherRecording, session: ExportSession, source: LogSource) -> JoinedRecording:
    """How a session lies in a recording. Raises `ExportError`."""
    known, path = readers(), recording.path
    reader = known.get(path.suffix.lower())
    if reader is None:
        raise ExportError(f"{path.name} is of no known kind", f"known are {', '.join(known)}")
    if not path.is_file():
        raise ExportError(f"{path}: there is no such file", "check the name")
    return reader.join(recording, session, source.lines(Damage()))
