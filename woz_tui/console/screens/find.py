"""Find any action, panel or console command by typing a few of its letters."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import ClassVar

from rich.cells import cell_len
from textual.binding import Binding, BindingType
from textual.content import Content
from textual.fuzzy import Matcher
from textual.widget import Widget
from textual.widgets import Input, OptionList
from textual.widgets.option_list import Option

from woz_tui.console.caps import Cap, caption, key_name
from woz_tui.console.cells import clean, fit
from woz_tui.console.engagement.hand import ORDERS, is_offered
from woz_tui.console.robot.orders import orders_of
from woz_tui.console.screens.dialog import Entry
from woz_tui.console.screens.orders import steer
from woz_tui.core.requests import AskLock, AskVerb

#: Cells for a key and for a name.
KEY, LABEL = 7, 38


@dataclass(frozen=True, slots=True)
class Find:
    """Something that can be found: what it is called, where it belongs, what it does."""

    name: str
    key: str
    where: str
    do: Callable[[], None]
    search: str


def _score(matcher: Matcher, typed: str, find: Find) -> float:
    """Letters of the name in their order count; of utterances and help only whole pieces do."""
    score = matcher.match(find.name)
    if typed.casefold() in find.name.casefold():
        return score + 2
    return score or float(typed.casefold() in find.search.casefold()) / 100


class FindDialog(Entry):
    """Type, choose with the arrows, enter plays."""

    heading = "Find"
    hint = "enter plays it · arrows choose · ctrl+q closes"
    placeholder = "a few letters of an action, its words or its panel"
    wide = True
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "choose(-1)", priority=True),
        Binding("down", "choose(1)", priority=True),
    ]

    def on_mount(self) -> None:
        """All there is, in the file's order."""
        if not self.there:
            return
        self.entry.value = ""
        self._all = [*self._actions(), *self._locks(), *self._orders(), *self._robots()]
        self._all += self._commands()
        self._shown = self._all
        self._search("")

    def closing(self) -> None:
        """A search is no draft."""

    def below(self) -> Iterable[Widget]:
        """The list of what matches."""
        found = OptionList(id="found")
        found.can_focus = False
        yield found

    def _actions(self) -> Iterable[Find]:
        for panel in self.picture.panels:
            for action in panel.actions:
                cap = self.console_app.caps.get(action.name, Cap(action.key))
                words = " ".join((action.label, action.help, panel.title, *action.utterances))
                yield Find(
                    action.label,
                    caption(cap, self.glyphs),
                    panel.title if not action.help else f"{panel.title}: {action.help}",
                    functools.partial(self.desk.play, action.name),
                    words,
                )

    def _locks(self) -> Iterable[Find]:
        for panel in self.picture.panels:
            locked = self.picture.is_locked(panel)
            word = "Unlock" if locked else "Lock"
            request = AskLock(panel=panel.title, locked=not locked)
            name = f"{word} {panel.title}"
            yield Find(name, "", "panel", functools.partial(self.desk.ask, request), name)

    def _orders(self) -> Iterable[Find]:
        """What the hand may do to the engagement model, in a session that has one."""
        if is_offered(self.picture.engaged, self.picture.verbs):
            for order in ORDERS:
                do = functools.partial(steer, self.console_app, order)
                yield Find(order.text, "", "engagement", do, order.text)

    def _robots(self) -> Iterable[Find]:
        """What a robot can do that needs no button."""
        key = self.console_app.key_of("find")
        for driver, order in orders_of(self.picture):
            args = dict(order.args)
            request = AskVerb(verb=order.verb, args=args, on=driver, source="key", key=key)
            do = functools.partial(self.desk.ask, request)
            yield Find(order.text, "", driver, do, f"{order.text} {order.verb}")

    def _commands(self) -> Iterable[Find]:
        app = self.console_app
        for name, command in app.commands.items():
            if name == command.name and command.found and command.serves(self.picture.role):
                key, words = key_name(app.key_of(name), self.glyphs), command.words
                yield Find(words, key, "console", functools.partial(app.do, name), words)

    def on_input_changed(self, event: Input.Changed) -> None:
        """Narrow the list."""
        event.stop()
        if self.there:
            self._search(event.value)

    def _search(self, typed: str) -> None:
        typed = typed.strip()
        self._shown = self._all
        if typed:
            matcher = Matcher(typed)
            scored = [
                (_score(matcher, typed, find), -index, find) for index, find in enumerate(self._all)
            ]
            hits = [hit for hit in scored if hit[0] > 0]
            self._shown = [find for _, _, find in sorted(hits, key=lambda hit: hit[:2])[::-1]]
        found = self.query_one("#found", OptionList)
        found.clear_options()
        found.add_options([Option(self._line(find)) for find in self._shown])
        if self._shown:
            found.highlighted = 0

    def _line(self, find: Find) -> Content:
        """On one line; where a help is cut off, the list of keys has it whole."""
        ellipsis = self.glyphs.ellipsis
        where = clean(find.where)
        room = max(1, self._width() - KEY - LABEL - 2)
        return Content.assemble(
            fit(find.key, KEY, ellipsis),
            fit(find.name, LABEL, ellipsis),
            "  ",
            (fit(where, min(room, cell_len(where)), ellipsis), "$woz-muted"),
        )

    def _width(self) -> int:
        """Cells inside the frame and beside a scrollbar; the frame is as wide as the theme says."""
        return min(self.app.size.width * 9 // 10, 100) - 6

    def action_choose(self, by: int) -> None:
        """Move in the list; the text field keeps the keyboard."""
        found = self.query_one("#found", OptionList)
        if self._shown:
            found.highlighted = ((found.highlighted or 0) + by) % len(self._shown)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Play what is chosen."""
        event.stop()
        self._do(self.query_one("#found", OptionList).highlighted)

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """A click in this list is meant."""
        event.stop()
        self._do(event.option_index)

    def _do(self, index: int | None) -> None:
        if index is None or index >= len(self._shown):
            return
        chosen = self._shown[index]
        self.leave()
        chosen.do()
