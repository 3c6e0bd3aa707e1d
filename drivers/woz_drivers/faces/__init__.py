"""Faces from any camera: how many, how far, where they look."""

from woz_drivers.faces.driver import Faces

__all__ = ["Faces"]
