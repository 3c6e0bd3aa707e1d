"""What the viewer of a replay can do beside moving through it."""

from __future__ import annotations

from woz_tui.console.desk import Desk
from woz_tui.console.figures import elapsed
from woz_tui.core import requests as r


class ReplayDesk(Desk):
    """Dialogs of a replay, and what its replies say."""

    def replied(self, reply: r.Reply) -> None:
        """A step says which line it came to."""
        told = reply.data
        if reply.ok and isinstance(told, dict) and isinstance(told.get("t"), int):
            t = int(told["t"])
            fraction = t % 1_000_000 // 1000
            self._console.news(f"{elapsed(t)}.{fraction:03} {told.get('kind', '')}")
        super().replied(reply)

    def do_go(self) -> None:
        """Go to a time or a place."""
        from woz_tui.console.replay.go import GoDialog  # noqa: PLC0415

        self._open(GoDialog())

    def do_about(self) -> None:
        """What this log is."""
        from woz_tui.console.replay.reports import AboutDialog  # noqa: PLC0415

        self._open(AboutDialog())

    def do_help(self) -> None:
        """The keys."""
        from woz_tui.console.replay.reports import ReplayHelp  # noqa: PLC0415

        self._open(ReplayHelp())

    def do_leave(self) -> None:
        """Leave at once: nothing is lost by it."""
        self._console.exit("left")
