"""Phases: parts of a session or of a trial, each with what is in front in it."""

from woz_tui.feature import Feature


class Phases(Feature):
    """One holds at a time: its panels are in front, Space plays its script."""

    name = "phases"
    kinds = "kinds:KINDS"
    section = "section:PHASES"
    keys = "keys.json"
    sentences = "console:SENTENCES"
    console = "console:CONSOLE"
    gate = "gate:GATE"
    session = "in_session:PhaseController"
    history = "history:PhaseHistory"
    view = "view:VIEW"
    export = "export:EXPORT"
    bookmarks = "bookmarks:BOOKMARKS"
