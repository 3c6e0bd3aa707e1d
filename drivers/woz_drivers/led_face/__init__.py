"""A face of lights on a serial port: a small computer with `firmware/led_face` and its matrix."""

from woz_drivers.led_face.driver import LedFace
from woz_drivers.led_face.settings import LedFaceSettings

__all__ = ["LedFace", "LedFaceSettings"]
