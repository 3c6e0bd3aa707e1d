"""Reachy Mini: `driver` takes verbs, `daemon_link` speaks with the vendor's daemon."""

from woz_drivers.reachy_mini.driver import ReachyMini
from woz_drivers.reachy_mini.settings import ReachyMiniSettings

__all__ = ["ReachyMini", "ReachyMiniSettings"]
