"""Who asked for something, in words for the log and the screen."""

from __future__ import annotations

from woz_tui.protocol.messages import ConsoleAttached

WIZARD = "the wizard"
#: The role of a console at which a participant sits.
PARTICIPANT = "participant"
#: The role of a console at which somebody only watches.
WATCHER = "watcher"
#: By the source of a request; panels and pads of keys are the wizard's hands.
_BY_SOURCE = {
    "program": "a program",
    PARTICIPANT: "the participant",
    "replay": "the re-run",
    "phase": "the experiment",
    "engagement": "the experiment",
    "driver": "a driver",
    "body": "a driver",
}


def requester(source: str, attached: ConsoleAttached | None = None) -> str:
    """`the wizard`, `the program greeter`, `the re-run`.

    `source`: what the request says of itself. `attached`: the connection over which it came, which
    knows better, if there was one.
    """
    if attached is None:
        return _BY_SOURCE.get(source, WIZARD)
    if attached.role == "program":
        return f"the program {attached.name or attached.console}"
    if attached.role != "wizard":
        return f"the {attached.role}"
    return f"{WIZARD} ({attached.part})" if attached.part else WIZARD
