"""A dialog in which one of several lines is chosen."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from textual.content import Content
from textual.widget import Widget
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from woz_tui.console.cells import Row
from woz_tui.console.screens.dialog import Dialog, content


class Choice(Dialog):
    """Lines of explanation, then the choices; arrows and enter."""

    def lines(self) -> list[Row]:
        """What stands above the choices."""
        return []

    def choices(self) -> Sequence[Content]:
        """The choices, in their order."""
        raise NotImplementedError

    def chose(self, index: int) -> None:
        """The wizard chose; the dialog is closed already."""
        raise NotImplementedError

    def body(self) -> Iterable[Widget]:
        """Explanation and list."""
        lines = self.lines()
        if lines:
            yield Static(content([*lines, ()]))
        yield OptionList(*(Option(choice) for choice in self.choices()), id="choices")

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Close, then carry out."""
        event.stop()
        self.leave()
        self.chose(event.option_index)
