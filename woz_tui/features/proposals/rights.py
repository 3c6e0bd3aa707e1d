"""What a program may do by itself, and what it may only propose."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from woz_tui.protocol.action_messages import BY_PERSON

#: What stands for actions among the verbs.
ACTIONS = "actions"
#: What the file says of all that a program does.
PLAY, PROPOSE = "play", "propose"
#: Sources of what a wizard wants: hands, and the script.
HANDS = BY_PERSON | {"script"}
#: Moves nothing.
_RECORDS = frozenset({"mark", "note"})


@dataclass(frozen=True, slots=True)
class ProgramRights:
    """Of one program: it plays these verbs by itself, and proposes all others; `plays` None: all
    are played.
    """

    plays: Collection[str] | None = ()

    def asks(self, what: str) -> bool:
        """Whether this verb (or `ACTIONS`) waits for the wizard."""
        return self.plays is not None and what not in self.plays and what not in _RECORDS

    @property
    def proposes(self) -> bool:
        """Whether anything does."""
        return self.plays is not None


ONLY_PROPOSES = ProgramRights()
