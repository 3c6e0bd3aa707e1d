"""Keys: what people write, what terminals send, what plays what. The door to this subject.

`normal` gives the one form in which keys are compared; `reach` says what a terminal makes of one;
`key_map` gives every action a key that works; `BUILTIN` lists the console's own.
"""

from __future__ import annotations

from woz_tui.config.keys.chords import KeyNameError, normal
from woz_tui.config.keys.console_keys import BUILTIN, Builtin, builtin, builtins_with
from woz_tui.config.keys.keyboard_layouts import LAYOUTS
from woz_tui.config.keys.keymap import Assigned, KeyMap, key_map, load_keymap
from woz_tui.config.keys.terminals import (
    KITTY,
    LINUX,
    PLAIN,
    SCREEN,
    STOPS,
    TERMINALS,
    TMUX,
    Reach,
    Terminal,
    Verdict,
    detected,
    is_stop,
    reach,
    spoken,
)
from woz_tui.config.keys.textual_names import from_textual

__all__ = [
    "BUILTIN",
    "KITTY",
    "LAYOUTS",
    "LINUX",
    "PLAIN",
    "SCREEN",
    "STOPS",
    "TERMINALS",
    "TMUX",
    "Assigned",
    "Builtin",
    "KeyMap",
    "KeyNameError",
    "Reach",
    "Terminal",
    "Verdict",
    "builtin",
    "builtins_with",
    "detected",
    "from_textual",
    "is_stop",
    "key_map",
    "load_keymap",
    "normal",
    "reach",
    "spoken",
]
