"""Choices: what a participant is offered on a page or the robot's tablet, and what comes of it."""

from woz_tui.feature import Feature, PerformerName


class Choices(Feature):
    """The section `choices`, the verb `choice` that offers one, and what was chosen."""

    name = "choices"
    kinds = "kinds:KINDS"
    section = "section:CHOICES"
    sentences = "console:SENTENCES"
    notes = "console:ChoiceNotes"
    gate = "gate:GATE"
    session = "in_session:ChoicesInSession"
    history = "history:ChoiceHistory"
    export = "export:EXPORT"
    performer = PerformerName("choices", "who offers choices")
