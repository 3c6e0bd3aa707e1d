"""SoftBank's Pepper over NAOqi."""

from woz_drivers.pepper.driver import Pepper
from woz_drivers.pepper.settings import PepperSettings

__all__ = ["Pepper", "PepperSettings"]
