"""Verbs that the session carries out itself, as experiment files may use them."""

from __future__ import annotations

from collections.abc import Sequence

from woz_tui.core.driver import Argument, Verb
from woz_tui.core.fields import Range

#: The name under which calls of these verbs are addressed.
SESSION = "session"

#: A pause between steps, in seconds; it is no call.
WAIT = Verb(
    "wait",
    "wait before the next step",
    (Argument("seconds", "seconds", "how long", required=True, range=Range(0.0, 3600.0, "s")),),
)


def session_verbs(conditions: Sequence[str] = (), panels: Sequence[str] = ()) -> tuple[Verb, ...]:
    """The verbs with the choices that one experiment allows."""
    panel = Argument("panel", "text", "a panel's title", required=True, choices=tuple(panels))
    return (
        Verb("mark", "put a marker into the log", (Argument("text", "text", "what it marks"),)),
        Verb(
            "note",
            "write a note into the log",
            (Argument("text", "text", "the note", required=True),),
        ),
        Verb(
            "set",
            "change the condition or the trial",
            (
                Argument("condition", "text", "the condition", choices=tuple(conditions)),
                Argument("trial", "whole", "the trial's number", range=Range(0, 100_000)),
            ),
        ),
        Verb("lock", "lock a panel", (panel,)),
        Verb("unlock", "unlock a panel", (panel,)),
    )
