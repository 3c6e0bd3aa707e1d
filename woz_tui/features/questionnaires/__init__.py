"""Questionnaires: what a participant is asked behind trials, conditions and at the end."""

from woz_tui.feature import Feature


class Questionnaires(Feature):
    """The wizard reads one aloud, or the participant answers it at a terminal."""

    name = "questionnaires"
    section = "section:QUESTIONNAIRES"
    words = "questionnaire"
    gate = "gate:GATE"
    session = "in_session:QuestionnaireController"
