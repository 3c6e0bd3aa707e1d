"""Scripts: actions in their order, of which Space plays the next one."""

from woz_tui.feature import Feature


class Scripts(Feature):
    """The file's own, or that of the phase that holds. Stands after phases, which may have one."""

    name = "scripts"
    kinds = "kinds:KINDS"
    section = "section:SCRIPT"
    keys = "keys.json"
    console = "console:CONSOLE"
    gate = "gate:GATE"
    session = "in_session:ScriptController"
    history = "history:ScriptHistory"
    view = "view:VIEW"
