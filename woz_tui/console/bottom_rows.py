"""The lines at the bottom: script, its next sentence and hints as a rule, the stop when it is
pressed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from rich.cells import cell_len

from woz_tui.console.cells import Cells, Row, clean, cut, fit, length, spread, wrap_row
from woz_tui.console.console_state import ConsoleState
from woz_tui.console.glyphs import Glyphs, PaintFrame
from woz_tui.console.number_text import elapsed, millis
from woz_tui.console.script_row import script_row, upcoming
from woz_tui.console.sentence_rows import sentence_rows
from woz_tui.console.stop_confirmation import confirmed_words, missing_row
from woz_tui.timeline.episodes import StopEpisode


@dataclass(frozen=True, slots=True)
class News:
    """A sentence in the place of the hints; `look` as in `cells.LOOKS`."""

    text: str = ""
    look: str = "muted"


@dataclass(frozen=True, slots=True)
class BarInfo:
    """What does not come from messages.

    `news` takes the place of the `hints` (keys with a word each) for a while; `page` stands behind
    the hints and says which page of the panels is shown. `next` is the key of the script, `skip`
    leaves its line out, `release` the one that releases the stop, `take_over` lets a console that
    watches play. `then`: keys and labels of what is likely to follow the last act. `asked_us`:
    session time at which this console asked for a stop that has not been answered yet.
    """

    news: News = News()
    hints: tuple[tuple[str, str], ...] = ()
    next: str = ""
    release: str = ""
    asked_us: int | None = None
    page: str = ""
    skip: str = ""
    take_over: str = ""
    then: tuple[tuple[str, str], ...] = ()


def bar_rows(picture: ConsoleState, frame: PaintFrame, bar: BarInfo) -> list[Row]:
    """As many rows as the frame has, two at least. What is urgent takes the lowest."""
    lines = max(2, frame.height)
    urgent = _urgent(picture, frame, bar)
    script = [script_row(picture, frame, bar.next, bar.skip, bar.then)]
    if picture.nobody_plays:
        what = (
            f" {frame.glyphs.warning} Nobody plays the robot. {bar.take_over} plays it from here."
        )
        script = [((fit(what, frame.width), "alarm-soft"),)]
    if lines > len(script) + 1:
        script += sentence_rows(picture, replace(frame, height=2), upcoming(picture))
    hints = [hint_row(bar.hints, frame.width, bar.page)]
    rows = [*script, *hints][:lines]
    if urgent:
        rows[lines - len(urgent) :] = urgent
    return rows


def _urgent(picture: ConsoleState, frame: PaintFrame, bar: BarInfo) -> list[Row]:
    """What the wizard must know now, in two rows at most."""
    glyphs, width, asked_us = frame.glyphs, frame.width, bar.asked_us
    if picture.ended and picture.lost and asked_us is None:
        over, where = " The session has ended.", " enter shows where its log is"
        return [((fit(over, width), "strong"),), ((fit(where, width), "muted"),)]
    if picture.lost and (asked_us is not None or picture.stop is not None):
        return _undelivered(glyphs, width)
    if picture.lost:
        why = f" {glyphs.error} The robot process is gone: {picture.lost}"
        what = " No key is sent. It stops driving by itself. enter shows what can be done"
        return [((fit(why, width), "alarm"),), ((fit(what, width), "alarm-soft"),)]
    if picture.stop is not None:
        return _stopped(picture.stop, bar.release, glyphs, width)
    if asked_us is not None:
        waited = millis(frame.now - asked_us)
        first = f" {glyphs.stop} STOP SENT {glyphs.middle} no answer yet, {waited}"
        return [((fit(first, width), "alarm"),), ((" " * width, "alarm-soft"),)]
    return _told(bar.news, glyphs, width)


def _told(news: News, glyphs: Glyphs, width: int) -> list[Row]:
    """News on one line, or on two if it takes them: the remedy stands at its end."""
    if not news.text:
        return []
    first, *rest = wrap_row(((f" {glyphs.plain(clean(news.text))}", news.look),), 1, width)
    rows = [first, sum(rest, ())] if rest else [first]
    return [cut(row, width, glyphs.ellipsis) for row in rows]


def _undelivered(glyphs: Glyphs, width: int) -> list[Row]:
    first = (
        f" {glyphs.stop} STOP NOT DELIVERED: the robot process is gone; use the robot's own switch"
    )
    second = " Without this console the robot process stops driving by itself."
    return [((fit(first, width), "alarm"),), ((fit(second, width), "alarm-soft"),)]


def _stopped(stop: StopEpisode, release: str, glyphs: Glyphs, width: int) -> list[Row]:
    left = f" {glyphs.stop} STOPPED by {clean(stop.source)} at {elapsed(stop.begin)}"
    hint = f"{release} releases it " if release else ""
    if len(left) + len(hint) >= width:
        hint = ""
    first = spread(((left, "alarm"), (" " * width, "alarm")), ((hint, "alarm"),), width, " ")
    if not stop.settled:
        second: Row = ((fit(" waiting for the drivers to confirm", width), "alarm-soft"),)
        return [first, second]
    return [first, _settled(stop, glyphs, width)]


def _settled(stop: StopEpisode, glyphs: Glyphs, width: int) -> Row:
    """Who did not confirm and who did; parts are named where there is room."""
    row = missing_row(stop, glyphs)
    said = " confirmed: "
    room = width - length(row) - len(said)
    row = (*row, (f"{said}{clean(confirmed_words(stop, room))}", "alarm-soft"))
    blanks = max(0, width - length(row))
    return cut((*row, (" " * blanks, "alarm-soft")), width, glyphs.ellipsis)


def hint_row(hints: tuple[tuple[str, str], ...], width: int, page: str = "") -> Row:
    """Keys with a word each, as many as have room beside the page's number."""
    row: Row = ((" ", "plain"),)
    used = 1
    behind = f"{page} " if page else ""
    for key, what in hints:
        need = cell_len(key) + cell_len(what) + 3
        if used + need > width - cell_len(behind):
            break
        row += ((key, "strong"), (f" {what}", "muted"), ("  ", "plain"))
        used += need
    return spread(row, ((behind, "muted"),), width) if behind else row


class StopBar(Cells):
    """The bar over the whole width at the bottom of every screen."""

    def paint(self, picture: ConsoleState, frame: PaintFrame, bar: BarInfo) -> None:
        """Show the stop, or the news and hints."""
        self.show(bar_rows(picture, frame, bar))
