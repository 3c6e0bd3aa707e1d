"""Lab Streaming Layer: a session in the recording of a lab, and the lab's streams in its log."""

from woz_tui.feature import CommandLine, Feature


class Lsl(Feature):
    """The section `lsl`, and `woz lsl`, a program of its own that sends and takes the streams."""

    name = "lsl"
    kinds = "kinds:KINDS"
    section = "section:LSL"
    sentences = "console:SENTENCES"
    notes = "console:LslNotes"
    console = "console:CONSOLE"
    session = "in_session:LslInSession"
    history = "history:LslHistory"
    export = "export:EXPORT"
    recordings = "xdf:READERS"
    doctor = "doctor:CHECKS"
    command = CommandLine(
        "lsl",
        "send a session to a lab's recorder, and take other programs' streams"
        " (Lab Streaming Layer)",
        module="command",
        behind="mcp",
    )
