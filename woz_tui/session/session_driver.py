"""Verbs of the session itself, offered to the bus as a driver called `session`.

So a marker or a change of condition inside an action is a command like any other: recorded,
ordered with the rest, refused while the stop is pressed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from woz_tui.bus.lane import LaneJob
from woz_tui.config.performers import ENGAGEMENT, SESSION
from woz_tui.config.session_verbs import own_verb
from woz_tui.drivers.contract import Argument, Job, Performer, RejectedError, Scope, Verb
from woz_tui.protocol.messages import Json

#: The names under which the bus knows the session and its engagement model.
__all__ = ["ENGAGEMENT", "SESSION", "VERBS", "SessionPerformer"]

VERBS: tuple[Verb, ...] = (
    own_verb(
        "mark", "put a marker into the log", (Argument("text", "text", "text of the marker"),)
    ),
    own_verb("note", "put a note into the log", (Argument("text", "text", required=True),)),
    own_verb(
        "set",
        "set participant, condition or trial",
        (
            Argument("condition", "text", "one of the experiment's conditions"),
            Argument("participant", "text", "a participant code"),
            Argument("trial", "whole", "number of the trial"),
        ),
    ),
    own_verb("lock", "lock a panel", (Argument("panel", "text", "its title", required=True),)),
    own_verb("unlock", "unlock a panel", (Argument("panel", "text", "its title", required=True),)),
)

#: Carries one verb out, whose arguments tell something (see `messages.RestrictedMessage`); raises
#: `ValueError` with a sentence if it makes no sense.
Carry = Callable[[Mapping[str, Json], tuple[str, ...]], None]


class SessionPerformer(Performer):
    """The session as a driver; `carry` maps each verb's name to what does it."""

    def __init__(self, carry: Mapping[str, Carry]) -> None:
        self._carry = carry

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Do it at once."""
        try:
            self._carry[job.verb](job.args, job.tells if isinstance(job, LaneJob) else ())
        except ValueError as error:
            raise RejectedError(str(error)) from error
        return dict(job.args)

    async def stop(self, scope: Scope) -> None:
        """Nothing of the session moves."""
