"""Phases on the time line of a replay."""

from __future__ import annotations

from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.protocol.sentence import Sentence
from woz_tui.replay.bookmarks import Bookmark, FeatureBookmarks


def _phase(message: PhaseChanged, t: int) -> Bookmark | None:
    if not message.phase:
        return None
    return Bookmark(
        t, "phase", Sentence("replay.phase_named", "phase {phase}", phase=message.phase)
    )


BOOKMARKS = FeatureBookmarks({PhaseChanged: _phase})
