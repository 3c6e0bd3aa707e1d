"""Go somewhere in the log: to a time that is typed, or to a place that is chosen."""

from __future__ import annotations

from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.content import Content
from textual.fuzzy import Matcher

from woz_tui.console.cells import clean, fit
from woz_tui.console.number_text import elapsed
from woz_tui.console.replay.replay_state import TimelinePlace
from woz_tui.console.replay.replay_timeline import sign_of
from woz_tui.console.screens.choice import SearchDialog
from woz_tui.protocol.requests import AskReplay
from woz_tui.replay.seek import time_of

TIME, SORT = 8, 14


class GoDialog(SearchDialog[TimelinePlace]):
    """Type `12:34`, or a few letters of a marker; arrows choose among all places."""

    heading = "Go to"
    hint = "enter goes there · arrows choose · ctrl+q closes"
    placeholder = "12:34, or a few letters of a marker, note, trial, stop ..."
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("pageup", "choose(-10)", priority=True),
        Binding("pagedown", "choose(10)", priority=True),
    ]

    def matching(self, typed: str) -> list[TimelinePlace]:
        """All places; from a time that is typed on, or those that the letters stand for."""
        replay = self.picture.replay
        places = list(replay.places) if replay is not None else []
        t = time_of(typed)
        if t is not None:
            return [TimelinePlace(t, "time", "this time"), *(p for p in places if p.t >= t)]
        matcher = Matcher(typed)
        return [p for p in places if not typed or matcher.match(f"{p.sort} {p.text}")]

    def first(self, typed: str) -> int:
        """The next one after now, as long as nothing is typed."""
        now = self.picture.now(self.console_app.clock.now_us())
        later = (n for n, place in enumerate(self.shown) if place.t > now)
        return 0 if typed else next(later, len(self.shown) - 1)

    def line(self, item: TimelinePlace) -> Content:
        """Its time, its sort, what it says."""
        sign, look = sign_of(item.sort, self.glyphs)
        colour = {"bad": "bold $woz-bad", "plain": ""}.get(look, f"$woz-{look}")
        return Content.assemble(
            fit(elapsed(item.t), TIME, right=True),
            "  ",
            (sign, colour),
            "  ",
            (fit(item.sort, SORT, self.glyphs.ellipsis), "$woz-muted"),
            clean(item.text),
        )

    def chose(self, item: TimelinePlace | None, typed: str) -> None:
        """Go to it, or to what was typed."""
        to = f"{item.t / 1_000_000:.6f}" if item is not None else typed
        if to:
            self.requests.ask(AskReplay(what="go", to=to))
