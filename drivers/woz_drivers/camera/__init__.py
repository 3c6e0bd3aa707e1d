"""A camera: where in its pictures the green thing is."""

from woz_drivers.camera.driver import Camera

__all__ = ["Camera"]
