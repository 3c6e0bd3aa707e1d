"""Leaving: end the session, leave it running, or stay."""

from __future__ import annotations

from collections.abc import Sequence

from textual.content import Content

from woz_tui.console.cells import Row
from woz_tui.console.screens.choice import Choice


class LeaveDialog(Choice):
    """Stay is the first choice, so that enter after a slip does no harm."""

    heading = "Leave"
    hint = "arrows choose · enter · ctrl+q stays"

    def lines(self) -> list[Row]:
        """Where the log is."""
        return [(("log: ", "muted"), (self.picture.log or "none", "plain"))]

    def choices(self) -> Sequence[Content]:
        """Stay, leave it running, end it."""
        return [
            Content("Stay"),
            Content("Leave the session running (woz attach brings you back)"),
            Content("End the session: the robot rests, the log is finished"),
        ]

    def chose(self, index: int) -> None:
        """Carry it out; what is to be asked at the end is offered first."""
        due = self.picture.study.open_at_end()
        if index == 1:
            self.console_app.exit("detached")
        elif index == 2 and due and self.picture.role == "wizard":
            self.desk.offer(due[0], self.desk.end_session)
        elif index == 2:
            self.desk.end_session()
