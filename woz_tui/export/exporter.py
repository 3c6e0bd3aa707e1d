"""What every exporter is given and tells, and the README that each of them writes."""

from __future__ import annotations

import abc
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

from woz_tui import __version__
from woz_tui.export.event_model import ExportSession
from woz_tui.export.log_sources import LogSource
from woz_tui.export.other_recording import OtherRecording
from woz_tui.export.output_folder import README, SIGN, OutputFolder, files_section
from woz_tui.system.text_cleaning import one_line, seconds

_TIMES = (
    "All times are in seconds since the beginning of the session, on a clock that never jumps. "
    "People appear under the codes that the experimenters gave them."
)
_REDACTED = (
    "What people said, typed or wrote was replaced by `[redacted]`; dates and sound were left out. "
    "Codes, the labels of the experiment file, numbers and times are as they were."
)
_UNREDACTED = (
    "Texts are unchanged: notes, markers, sentences spoken and recognised, free answers. "
    "They are personal data if somebody said or typed a name."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportOptions:
    """Options of an export.

    Attributes:
        redact: Take out texts, dates and sound.
        private: Answers that the experiment file calls private, too.
        samples: The values of the sensors too.
        sound: Write what was recorded of the visitor, as one file for each session.
        media: A video or sound of the session to open it with.
        spreadsheet: The language of the spreadsheet that is to open tables; empty: none.
        offset: The session's beginning in `media`, microseconds; negative: it began before.
        recording: Another program's recording, on whose time events are to be.
    """

    redact: bool = False
    private: bool = False
    samples: bool = False
    sound: bool = True
    media: Path | None = None
    spreadsheet: str = ""
    offset: int = 0
    recording: OtherRecording | None = None


@dataclass(slots=True)
class SessionSummary:
    """What the export of one session reports; `notes` are sentences."""

    session: ExportSession
    notes: list[str] = field(default_factory=list)
    participants: list[str] = field(default_factory=list)
    events: int = 0


class Exporter(abc.ABC):
    """Writes sessions in one format into a folder."""

    #: What it is, for the help of `woz export`.
    meaning: ClassVar[str]
    #: What the README says of the format's own files, in Markdown.
    about: ClassVar[str]
    #: Whether it can hold the values of the sensors.
    takes_samples: ClassVar[bool] = False
    #: Whether its times can be those of another program's recording.
    takes_recording: ClassVar[bool] = False

    def __init__(self, folder: OutputFolder, options: ExportOptions) -> None:
        self._folder = folder
        self._options = options

    @abc.abstractmethod
    def add(self, session: ExportSession, source: LogSource) -> list[str]:
        """Writes one session and returns, in sentences, what could not be exported of it."""

    def finish(self, summaries: list[SessionSummary]) -> None:
        """Writes the README after the last session."""
        parts = [
            f"{SIGN} {__version__}",
            _TIMES,
            _REDACTED if self._options.redact else _UNREDACTED,
            self.about,
            "## Sessions",
            "\n".join(_session(each) for each in summaries),
            files_section([README, *self._folder.names()]),
        ]
        self._folder.write(README, "\n\n".join(parts))

    def close(self) -> None:  # noqa: B027 - most have nothing open
        """Close what is open; also after an error."""


def _session(summary: SessionSummary) -> str:
    session = summary.session
    who = ", ".join(summary.participants) or "no participant's code"
    head = f"- {session.name}: {who}, {seconds(session.duration)} s, {session.lines} lines"
    damage = [f"damage: {one_line(each)}" for each in session.damage] or ["the log is complete"]
    return "\n".join([head, *(f"  - {line}" for line in [*damage, *map(one_line, summary.notes)])])
