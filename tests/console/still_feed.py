"""A feed that goes nowhere and keeps what it is asked."""

from __future__ import annotations

from woz_tui.console.link.message_feed import OnLost, OnMessages
from woz_tui.protocol.requests import Request
from woz_tui.protocol.welcome import STALE_S


class StillFeed:
    def __init__(self) -> None:
        self.line_ok = self.attached = True
        self.stale_after_s = STALE_S
        self.round_trip_us: int | None = None
        self.asked: list[Request] = []
        self.closed = False

    def start(self, on_messages: OnMessages, on_lost: OnLost) -> None:
        """Nothing ever comes."""

    def ask(self, request: Request) -> int:
        self.asked.append(request)
        return len(self.asked)

    def close(self) -> None:
        self.closed = True
