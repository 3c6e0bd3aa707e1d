"""Sentences that were typed, into a copy of the experiment file: what comes in, then the copy."""

from __future__ import annotations

from typing import ClassVar

from textual.binding import Binding, BindingType

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row
from woz_tui.console.screens.dialog import ReportDialog
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.protocol.panels import TYPED, TYPED_NAME
from woz_tui.protocol.requests import AskKeepTyped, Reply
from woz_tui.protocol.sentence import Sentence


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

    heading: str = Sentence("typed.heading", "Typed sentences")
    hint = Sentence("typed.hint", "enter writes the copy · ctrl+q closes, nothing is written")
    size_class = "wide"
    BINDINGS: ClassVar[list[BindingType]] = [Binding("enter", "write", priority=True)]

    def __init__(self) -> None:
        super().__init__()
        self._rows: list[Row] = [((say("dialog.reading", "reading ..."), "muted"),)]
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
            first = say(
                "typed.keep",
                "Keep the {count} sentences you typed? They go into a copy; your file is not"
                " changed.",
                one="Keep the sentence you typed? It goes into a copy; your file is not changed.",
                count=count,
            )
            self._rows = [((first, "plain"),), ((str(data.get("file")), "strong"),), ()]
            self._rows += [((f"  {each}", "good"),) for each in typed_sentences(self.state)]
        else:
            file = str(data.get("file") or "")
            there = say("typed.none", "No sentences were typed")
            if file:
                there = say("typed.all_in", "All typed sentences are in {file}", file=file)
            self._rows = [((there, "plain"),)]
        self.renew()

    def _refused(self, reply: Reply) -> None:
        self._ready = False
        details = reply.data if isinstance(reply.data, list) else []
        self._rows = [((f"{self.glyphs.error} {reply.reason}", "bad"),)]
        self._rows += [((str(detail), "plain"),) for detail in (*details, reply.hint) if detail]
        kept = say("typed.in_log", "Nothing is lost: the sentences are in the log")
        self._rows += [(), ((kept, "strong"),)]
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
        written = say("typed.written", "Typed sentences are in {file}", file=data.get("file"))
        self.console_app.news(written, "good")
