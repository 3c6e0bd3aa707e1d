"""Reading the experiment file again: first what would change, then the change."""

from __future__ import annotations

from typing import ClassVar

from textual.binding import Binding, BindingType

from woz_tui.console.drawing.cells import Row
from woz_tui.console.screens.dialog import ReportDialog
from woz_tui.protocol.requests import AskReload, Reply


class ReloadDialog(ReportDialog):
    """Asks for the differences first; enter applies them. Errors change nothing."""

    heading = "Read the experiment file again"
    hint = "ctrl+q closes, nothing changes"
    size_class = "wide"
    BINDINGS: ClassVar[list[BindingType]] = [Binding("enter", "apply", priority=True)]

    def __init__(self) -> None:
        super().__init__()
        self._rows: list[Row] = [(("reading ...", "muted"),)]
        self._ready = False

    def on_mount(self) -> None:
        self.requests.ask(AskReload(dry_run=True), self._compared)

    def _compared(self, reply: Reply) -> None:
        details = [str(item) for item in reply.data] if isinstance(reply.data, list) else []
        if not reply.ok:
            self._rows = [((f"{self.glyphs.error} {reply.reason}", "bad"),)]
            self._rows += [((reply.hint, "run"),)] if reply.hint else []
            self._rows += [((detail, "plain"),) for detail in details]
        elif not details:
            self._rows = [(("The file says what the session already does.", "plain"),)]
        else:
            self._ready = True
            self._rows = [((f"{self.glyphs.info} {detail}", "plain"),) for detail in details]
        does = "enter applies this to the running session" if self._ready else "enter closes"
        self.show_hint(f"{does} · ctrl+q: nothing changes")
        self.renew()

    def lines(self) -> list[Row]:
        return self._rows

    def action_apply(self) -> None:
        """Apply if there is something to apply; in any case close."""
        if self._ready:
            self.requests.ask(AskReload(), self._applied)
        self.leave()

    def _applied(self, reply: Reply) -> None:
        if reply.ok:
            self.console_app.news("File reloaded", "good")
        else:
            self.console_app.news(f"Not applied: {reply.reason}", "bad")
