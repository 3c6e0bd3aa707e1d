"""People: what a study knows of its participants, for what the robot says to them."""

from woz_tui.feature import Feature


class People(Feature):
    """Fields of participants, from a table or the wizard. Their values are such as slots have."""

    name = "people"
    kinds = "kinds:KINDS"
    section = "section:PEOPLE"
    sentences = "console:SENTENCES"
    console = "console:CONSOLE"
    gate = "gate:GATE"
    session = "in_session:PeopleInSession"
    history = "history:PeopleHistory"
    view = "view:VIEW"
    export = "export:EXPORT"
