"""Dialogs in which one of several lines is chosen."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import ClassVar, Generic, NamedTuple, TypeVar

from textual.binding import Binding, BindingType
from textual.content import Content
from textual.widget import Widget
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row
from woz_tui.console.screens.dialog import Dialog, EntryDialog, content, plain
from woz_tui.protocol.sentence import Sentence

T = TypeVar("T")


class ListChoice(NamedTuple):
    """One line of a list, and what it does; None: it only closes the dialog. `stays`: the dialog
    stays open.
    """

    text: Content
    do: Callable[[], object] | None = None
    stays: bool = False


class ChoiceDialog(Dialog):
    """Lines of explanation, then the choices; arrows and enter."""

    #: Which one is chosen at first.
    first: int | None = None

    def lines(self) -> list[Row]:
        """What stands above the choices."""
        return []

    def choices(self) -> Sequence[ListChoice]:
        """The choices, in their order; what they do happens once the dialog is closed."""
        raise NotImplementedError

    def body(self) -> Iterable[Widget]:
        if lines := self.lines():
            yield Static(content([*lines, ()]))
        self._offers = self.choices()
        yield OptionList(*(offer.text for offer in self._offers), id="choices")

    def on_mount(self) -> None:
        """Begin at the first choice; a stop may have come before there is a list."""
        for choices in self.query("#choices").results(OptionList):
            if self.first is not None:
                choices.highlighted = self.first

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Close, unless the choice stays, then carry out, once."""
        event.stop()
        if not self.is_on_top:
            return
        chosen = self._offers[event.option_index]
        if not chosen.stays:
            self.leave()
        if chosen.do is not None:
            chosen.do()


class ConfirmDialog(ChoiceDialog):
    """Asks before something is done; enter alone does not do it.

    Args:
        question: What is asked, as a sentence.
        name: What it is called in the list.
        do: Does it.
    """

    heading = Sentence("dialog.sure", "Are you sure?")
    hint = Sentence("dialog.choose_no", "arrows choose · enter · ctrl+q: no")

    def __init__(self, question: str, name: str, do: Callable[[], object]) -> None:
        super().__init__()
        self._question, self._label, self._do = question, name, do

    def lines(self) -> list[Row]:
        return [((self._question, "strong"),)]

    def choices(self) -> Sequence[ListChoice]:
        """No comes first."""
        yes = say("dialog.say_yes", "Yes: {what}", what=self._label)
        return [ListChoice(plain(say("dialog.say_no", "No"))), ListChoice(plain(yes), self._do)]


class SearchDialog(EntryDialog, Generic[T]):
    """A text field that narrows a list: arrows choose, enter takes. It keeps no draft.

    The list is what the letters say whenever enter comes: Textual's own palette searches beside
    the keys, so that a quick enter would take a line of the search before.
    """

    size_class = "wide"
    #: What stands there where nothing matches, and enter does nothing; empty: it takes the text.
    nothing: ClassVar[str] = ""
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "choose(-1)", priority=True),
        Binding("down", "choose(1)", priority=True),
    ]

    def matching(self, typed: str) -> list[T]:
        """What matches, the best first; everything, if nothing is typed."""
        raise NotImplementedError

    def line(self, item: T) -> Content:
        raise NotImplementedError

    def chose(self, item: T | None, typed: str) -> None:
        """The wizard chose, or nothing matches what is typed; the dialog is closed already."""
        raise NotImplementedError

    def first(self, typed: str) -> int:
        """Which one is chosen at first."""
        return 0

    def on_mount(self) -> None:
        if self.there:
            self.changed("")

    def closing(self) -> None:
        """A search is no draft."""

    def below(self) -> Iterable[Widget]:
        """The list of what matches."""
        found = OptionList(id="found")
        found.can_focus = False
        yield found

    @property
    def _list(self) -> OptionList:
        return self.query_one("#found", OptionList)

    def changed(self, typed: str) -> None:
        """Narrow the list."""
        typed = typed.strip()
        self.shown = self.matching(typed)
        self._list.clear_options()
        self._list.add_options([self.line(item) for item in self.shown])
        if self.shown:
            self._list.highlighted = self.first(typed)
        elif self.nothing:
            self._list.add_option(Option(plain(word(self.nothing)), disabled=True))

    def action_choose(self, by: int) -> None:
        """Move in the list; the text field keeps the keyboard. Pages end at its ends."""
        count = len(self.shown)
        if count:
            wanted = (self._list.highlighted or 0) + by
            around = wanted % count if abs(by) == 1 else max(0, min(count - 1, wanted))
            self._list.highlighted = around

    def accept(self, typed: str) -> None:
        if self.shown or not self.nothing:
            self._choose(self._list.highlighted)

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """A click in this list is meant."""
        event.stop()
        if self.is_on_top:
            self._choose(event.option_index)

    def _choose(self, index: int | None) -> None:
        chosen = self.shown[index] if index is not None and index < len(self.shown) else None
        typed = self.entry.value.strip()
        self.leave()
        self.chose(chosen, typed)
