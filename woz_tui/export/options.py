"""What an exporter is told, and what it tells."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from woz_tui.export.course import Session
from woz_tui.export.sources import Source


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    """How to export.

    Attributes:
        redact: Take out texts, dates and sound.
        samples: The values of the sensors too.
        sound: Write what was recorded of the visitor, as one file for each session.
        media: A video or sound of the session to open it with.
        offset: The session's beginning in `media`, microseconds; negative: it began before.
    """

    redact: bool = False
    samples: bool = False
    sound: bool = True
    media: Path | None = None
    offset: int = 0


@dataclass(slots=True)
class Told:
    """What is worth knowing of the export of one session; `notes` are sentences."""

    session: Session
    notes: list[str] = field(default_factory=list)
    participants: list[str] = field(default_factory=list)
    events: int = 0


class Exporter(Protocol):
    """Writes sessions in one format into a folder."""

    def add(self, session: Session, source: Source) -> list[str]:
        """One session. What could not be exported of it, in sentences."""

    def finish(self, told: list[Told]) -> None:
        """Whatever comes after the last session."""

    def close(self) -> None:
        """Close what is open; also after an error."""
