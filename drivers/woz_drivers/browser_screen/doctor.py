"""What `woz doctor` finds out about a browser as a screen: whether a browser could be let in."""

from __future__ import annotations

import socket

from woz_drivers.browser_screen.settings import BrowserScreenSettings
from woz_tui.drivers.contract import Finding, Probe


def examine(probe: Probe) -> Finding:
    """Listen for a moment where the settings say."""
    settings: BrowserScreenSettings = probe.settings
    try:
        family, *_, place = socket.getaddrinfo(
            settings.host, settings.port, type=socket.SOCK_STREAM
        )[0]
        with socket.socket(family, socket.SOCK_STREAM) as listener:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.bind(place)
    except OSError as error:
        what = f"{settings.listen}: {error.strerror or error}"
        return Finding("error", probe.name, what, "give it another address (`listen`)")
    if settings.plain:
        what = f"{settings.listen} is free; without encryption, its network can see what is shown"
        return Finding("warning", probe.name, what, "for a network of your own only")
    return Finding("ok", probe.name, f"{settings.listen} is free for a browser")
