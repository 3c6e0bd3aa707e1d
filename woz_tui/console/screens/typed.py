"""Sentences that were typed, into a copy of the experiment file: what comes in, then the copy."""

from __future__ import annotations

from typing import ClassVar

from textual.binding import Binding, BindingType

from woz_tui.console.drawing.cells import Row
from woz_tui.console.screens.dialog import ReportDialog
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.protocol.panels import TYPED, TYPED_NAME
from woz_tui.protocol.requests import AskKeepTyped, Reply


def typed_sentences(state: ConsoleState) -> list[str]:
    """What was typed in this session, as its buttons are called."""
    return [
        action.label
        for panel in state.panels
        if panel.title == TYPED
        for action in panel.actions
        if action.name.startswith(TYPED_NAME)
    ]


class KeepTypedDialog(ReportDialog):
    """Asks what would be written first; enter writes the copy."""

    heading = "Typed sentences"
    hint = "enter writes the copy · ctrl+q closes, nothing is written"
    size_class = "wide"
    BINDINGS: ClassVar[list[BindingType]] = [Binding("enter", "write", priority=True)]

    def __init__(self) -> None:
        super().__init__()
        self._rows: list[Row] = [(("reading ...", "muted"),)]
        self._ready = False

    def on_mount(self) -> None:
        """Ask what would be written."""
        self.requests.ask(AskKeepTyped(dry_run=True), self._compared)

    def lines(self) -> list[Row]:
        """The sentences and the copy's name, or why there is no copy."""
        return self._rows

    def _compared(self, reply: Reply) -> None:
        if not self.is_attached:
            return
        data = reply.data if isinstance(reply.data, dict) else {}
        if not reply.ok:
            self._refused(reply)
        elif count := data.get("sentences"):
            self._ready = True
            what = "the sentence" if count == 1 else f"the {count} sentences"
            goes = "It goes" if count == 1 else "They go"
            first = f"Keep {what} you typed? {goes} into a copy; your file is not changed."
            self._rows = [((first, "plain"),), ((str(data.get("file")), "strong"),), ()]
            self._rows += [((f"  {each}", "good"),) for each in typed_sentences(self.state)]
        else:
            file = str(data.get("file") or "")
            there = f"All typed sentences are in {file}" if file else "No sentences were typed"
            self._rows = [((there, "plain"),)]
        self.renew()

    def _refused(self, reply: Reply) -> None:
        self._ready = False
        details = reply.data if isinstance(reply.data, list) else []
        self._rows = [((f"{self.glyphs.error} {reply.reason}", "bad"),)]
        self._rows += [((str(detail), "plain"),) for detail in (*details, reply.hint) if detail]
        self._rows += [(), (("Nothing is lost: the sentences are in the log", "strong"),)]
        self._rows += [((self.state.log, "plain"),)] if self.state.log else []

    def action_write(self) -> None:
        """Write the copy; with nothing to write, close."""
        if self._ready:
            self._ready = False
            self.requests.ask(AskKeepTyped(), self._written)
        else:
            self.leave()

    def _written(self, reply: Reply) -> None:
        if not self.is_attached:  # closed meanwhile; the events tell of a copy
            return
        if not reply.ok:
            self._refused(reply)
            self.renew()
            return
        data = reply.data if isinstance(reply.data, dict) else {}
        self.leave()
        self.console_app.news(f"Typed sentences are in {data.get('file')}", "good")
