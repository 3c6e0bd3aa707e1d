"""Response delay: a quick wizard is no quicker robot."""

from woz_tui.feature import Feature


class Delay(Feature):
    """Holds answers that come too soon after a cue, as the section `shaping` says."""

    name = "delay"
    kinds = "kinds:KINDS"
    section = "section:SHAPING"
    sentences = "console:SENTENCES"
    session = "in_session:DelayInSession"
    history = "history:DelayHistory"
    export = "export:EXPORT"
    figures = "figures:FIGURES"
