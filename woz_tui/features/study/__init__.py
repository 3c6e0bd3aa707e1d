"""Studies: which participant gets which conditions in which order, and their trials."""

from woz_tui.feature import CommandLine, Feature
from woz_tui.protocol.sentence import Sentence


class Study(Feature):
    """A design proposes an order of conditions for each participant; trials begin and end."""

    name = "study"
    kinds = "kinds:KINDS"
    section = "section:DESIGN"
    keys = "keys.json"
    notes = "console:TrialNotes"
    console = "console:CONSOLE"
    gate = "gate:GATE"
    session = "in_session:TrialController"
    command = CommandLine(
        "design",
        "show the order of conditions: used so far, and next",
        module="command",
        behind="convert",
        proposed=("", Sentence("study.design_command", "who gets which condition")),
    )
