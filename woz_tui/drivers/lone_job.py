"""A command outside of a session: what is tried or heard on this machine by itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from woz_tui.protocol.action_messages import Evidence

#: The driver of this machine's loudspeaker, and the verb with which it speaks.
LOUDSPEAKER, SAY = "speech", "say"


@dataclass(slots=True)
class LoneJob:
    """A command outside of a session."""

    args: Mapping[str, Any]
    command: str = "try"
    verb: str = SAY
    source: str = "program"

    def expects(self, seconds: float) -> None:
        """Nobody counts down."""

    def goes_on(self) -> Callable[[str], None]:
        """Nothing moves."""
        return lambda why: None

    def mark(self, sort: str, text: str = "") -> None:
        """Nobody follows its words."""

    def evidence(self, kind: Evidence) -> None:
        """Whoever sits before it hears it."""
