"""What features count in sessions, and say of it in reports."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from woz_tui.timeline.timeline import Timeline


class FeatureFigures:
    """A feature's figures of a session. What `count` returns is given to the others."""

    def count(self, timeline: Timeline) -> Any:
        """The figures of one session; None: there is nothing to say."""
        return None

    def circumstances(self, figures: Any) -> Iterator[str]:
        """Sentences on the circumstances of a session, for its report."""
        yield from ()

    def methods(self, sessions: Sequence[Any]) -> Iterator[str]:
        """Sentences for the methods section. `sessions`: figures of those that had any."""
        yield from ()
