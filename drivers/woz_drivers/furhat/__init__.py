"""A Furhat by its Realtime API, or a simulated one."""

from woz_drivers.furhat.driver import Furhat
from woz_drivers.furhat.settings import FurhatSettings

__all__ = ["Furhat", "FurhatSettings"]
