"""Training of wizards: cues of a simulated visitor, answers, scores."""

from woz_tui.feature import CommandLine, Feature
from woz_tui.protocol.sentence import Sentence


class Training(Feature):
    """A simulated visitor gives cues, the wizard answers them, and nothing moves."""

    name = "training"
    kinds = "kinds:KINDS"
    section = "section:TRAINING"
    sentences = "console:SENTENCES"
    notes = "console:TrainingNotes"
    console = "console:CONSOLE"
    history = "history:TrainingHistory"
    redaction = "redaction:REDACTION"
    export = "export:EXPORT"
    figures = "figures:FIGURES"
    report = "report:REPORT"
    session = "in_session:TrainingSession"
    session_kind = "session_kind:TRAINING"
    command = CommandLine(
        "train",
        "train a wizard: a simulated visitor gives cues, answers are scored",
        module="command",
        behind="demo",
        proposed=("--wizard W1", Sentence("training.command", "learn the keys")),
    )
