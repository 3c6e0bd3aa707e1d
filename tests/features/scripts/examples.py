"""Examples of what is said and asked of scripts, for the golden files of the protocol."""

from tests.session.rig import with_section
from woz_tui.config.experiment import Experiment
from woz_tui.features.scripts.kinds import AskScript, ScriptMoved
from woz_tui.features.scripts.section import SCRIPT

#: Where the script of the console's scene stands, since minute 11.
SCENE = (ScriptMoved(position=2, t=660_000_000),)
MOVED = (ScriptMoved(position=3),)
HALTED = (ScriptMoved(position=1, phase="opening", played=[0, 3], halted="failed"),)
REQUESTS = (
    AskScript(ref=9, key="space", age_us=800),
    AskScript(ref=20, key="space", stale=True),
    AskScript(ref=10, play=False, to=0),
    AskScript(ref=21, play=False, by=-1, key="<"),
    AskScript(ref=22, to=3, text="Good morning, {participant}!", key="ctrl+g"),
)


def used(made: Experiment) -> Experiment:
    """The same file with something to do for the feature."""
    return with_section(made, SCRIPT, ("Hello", "Welcome"))
