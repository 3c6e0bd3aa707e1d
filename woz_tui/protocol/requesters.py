"""Who asked for something, or ended it, in words for the log and the screen."""

from __future__ import annotations

from woz_tui.protocol.messages import ConsoleAttached
from woz_tui.protocol.sentence import Sentence

#: What the codes of wizards begin with.
OF_WIZARD = "requester.wizard"
WIZARD = Sentence("requester.wizard", "the wizard")
#: The role of a console at which a participant sits.
PARTICIPANT = "participant"
#: The role of a console at which somebody only watches.
WATCHER = "watcher"
#: By the source of a request; panels and pads of keys are the wizard's hands.
_BY_SOURCE = {
    "program": Sentence("requester.a_program", "a program"),
    PARTICIPANT: Sentence("requester.participant", "the participant"),
    "replay": Sentence("requester.rerun", "the re-run"),
    "phase": Sentence("requester.experiment", "the experiment"),
    "engagement": Sentence("requester.experiment", "the experiment"),
    "driver": Sentence("requester.driver", "a driver"),
    "body": Sentence("requester.driver", "a driver"),
}
#: By the role of a console, where it is no wizard's.
_BY_ROLE = {
    PARTICIPANT: Sentence("requester.participant", "the participant"),
    WATCHER: Sentence("requester.watcher", "the watcher"),
}

#: What presses a stop, where it is no person with a name.
STOP_SOURCES = {
    "key": Sentence("stop.by_key", "key"),
    "voice": Sentence("stop.by_voice", "voice"),
    "program": Sentence("stop.by_program", "program"),
    "console-lost": Sentence("stop.by_lost_console", "console-lost"),
}
#: Why trials and breaks ended that nobody ended.
SESSION_ENDED = Sentence("events.session_ended", "the session ended")
#: Why a session ended, where nobody has written why.
END_REASONS = {
    "wizard": Sentence("events.end_wizard", "wizard"),
    "program": Sentence("events.end_program", "program"),
    "abandoned": Sentence("events.end_abandoned", "abandoned"),
    "terminated": Sentence("events.end_terminated", "terminated"),
    "crashed": Sentence("events.end_crashed", "crashed"),
    "the re-run is over": Sentence("host.rerun_over", "the re-run is over"),
}


def requester(source: str, attached: ConsoleAttached | None = None) -> str:
    """`the wizard`, `the program greeter`, `the re-run`.

    `source`: what the request says of itself. `attached`: the connection over which it came, which
    knows better, if there was one.
    """
    if attached is None:
        return _BY_SOURCE.get(source, WIZARD)
    if attached.role == "program":
        name = attached.name or attached.console
        return Sentence("requester.program", "the program {name}", name=name)
    if attached.role != "wizard":
        return _BY_ROLE.get(attached.role, f"the {attached.role}")
    if attached.part:
        return Sentence("requester.wizard_of_part", "the wizard ({part})", part=attached.part)
    return WIZARD
