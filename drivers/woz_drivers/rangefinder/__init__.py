"""Distance sensors on a serial port: MaxBotix, TFmini and TF-Luna, A02 and JSN-SR04T, Arduino."""

from woz_drivers.rangefinder.driver import Rangefinder
from woz_drivers.rangefinder.settings import RangefinderSettings

__all__ = ["Rangefinder", "RangefinderSettings"]
