"""A serial LED lamp as a driver for woz-tui."""

from woz_driver_lamp.lamp import Lamp, LampSettings

__all__ = ["Lamp", "LampSettings"]
