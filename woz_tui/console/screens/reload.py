"""Reading the experiment file again: first what would change, then the change."""

from __future__ import annotations

from typing import ClassVar

from textual.binding import Binding, BindingType

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row
from woz_tui.console.screens.dialog import ReportDialog
from woz_tui.protocol.requests import AskReload, Reply
from woz_tui.protocol.sentence import Sentence


class ReloadDialog(ReportDialog):
    """Asks for the differences first; enter applies them. Errors change nothing."""

    heading = Sentence("reload.heading", "Read the experiment file again")
    hint = Sentence("reload.hint", "ctrl+q closes, nothing changes")
    size_class = "wide"
    BINDINGS: ClassVar[list[BindingType]] = [Binding("enter", "apply", priority=True)]

    def __init__(self) -> None:
        super().__init__()
        self._rows: list[Row] = [((say("dialog.reading", "reading ..."), "muted"),)]
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
            same = say("reload.same", "The file says what the session already does.")
            self._rows = [((same, "plain"),)]
        else:
            self._ready = True
            self._rows = [((f"{self.glyphs.info} {detail}", "plain"),) for detail in details]
        hint = say("reload.closes", "enter closes · ctrl+q: nothing changes")
        if self._ready:
            hint = say(
                "reload.applies",
                "enter applies this to the running session · ctrl+q: no change",
            )
        self.show_hint(hint)
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
            self.console_app.news(say("reload.done", "File reloaded"), "good")
        else:
            failed = say("reload.failed", "Not applied: {why}", why=reply.reason)
            self.console_app.news(failed, "bad")
