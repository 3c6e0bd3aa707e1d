"""A coder's dialogs: while one is open, the replay stands still, so that a code has its moment."""

from __future__ import annotations

from textual.content import Content

from woz_tui.console.cells import clean
from woz_tui.console.screens.choice import SearchDialog
from woz_tui.console.screens.dialog import Dialog
from woz_tui.console.screens.note import NoteDialog
from woz_tui.protocol.requests import AskMarker, AskReplay


class _Still(Dialog):
    """Stands still while it is open, and goes on if it went."""

    _went = False

    def on_mount(self) -> None:
        """Stand still."""
        replay = self.picture.replay
        self._went = replay is not None and not replay.paused and not replay.ended
        self._toggle()

    def closing(self) -> None:
        """Go on."""
        super().closing()
        self._toggle()

    def _toggle(self) -> None:
        if self._went:
            self.requests.ask(AskReplay(what="pause"))


class CodeDialog(_Still, SearchDialog[str]):
    """Type a code, or choose one that was set before."""

    heading = "Code"
    hint = "enter sets it · arrows choose · ctrl+q closes"
    placeholder = "smiles, or a tier and its code: gaze: robot (gaze: ends it)"

    def matching(self, typed: str) -> list[str]:
        """Codes of before that begin so, the one set last first; what is typed is a code, too."""
        replay = self.picture.replay
        places = replay.places if replay is not None else ()
        before = dict.fromkeys(place.text for place in reversed(places) if place.sort == "code")
        found = [code for code in before if code.casefold().startswith(typed.strip().casefold())]
        return found if not typed.strip() or typed.strip() in found else [typed.strip(), *found]

    def line(self, item: str) -> Content:
        """The code."""
        return Content(clean(item))

    def chose(self, item: str | None, typed: str) -> None:
        """Set it."""
        text = item or typed.strip()
        if text:
            self.requests.ask(AskMarker(text=text))


class CodeNoteDialog(_Still, NoteDialog):
    """Type a sentence about this moment; it goes into the file of codes."""

    hint = "enter writes it beside the log · ctrl+q closes"
