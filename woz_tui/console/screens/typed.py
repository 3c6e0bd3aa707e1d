"""Sentences that were typed, into a copy of the experiment file: what comes in, then the copy."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

from textual.binding import Binding, BindingType

from woz_tui.console.cells import Row
from woz_tui.console.console_state import ConsoleState
from woz_tui.console.screens.dialog import ReportDialog
from woz_tui.protocol.panels import TYPED
from woz_tui.protocol.requests import AskKeepTyped, Reply
from woz_tui.session.typed_actions import NAME

_LOOKS = {"+++": "muted", "---": "muted", "@@ ": "muted"}


def has_typed(state: ConsoleState) -> bool:
    """Whether sentences were typed in this session."""
    return any(
        action.name.startswith(NAME)
        for panel in state.panels
        if panel.title == TYPED
        for action in panel.actions
    )


class KeepTypedDialog(ReportDialog):
    """Asks for the differences first; enter writes the copy. `then` ends the session, which no
    answer that does not come may hold up.
    """

    heading = "Typed sentences"
    hint = "enter writes the copy · ctrl+q closes, nothing is written"
    ending_hint = "enter writes the copy and ends · n ends without · ctrl+q stays"
    size_class = "wide"
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("enter", "write", priority=True),
        Binding("n", "without", priority=True),
    ]

    def __init__(self, then: Callable[[], None] | None = None) -> None:
        super().__init__()
        self._then = then
        self._rows: list[Row] = [(("reading ...", "muted"),)]
        self._ready = False

    def on_mount(self) -> None:
        """Ask for the differences; say which keys end the session."""
        if self._then is not None:
            self.show_hint(self.ending_hint)
        self.requests.ask(AskKeepTyped(dry_run=True), self._compared)

    def lines(self) -> list[Row]:
        """Differences, or why there is no copy."""
        return self._rows

    def _compared(self, reply: Reply) -> None:
        if not self.is_attached:
            return
        data = reply.data if isinstance(reply.data, dict) else {}
        diff = data.get("diff")
        if not reply.ok:
            self._refused(reply)
        elif data.get("sentences") and isinstance(diff, list):
            self._ready = True
            count = data["sentences"]
            what = "the sentence" if count == 1 else f"the {count} sentences"
            goes = "It goes" if count == 1 else "They go"
            first = f"Keep {what} you typed? {goes} into a copy; your file is not changed."
            self._rows = [((first, "plain"),), ((str(data.get("file")), "strong"),), ()]
            self._rows += [((line, _LOOKS.get(line[:3], "good")),) for line in map(str, diff)]
        else:
            file = str(data.get("file") or "")
            there = f"All typed sentences are in {file}" if file else "No sentences were typed"
            if self._then is not None:
                self.action_without()
                return
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
        """Write the copy that is shown; with nothing to write, close, but end nothing."""
        if self._ready:
            self._ready = False
            self.requests.ask(AskKeepTyped(), self._written)
        elif self._then is None:
            self.leave()

    def action_without(self) -> None:
        """End the session without a copy."""
        if self._then is not None:
            self.leave()
            self._then()

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
        if self._then is not None:
            self._then()
