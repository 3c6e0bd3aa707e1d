"""Pages in a browser: a class that watches, a participant who answers."""

from woz_tui.feature import CommandLine, Feature


class Page(Feature):
    """The section `page`, and `woz page`, which serves them in a process of its own."""

    name = "page"
    kinds = "kinds:KINDS"
    section = "section:PAGE"
    sentences = "console:SENTENCES"
    notes = "console:PageNotes"
    session = "in_session:PageInSession"
    history = "history:PageHistory"
    export = "export:EXPORT"
    doctor = "doctor:CHECKS"
    command = CommandLine(
        "page",
        "show a running session in browsers: to a class that watches, to a participant who answers",
        module="command",
        behind="attach",
    )
