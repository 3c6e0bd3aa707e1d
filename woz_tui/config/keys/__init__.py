"""Keys: how files name them, what terminals send for them, and which key plays which action.

`normal_key` gives the one form in which keys are compared; `deliver` says what a terminal makes of
one; `key_map` gives every action a key that works; `BUILTIN_KEYS` lists the console's own.
"""

from __future__ import annotations

from woz_tui.config.keys.chords import KeyNameError, normal_key
from woz_tui.config.keys.console_keys import (
    BUILTIN_KEYS,
    BuiltinKey,
    builtin_key,
    builtin_keys_with,
)
from woz_tui.config.keys.keyboard_layouts import LAYOUTS
from woz_tui.config.keys.keymap import AssignedKey, KeyMap, key_map
from woz_tui.config.keys.terminals import (
    KITTY,
    LINUX,
    PLAIN,
    SCREEN,
    STOPS,
    TERMINALS,
    TMUX,
    KeyDelivery,
    KeyOutcome,
    Terminal,
    deliver,
    describe_bytes,
    detect_terminal,
    is_stop,
)
from woz_tui.config.keys.textual_names import from_textual

__all__ = [
    "BUILTIN_KEYS",
    "KITTY",
    "LAYOUTS",
    "LINUX",
    "PLAIN",
    "SCREEN",
    "STOPS",
    "TERMINALS",
    "TMUX",
    "AssignedKey",
    "BuiltinKey",
    "KeyDelivery",
    "KeyMap",
    "KeyNameError",
    "KeyOutcome",
    "Terminal",
    "builtin_key",
    "builtin_keys_with",
    "deliver",
    "describe_bytes",
    "detect_terminal",
    "from_textual",
    "is_stop",
    "key_map",
    "normal_key",
]
