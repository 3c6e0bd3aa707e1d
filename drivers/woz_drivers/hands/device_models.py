"""Controls of gamepads and Stream Decks by name, and where they are on the console's picture.

A gamepad's buttons go by their place, as the kernel names them: south is A on an Xbox pad, the
cross on a PlayStation's, B on a Nintendo's. Source: Linux, "input/gamepad.rst".
"""

from __future__ import annotations

from collections.abc import Mapping

from woz_drivers.panels.control_functions import BUTTON, KNOB, SLIDER, PanelControl

GAMEPAD, STREAM_DECK = DEVICES = ("gamepad", "stream-deck")
#: Keys that the largest Stream Deck has.
MOST_KEYS = 32
#: Dials that the largest Stream Deck has.
MOST_DIALS = 6

_GAMEPAD: dict[str, tuple[str, int, int]] = {
    "left-trigger": (SLIDER, 1, 1),
    "right-trigger": (SLIDER, 8, 1),
    "left-bumper": (BUTTON, 1, 2),
    "right-bumper": (BUTTON, 8, 2),
    "up": (BUTTON, 3, 3),
    "north": (BUTTON, 7, 3),
    "left": (BUTTON, 2, 4),
    "right": (BUTTON, 4, 4),
    "select": (BUTTON, 5, 4),
    "start": (BUTTON, 6, 4),
    "west": (BUTTON, 7, 4),
    "east": (BUTTON, 8, 4),
    "down": (BUTTON, 3, 5),
    "home": (BUTTON, 5, 5),
    "south": (BUTTON, 7, 5),
    "left-stick-x": (KNOB, 2, 6),
    "left-stick-y": (KNOB, 3, 6),
    "left-stick": (BUTTON, 4, 6),
    "right-stick-x": (KNOB, 6, 6),
    "right-stick-y": (KNOB, 7, 6),
    "right-stick": (BUTTON, 8, 6),
}

#: Axes that rest in their middle; everything else rests at 0.
STICKS = tuple(name for name, (kind, _, _) in _GAMEPAD.items() if kind == KNOB)
#: What may be pressed or pulled, as a map says.
TRIGGERS = ("left-trigger", "right-trigger")

#: Device -> its controls by name.
MODELS: Mapping[str, Mapping[str, PanelControl]] = {
    GAMEPAD: {
        name: PanelControl(name, kind, column, row)
        for name, (kind, column, row) in _GAMEPAD.items()
    },
    STREAM_DECK: {
        **{
            f"key-{number}": PanelControl(
                f"key-{number}", BUTTON, (number - 1) % 8 + 1, (number - 1) // 8 + 1, lamp=True
            )
            for number in range(1, MOST_KEYS + 1)
        },
        **{
            f"dial-{number}": PanelControl(f"dial-{number}", BUTTON, number, 5)
            for number in range(1, MOST_DIALS + 1)
        },
    },
}
