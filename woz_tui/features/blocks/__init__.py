"""Blocks of BML: behaviours that a robot does together in time, on keys and from planners."""

from woz_tui.feature import CommandLine, Feature, PerformerName


class Blocks(Feature):
    """The Behaviour Markup Language 1.0, and a performer that plays it."""

    name = "blocks"
    kinds = "kinds:KINDS"
    predictions = "prediction:PREDICTIONS"
    section = "section:BLOCKS"
    robot_keys = ("bml",)
    command_words = "console:WORDS"
    console = "console:CONSOLE"
    session = "in_session:BlockPerformer"
    history = "history:BlockHistory"
    figures = "figures:FIGURES"
    report = "report:REPORT"
    performer = PerformerName("bml", "who plays BML", composes=True)
    command = CommandLine(
        "bml",
        "play behaviour blocks (BML 1.0) in a running session, or print their timetable",
        module="command",
        behind="talk",
    )
