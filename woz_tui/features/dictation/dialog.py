"""The field of `say`, into which dictated texts come."""

from __future__ import annotations

from woz_tui.console.screens.say import SayDialog
from woz_tui.features.dictation.notes import DictatedTexts
from woz_tui.protocol.sentence import Sentence


class DictatedSayDialog(SayDialog):
    """What was dictated stands there as if it were typed; enter says it."""

    heading = Sentence("dictation.heading", "Say (dictated)")

    @property
    def draft(self) -> str:
        """The same as of the field without dictation."""
        return SayDialog.__name__

    def on_mount(self) -> None:
        """With what came before it was opened."""
        super().on_mount()
        self._take()

    def refreshed(self) -> None:
        """With what has come since."""
        super().refreshed()
        self._take()

    def _take(self) -> None:
        """Each once, also where the line to the robot was lost meanwhile."""
        notes, drafts = self.state.study.notes.of(DictatedTexts), self.requests.drafts
        place = f"dictated {self.state.log}"
        texts = notes.after(int(drafts.get(place, "0"))) if notes is not None else {}
        if texts and self.there:
            drafts[place] = str(max(texts))
            new = " ".join(texts.values()).replace("{", "{{").replace("}", "}}")
            self.set_text(f"{self.entry.value.rstrip()} {new}".lstrip())
