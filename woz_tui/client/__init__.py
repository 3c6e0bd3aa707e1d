"""Plays a session from a program: `async with connect() as woz: await woz.say("Hello")`.

`woz_tui.client.blocking` has the same for programs without asyncio. docs/how-to/programs.md begins
with whole programs.
"""

from woz_tui.client.woz_client import MessageStream, WozClient, WozRun, connect
from woz_tui.client.woz_errors import (
    WozConnectionError,
    WozError,
    WozFailedError,
    WozRefusedError,
    WozStoppedError,
    WozSupersededError,
    WozUnknownVerbError,
)

__all__ = [
    "MessageStream",
    "WozClient",
    "WozConnectionError",
    "WozError",
    "WozFailedError",
    "WozRefusedError",
    "WozRun",
    "WozStoppedError",
    "WozSupersededError",
    "WozUnknownVerbError",
    "connect",
]
