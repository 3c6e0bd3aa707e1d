"""Phases on the time line of a replay."""

from __future__ import annotations

from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.replay.bookmarks import Bookmark, FeatureBookmarks


def _phase(message: PhaseChanged, t: int) -> Bookmark | None:
    return Bookmark(t, "phase", f"phase {message.phase}") if message.phase else None


BOOKMARKS = FeatureBookmarks({PhaseChanged: _phase})
