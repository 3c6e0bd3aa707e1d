"""Controls of the devices by name, and where they are on the console's picture.

A gamepad's buttons go by their place, as the kernel names them: south is A on an Xbox pad, the
cross on a PlayStation's, B on a Nintendo's. Source: Linux, "input/gamepad.rst". A 6-D mouse's axes
go as spacenavd has them: x to the right, y up, z away from the hand.
"""

from __future__ import annotations

from collections.abc import Mapping

from woz_drivers.panels.control_functions import BUTTON, KNOB, SLIDER, PanelControl
from woz_tui.protocol.action_messages import HAND_DEVICES

GAMEPAD, STREAM_DECK, SPACEMOUSE, WII_REMOTE, IMU = DEVICES = HAND_DEVICES
#: Keys that the largest Stream Deck has.
MOST_KEYS = 32
#: Dials that the largest Stream Deck has.
MOST_DIALS = 6
#: Buttons that the largest 6-D mouse has.
MOST_BUTTONS = 31

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

_SPACEMOUSE: dict[str, tuple[str, int, int]] = {
    **{f"push-{axis}": (KNOB, column, 1) for column, axis in enumerate("xyz", 1)},
    **{f"turn-{axis}": (KNOB, column, 2) for column, axis in enumerate("xyz", 1)},
    **{
        f"button-{number}": (BUTTON, (number - 1) % 8 + 1, (number - 1) // 8 + 3)
        for number in range(1, MOST_BUTTONS + 1)
    },
}

_WII_REMOTE: dict[str, tuple[str, int, int]] = {
    "up": (BUTTON, 2, 1),
    "left": (BUTTON, 1, 2),
    "right": (BUTTON, 3, 2),
    "down": (BUTTON, 2, 3),
    "a": (BUTTON, 2, 4),
    "b": (BUTTON, 3, 4),
    "minus": (BUTTON, 1, 5),
    "home": (BUTTON, 2, 5),
    "plus": (BUTTON, 3, 5),
    "one": (BUTTON, 1, 6),
    "two": (BUTTON, 2, 6),
    "tilt-x": (KNOB, 4, 1),
    "tilt-y": (KNOB, 5, 1),
}

_IMU: dict[str, tuple[str, int, int]] = {
    **{f"turn-{axis}": (KNOB, column, 1) for column, axis in enumerate("xyz", 1)},
    "clutch": (BUTTON, 1, 2),
}

#: What may be pressed or pulled, as a map says.
TRIGGERS = ("left-trigger", "right-trigger")

#: Device -> its controls by name.
MODELS: Mapping[str, Mapping[str, PanelControl]] = {
    **{
        device: {
            name: PanelControl(name, kind, column, row)
            for name, (kind, column, row) in controls.items()
        }
        for device, controls in (
            (GAMEPAD, _GAMEPAD),
            (SPACEMOUSE, _SPACEMOUSE),
            (WII_REMOTE, _WII_REMOTE),
            (IMU, _IMU),
        )
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
#: Axes that rest in their middle; everything else rests at 0.
STICKS = frozenset(
    name for model in MODELS.values() for name, each in model.items() if each.kind == KNOB
)
