"""Which action was a mistake: picked from the log."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row, fit
from woz_tui.console.screens.choice import ChoiceDialog, ListChoice
from woz_tui.console.screens.dialog import content
from woz_tui.console.state.event_sentences import EventLine
from woz_tui.console.widgets.bottom_rows import quotation
from woz_tui.protocol.requests import AskMistake
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.text_cleaning import elapsed

#: So many of the last actions are offered.
OFFERED = 40
#: How an action stands, where its mark is no word for it.
_STANDS = {
    "left_out": Sentence("mistake.left_out", "not possible here"),
    "sent": Sentence("mistake.sent", "sent, end not known"),
    "waits": Sentence("mistake.waits", "counts later"),
    "done": Sentence("mistake.done", "done"),
    "failed": Sentence("mistake.failed", "failed"),
    "refused": Sentence("mistake.refused", "refused"),
    "replaced": Sentence("mistake.replaced", "replaced"),
    "running": Sentence("mistake.running", "running"),
    "stopped": Sentence("mistake.stopped", "stopped"),
}


class MistakeDialog(ChoiceDialog):
    """The last actions, newest first; backspace on the main screen takes at once what was heard or
    seen last, without those that wait or were refused.
    """

    heading = Sentence("mistake.heading", "That was a mistake")
    hint = Sentence("mistake.hint", "arrows choose · enter marks it as a mistake · ctrl+q closes")

    def _events(self) -> list[EventLine]:
        runs = [event for event in self.state.events if event.run]
        return runs[::-1][:OFFERED]

    def lines(self) -> list[Row]:
        """Only if there is nothing to choose from."""
        if self._events():
            return []
        return [((say("mistake.nothing", "Nothing has been played yet."), "muted"),)]

    def choices(self) -> Sequence[ListChoice]:
        """When, what, and whether it is labelled already; choosing labels it."""
        found = []
        for event in self._events():
            what = f"{event.text} {quotation(event.utterance, self.glyphs)}"
            stands = word(_STANDS.get(event.mark, event.mark))
            if event.mistake:
                stands = say("mistake.marked", "mistake")
            row: Row = (
                (f"{elapsed(event.t):>7}  ", "muted"),
                (fit(what, 40, self.glyphs.ellipsis), "plain"),
                (f"  {stands}", "muted"),
            )
            labels = partial(self.requests.ask, AskMistake(run=event.run))
            found.append(ListChoice(content([row]), labels))
        return found
