"""What is kept longer than about.yaml says. Nothing is deleted: somebody has to look first."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import UTC, date, datetime
from operator import attrgetter
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
    found: list[Kept] = []
    for session in sessions:
        recorded = _recorded(session.log)
        if retention.media:
            until = last_day(recorded, retention.media)
            found += (Kept(path, MEDIA, recorded, until) for path in session.media_folders())
        if retention.logs:
            until = last_day(recorded, retention.logs)
            found += (Kept(path, LOGS, recorded, until) for path in session.files.actions)
    over = (kept for kept in found if kept.until < today)
    yield from sorted(over, key=attrgetter("until", "path"))


def _recorded(log: Path) -> date:
    """The day in the log's name; without one, that of its last change."""
    named = _DAY.search(log.name)
    if named:
        try:
            return date.fromisoformat(named[0])
        except ValueError:
            pass
    return datetime.fromtimestamp(log.stat().st_mtime, UTC).date()
