"""Verbs of the session itself, offered to the bus as a driver called `session`.

So a marker or a change of condition inside an action is a command like any other: recorded,
ordered with the rest, refused while the stop is pressed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

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


class SessionVerbs(Protocol):
    """What the verbs do in a session. Everything raises `RequestError` if it makes no sense;
    `tells` as in `messages.RestrictedMessage`.
    """

    def mark(self, text: str, source: str, tells: tuple[str, ...] = ()) -> None:
        """Put a marker into the log."""

    def note(self, text: str, tells: tuple[str, ...] = ()) -> None:
        """Put a note into the log."""

    def set_codes(self, participant: str | None, condition: str | None, trial: int | None) -> None:
        """Set those that are not None."""

    def lock(self, panel: str, locked: bool) -> None:
        """Lock or unlock a panel."""


class SessionPerformer(Performer):
    """The session as a driver, which does everything at once."""

    def __init__(self, session: SessionVerbs) -> None:
        self._session = session

    async def perform(self, job: Job) -> Mapping[str, Json]:
        args: Mapping[str, Any] = job.args  # checked by the bus
        tells = job.tells if isinstance(job, LaneJob) else ()
        try:
            match job.verb:
                case "mark":
                    self._session.mark(str(args.get("text", "")), "action", tells)
                case "note":
                    self._session.note(str(args["text"]), tells)
                case "set":
                    # A step of an action, perhaps one of a feature's, which goes on behind it.
                    codes = (args.get(name) for name in ("participant", "condition", "trial"))
                    self._session.set_codes(*codes)
                case "lock" | "unlock":
                    self._session.lock(str(args["panel"]), job.verb == "lock")
        except ValueError as error:
            raise RejectedError(str(error)) from error
        return dict(job.args)

    async def stop(self, scope: Scope) -> None:
        """Nothing of the session moves."""
