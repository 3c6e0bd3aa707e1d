"""Repairs: moves that save a dialogue."""

from woz_tui.feature import Feature


class Repairs(Feature):
    """The last sentence again or in other words, a filler, yes, no, an interruption ..."""

    name = "repairs"
    section = "section:REPAIRS"
    words = "repairs"
    keys = "keys.json"
    console = "console:CONSOLE"
    session = "in_session:RepairsInSession"
    view = "view:VIEW"
