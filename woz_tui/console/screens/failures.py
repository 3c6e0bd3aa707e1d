"""What has failed and has not been seen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from textual.binding import Binding, BindingType

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row
from woz_tui.console.screens.dialog import ConsoleApp, ReportDialog
from woz_tui.console.screens.lost import open_lost
from woz_tui.console.state.remedy_text import remedy_text
from woz_tui.console.state.running_actions import Failure
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.text_cleaning import elapsed


def open_failures(app: ConsoleApp) -> None:
    """Show failures; on a lost connection, what can be done."""
    if app.state.lost:
        open_lost(app)
    elif app.state.runs.unseen():
        app.open_dialog(FailuresDialog())
    else:
        app.news(say("failures.none", "No new failures"))


class FailuresDialog(ReportDialog):
    """Each failure with its reason and remedy; enter marks those that stand here as seen."""

    heading = Sentence("failures.heading", "Failed")
    hint = Sentence("failures.hint", "enter: seen, clear them · ctrl+q keeps them")
    size_class = "wide"
    indent = 9
    BINDINGS: ClassVar[list[BindingType]] = [Binding("enter", "see", priority=True)]
    _listed: Sequence[Failure] = ()

    def lines(self) -> list[Row]:
        """Newest first."""
        rows: list[Row] = []
        self._listed = self.state.runs.unseen()
        for failure in reversed(self._listed):
            name = self.state.label(failure.action) if failure.action else failure.what
            front = (" " * self.indent, "plain")
            why = failure.reason or say("failures.no_reason", "no reason given")
            rows += [
                ((f"{elapsed(failure.t):>7}  ", "muted"), (f"{self.glyphs.failed} {name}", "bad")),
                (front, (why, "plain")),
            ]
            if failure.remedy:
                rows.append((front, (remedy_text(failure.remedy, self.state), "run")))
        return rows

    def action_see(self) -> None:
        """What could be read is seen; what has come since is still to be read."""
        self.state.runs.seen.update(failure.run for failure in self._listed)
        self.leave()
        self.console_app.paint()
