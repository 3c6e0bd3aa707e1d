"""Examples of what is said and asked of scripts, for the golden files of the protocol."""

from woz_tui.features.scripts.kinds import AskScript, ScriptMoved

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
