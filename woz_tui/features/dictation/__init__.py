"""Dictation: the wizard's own voice becomes text in the field of `say`, to be looked at first."""

from woz_tui.feature import CommandLine, Feature


class Dictation(Feature):
    """Texts of `woz dictate`, and which sentences came of them."""

    name = "dictation"
    kinds = "kinds:KINDS"
    keys = "keys.json"
    sentences = "console:SENTENCES"
    notes = "notes:DictatedTexts"
    console = "console:CONSOLE"
    session = "in_session:DictationInSession"
    history = "history:DictationHistory"
    export = "export:EXPORT"
    command = CommandLine(
        name="dictate",
        summary="your own voice becomes text in the field of `say`",
        module="command",
        behind="talk",
    )
