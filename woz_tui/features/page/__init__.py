"""Pages in a browser: a class that watches, a participant who answers."""

from woz_tui.feature import CommandLine, Feature


class Page(Feature):
    """The command `woz page`, which serves them in a process of its own."""

    name = "page"
    command = CommandLine(
        "page",
        "show a running session in browsers: to a class that watches, to a participant who answers",
        module="command",
        behind="attach",
    )
