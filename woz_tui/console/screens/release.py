"""Releasing the stop: at once where every driver has confirmed it, after a question elsewhere."""

from __future__ import annotations

from typing import ClassVar

from textual.binding import Binding, BindingType

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row
from woz_tui.console.screens.dialog import ConsoleApp, LiveReportDialog
from woz_tui.console.state.stop_confirmation import confirmed_words, missing_words
from woz_tui.protocol.requests import AskRelease
from woz_tui.protocol.sentence import Sentence


def open_release(app: ConsoleApp) -> None:
    """Release the stop, or ask first if somebody may still move."""
    stop = app.state.session.stop
    missing = stop is not None and stop.settled and bool(stop.missing)
    waits = app.stop_pending or (stop is not None and not stop.settled)
    if missing or (waits and not app.state.lost):  # nothing is released late, with the line
        if not isinstance(app.dialog, ReleaseDialog):
            app.open_dialog(ReleaseDialog())
    else:
        app.requests.ask(AskRelease(source="key"))


class ReleaseDialog(LiveReportDialog):
    """Names who has not confirmed the stop; enter releases it all the same.

    Asked for before the confirmation, the release comes with it. Once somebody was named, it is
    the wizard's: nothing is released without a key.
    """

    heading = Sentence("release.heading", "Release the stop?")
    hint = Sentence("release.hint", "enter releases · ctrl+q keeps the stop")
    indent = 2
    BINDINGS: ClassVar[list[BindingType]] = [Binding("enter", "release", priority=True)]
    _asked = _named = False

    def lines(self) -> list[Row]:
        """Who did not confirm, who did."""
        stop = self.state.session.stop
        if stop is None or not stop.settled:
            waits = say("release.waits", "The robot has not confirmed the stop yet.")
            later = say("release.later", "It is released as soon as all have confirmed.")
            return [((waits, "warn"),), ((later, "plain"),)]
        confirmed = confirmed_words(stop, self.state.short_names, parts=False)
        if not stop.missing:
            told = say("release.all", "All have confirmed now: {names}", names=confirmed)
            return [((told, "good"),)]
        rows: list[Row] = [
            ((f"{self.glyphs.error} {words}", "bad"),)
            for words in missing_words(
                stop.missing, stop.unreached, stop.parts_missing, self.state.short_names
            )
        ]
        look = say("release.look", "It may still move. Look at it before you release the stop.")
        told = say("release.confirmed", "confirmed: {names}", names=confirmed)
        return [*rows, ((look, "strong"),), (), ((told, "muted"),)]

    def refreshed(self) -> None:
        """Follow the confirmations; close when the stop is released."""
        stop = self.state.session.stop
        missing = () if stop is None else stop.missing
        self._named = self._named or bool(missing)
        if self.console_app.stop_pending:
            super().refreshed()
        elif stop is None:
            self.leave()
        elif stop.settled and not self._named:
            self.action_release()
        else:
            super().refreshed()

    def action_release(self) -> None:
        """Release it, once."""
        if not self._asked:
            self._asked = True
            # Whom the wizard has read of; before the confirmation that is every driver.
            stop = self.state.session.stop
            named = stop.missing if stop is not None and stop.settled else self.state.drivers
            self.requests.ask(AskRelease(source="key", missing=list(named)))
            self.leave()
