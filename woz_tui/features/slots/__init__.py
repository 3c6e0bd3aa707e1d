"""Slots: words of a sentence that are known only when it is said."""

from woz_tui.feature import Feature


class Slots(Feature):
    """Filled in by wizards and programs. Stands after the scripts, of whose next line it asks."""

    name = "slots"
    kinds = "kinds:KINDS"
    section = "section:SLOTS"
    sentences = "console:SENTENCES"
    notes = "notes:HeardWords"
    console = "console:CONSOLE"
    gate = "gate:GATE"
    session = "in_session:SlotsInSession"
    history = "history:SlotHistory"
    view = "view:VIEW"
    export = "export:EXPORT"
    figures = "figures:FIGURES"
    report = "report:REPORT"
