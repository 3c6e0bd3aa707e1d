"""Carries the stop to a session, for a screen that asks for everything else in another way."""

from __future__ import annotations

from pathlib import Path

from woz_tui.console.link.host_connection import sent_aside
from woz_tui.console.link.message_feed import OnLost, OnMessages
from woz_tui.protocol.requests import AskStop, Request
from woz_tui.protocol.welcome import STALE_S


class StopLine:
    """A `MessageFeed` by which nothing comes, and nothing goes but the stop.

    Attributes:
        path: The session's socket; None: there is no session now.
    """

    def __init__(self) -> None:
        self.line_ok = self.attached = True
        self.stale_after_s = STALE_S
        self.round_trip_us: int | None = None
        self.path: Path | None = None

    def start(self, on_messages: OnMessages, on_lost: OnLost) -> None:
        """Nothing comes."""

    def ask(self, request: Request) -> int:
        """1 if it was a stop and is on its way, else 0."""
        path = self.path
        return int(isinstance(request, AskStop) and path is not None and sent_aside(path, request))

    def close(self) -> None:
        """Nothing stays open."""
