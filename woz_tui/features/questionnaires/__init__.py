"""Questionnaires: what a participant is asked behind trials, conditions and at the end."""

from woz_tui.feature import Feature, ParticipantScreen


class Questionnaires(Feature):
    """The wizard reads one aloud, or the participant answers it at a terminal."""

    name = "questionnaires"
    kinds = "kinds:KINDS"
    section = "section:QUESTIONNAIRES"
    words = "questionnaire"
    gate = "gate:GATE"
    session = "in_session:QuestionnaireController"
    history = "history:QuestionnaireHistory"
    sentences = "console:SENTENCES"
    notes = "console:QuestionnaireNotes"
    console = "console:CONSOLE"
    export = "export:EXPORT"
    bookmarks = "bookmarks:BOOKMARKS"
    figures = "figures:FIGURES"
    gathered = "scales:GatheredScales"
    report = "report:REPORT"
    new_files = "new_files:INSTRUMENTS"
    screen = ParticipantScreen(
        "--questionnaire",
        "show only the questionnaires (or this one), for the participant's terminal",
        app="terminal:ParticipantApp",
    )
