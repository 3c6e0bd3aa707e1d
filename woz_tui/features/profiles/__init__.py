"""Profiles: less than everything for a wizard who shall not have everything before them."""

from woz_tui.feature import Feature, StartOption


class Profiles(Feature):
    """Actions, controls and verbs that a wizard may use, by a name that can be chosen."""

    name = "profiles"
    kinds = "kinds:KINDS"
    section = "section:PROFILES"
    keys = "keys.json"
    sentences = "console:SENTENCES"
    console = "console:CONSOLE"
    gate = "gate:GATE"
    session = "in_session:ProfileInUse"
    history = "history:ProfileHistory"
    view = "view:VIEW"
    export = "export:EXPORT"
    figures = "figures:FIGURES"
    start = StartOption(
        flag="--profile",
        what="profile",
        help="profile of the experiment: which actions the wizard can use",
        without="everything may be used",
    )
