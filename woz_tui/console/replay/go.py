"""Go somewhere in the log: to a time that is typed, or to a place that is chosen."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.content import Content
from textual.fuzzy import Matcher
from textual.widget import Widget
from textual.widgets import Input, OptionList
from textual.widgets.option_list import Option

from woz_tui.console.cells import clean, fit
from woz_tui.console.figures import elapsed
from woz_tui.console.replay.standing import Place
from woz_tui.console.replay.timeline import sign_of
from woz_tui.console.screens.dialog import Entry
from woz_tui.core.requests import AskReplay
from woz_tui.replay.places import time_of

TIME, SORT = 8, 14


class GoDialog(Entry):
    """Type `12:34`, or a few letters of a marker; arrows choose among all places."""

    heading = "Go to"
    hint = "enter goes there · arrows choose · ctrl+q closes"
    placeholder = "12:34, or a few letters of a marker, note, trial, stop ..."
    opened_by = "go"
    wide = True
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "choose(-1)", priority=True),
        Binding("down", "choose(1)", priority=True),
        Binding("pageup", "choose(-10)", priority=True),
        Binding("pagedown", "choose(10)", priority=True),
    ]

    def on_mount(self) -> None:
        """All places; the next one after now is chosen."""
        if not self.there:
            return
        self.entry.value = ""
        replay = self.picture.replay
        self._all = list(replay.places) if replay is not None else []
        self._shown: list[Place] = []
        self._search("")

    def closing(self) -> None:
        """Where to go is no draft."""

    def below(self) -> Iterable[Widget]:
        """The list of places."""
        found = OptionList(id="found")
        found.can_focus = False
        yield found

    def on_input_changed(self, event: Input.Changed) -> None:
        """Narrow the list."""
        event.stop()
        if self.there:
            self._search(event.value.strip())

    def _search(self, typed: str) -> None:
        t = time_of(typed)
        if t is not None:
            self._shown = [Place(t, "time", "this time"), *(p for p in self._all if p.t >= t)]
        elif typed:
            matcher = Matcher(typed)
            self._shown = [p for p in self._all if matcher.match(f"{p.sort} {p.text}")]
        else:
            self._shown = self._all
        found = self.query_one("#found", OptionList)
        found.clear_options()
        found.add_options([Option(self._line(place)) for place in self._shown])
        if self._shown:
            now = self.picture.now(self.console_app.clock.now_us())
            later = (n for n, place in enumerate(self._shown) if place.t > now)
            found.highlighted = 0 if typed else next(later, len(self._shown) - 1)

    def _line(self, place: Place) -> Content:
        sign, look = sign_of(place.sort, self.glyphs)
        colour = {"bad": "bold $woz-bad", "plain": ""}.get(look, f"$woz-{look}")
        return Content.assemble(
            fit(elapsed(place.t), TIME, right=True),
            "  ",
            (sign, colour),
            "  ",
            (fit(place.sort, SORT, self.glyphs.ellipsis), "$woz-muted"),
            clean(place.text),
        )

    def action_choose(self, by: int) -> None:
        """Move in the list; the text field keeps the keyboard."""
        found = self.query_one("#found", OptionList)
        if self._shown:
            wanted = (found.highlighted or 0) + by
            last = len(self._shown) - 1
            around = wanted % len(self._shown) if abs(by) == 1 else max(0, min(last, wanted))
            found.highlighted = around

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Go to what is chosen, or to what was typed."""
        event.stop()
        self._go(self.query_one("#found", OptionList).highlighted)

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """A click in this list is meant."""
        event.stop()
        self._go(event.option_index)

    def _go(self, index: int | None) -> None:
        to = self.entry.value
        if index is not None and index < len(self._shown):
            to = f"{self._shown[index].t / 1_000_000:.6f}"
        self.leave()
        if to.strip():
            self.desk.ask(AskReplay(what="go", to=to))
