"""What is kept longer than about.yaml says. Nothing is deleted: somebody has to look first."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import UTC, date, datetime
from pathlib import Path

from woz_tui.config.about_file import RetentionEntry, last_day
from woz_tui.protocol.messages import Json
from woz_tui.withdrawal.stored_files import StoredSession

_DAY = re.compile(r"\d{4}-\d\d-\d\d(?=T)")
LOGS, MEDIA = "log", "sound and pictures"


@dataclass(frozen=True, slots=True)
class Kept:
    """Something whose time is over: what it is, when it was recorded, and its last day."""

    path: Path
    what: str
    recorded: date
    until: date

    def as_json(self) -> Json:
        return {
            "path": str(self.path),
            "what": self.what,
            "recorded": self.recorded.isoformat(),
            "until": self.until.isoformat(),
        }


def overdue(
    sessions: Iterable[StoredSession], retention: RetentionEntry, today: date
) -> Iterator[Kept]:
    """All that was to be kept no longer than until before `today`, the oldest first."""
    found = [
        kept for session in sessions for kept in _kept(session, retention) if kept.until < today
    ]
    yield from sorted(found, key=lambda kept: (kept.until, kept.path))


def _kept(session: StoredSession, retention: RetentionEntry) -> Iterator[Kept]:
    recorded = _recorded(session.log)
    if retention.media:
        for path in session.media_folders():
            yield Kept(path, MEDIA, recorded, last_day(recorded, retention.media))
    if retention.logs:
        for path in session.files.actions:
            yield Kept(path, LOGS, recorded, last_day(recorded, retention.logs))


def _recorded(log: Path) -> date:
    """The day in the log's name; without one, that of its last change."""
    named = _DAY.search(log.name)
    if named:
        try:
            return date.fromisoformat(named[0])
        except ValueError:
            pass
    return datetime.fromtimestamp(log.stat().st_mtime, UTC).date()
