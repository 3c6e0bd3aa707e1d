"""Aldebaran's NAO over NAOqi."""

from woz_drivers.nao.driver import Nao
from woz_drivers.nao.settings import NaoSettings

__all__ = ["Nao", "NaoSettings"]
