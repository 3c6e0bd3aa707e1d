"""A gamepad, Stream Deck, 6-D mouse or the like in the wizard's hands, read by `woz hands` wherever
it is plugged in.

`driver` runs in the robot process and is told what the hands do; `gamepad` and `stream_deck` are
read on the computer with the device; `device_models` names the controls for both.
"""

from woz_drivers.hands.driver import HandsPanel

__all__ = ["HandsPanel"]
