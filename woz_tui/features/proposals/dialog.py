"""Taking proposals by their keys, and changing a sentence before it is said."""

from __future__ import annotations

from collections.abc import Iterable

from textual.widget import Widget
from textual.widgets import Static

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import clean
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.screens.dialog import ConsoleApp, EntryDialog, plain
from woz_tui.features.proposals.console import EDIT, KEYS, is_whole, places_of
from woz_tui.features.proposals.kinds import AskDismiss, AskTake
from woz_tui.features.proposals.notes import ShownItem
from woz_tui.protocol.sentence import Sentence

NOTHING = Sentence("proposals.nothing_there", "Nothing is proposed there")


def take_first(app: ConsoleApp) -> None:
    """Take what stands at the first place."""
    _take(app, 0)


def take_second(app: ConsoleApp) -> None:
    """Take what stands at the second place."""
    _take(app, 1)


def take_third(app: ConsoleApp) -> None:
    """Take what stands at the third place."""
    _take(app, 2)


def _take(app: ConsoleApp, place: int) -> None:
    """What is asked for is what stands there now, by its set."""
    shown = _at(app, place)
    if shown is None:
        app.news(word(NOTHING))
        return
    width, height = app.size
    if not is_whole(app.state, PaintFrame(width, height, 0), place):
        # Nobody takes what she has not read.
        if shown.item.text:
            app.open_dialog(EditProposalDialog(shown))
        else:
            cut = say(
                "proposals.cut",
                "It is cut here: make the window wider to read it whole, then take it",
            )
            app.news(cut)
        return
    key = app.key_of(KEYS[place])
    app.requests.ask(AskTake(set=shown.offered.set, item=shown.item.id, key=key))


def dismiss_first(app: ConsoleApp) -> None:
    """Take nothing of the set at the first place."""
    shown = _at(app, 0)
    if shown is None:
        app.news(word(NOTHING))
    else:
        app.requests.ask(AskDismiss(set=shown.offered.set))


def open_edit(app: ConsoleApp) -> None:
    """Change the sentence at the first place."""
    shown = _at(app, 0)
    if shown is None:
        app.news(word(NOTHING))
    elif not shown.item.text:
        app.news(say("proposals.no_sentence", "It is no sentence: there is nothing to edit"))
    else:
        app.open_dialog(EditProposalDialog(shown))


def _at(app: ConsoleApp, place: int) -> ShownItem | None:
    places = places_of(app.state)
    return places[place] if place < len(places) else None


class EditProposalDialog(EntryDialog):
    """A proposed sentence, to be said otherwise. The box closes when the proposal has gone."""

    hint = Sentence(
        "proposals.edit_keys",
        "enter says it so · ctrl+q closes, and the proposal stays",
    )
    size_class = "wide"

    def __init__(self, shown: ShownItem) -> None:
        super().__init__()
        who = clean(shown.offered.who) or shown.offered.source
        self.heading = say("proposals.proposed_by", "Proposed by {who}", who=who)
        self._shown = shown

    def below(self) -> Iterable[Widget]:
        """The whole of it, which the field may be too short for."""
        yield Static(plain(clean(self._shown.item.text)))

    @property
    def draft(self) -> str:
        """Of this proposal."""
        return f"{type(self).__name__} {self._shown.offered.set} {self._shown.item.id}"

    def on_mount(self) -> None:
        """The sentence as it was proposed, unless it was changed before."""
        super().on_mount()
        if self.there and not self.entry.value:
            self.set_text(self._shown.item.text)

    def refreshed(self) -> None:
        """It was taken at another console, or has gone."""
        if self._shown not in places_of(self.state):
            self.leave()

    def submit(self, text: str) -> None:
        """Take it; where nothing was changed, as it is."""
        new = "" if text == self._shown.item.text else text
        key = self.console_app.key_of(EDIT)
        asked = AskTake(set=self._shown.offered.set, item=self._shown.item.id, text=new, key=key)
        self.requests.ask(asked)
