"""A browser's window as a screen: pictures and words, with the moment at which it painted them."""

from woz_drivers.browser_screen.driver import BrowserScreen
from woz_drivers.browser_screen.settings import BrowserScreenSettings

__all__ = ["BrowserScreen", "BrowserScreenSettings"]
