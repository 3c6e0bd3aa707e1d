"""The list of events, newest on top."""

from __future__ import annotations

from dataclasses import replace
from itertools import zip_longest

from rich.cells import cell_len

from woz_tui.console.cells import Cells, Piece, Row, clean, cut, heading
from woz_tui.console.figures import elapsed, left, seconds
from woz_tui.console.glyphs import Frame
from woz_tui.console.sentences import Event
from woz_tui.console.state import ConsoleState
from woz_tui.session.variables import UNTOLD

#: Rows the list may repaint at once, and a second in the long run. A flood of lines moves every row
#: at every painting; nobody reads that, and it would fill a slow line to the terminal.
BURST_ROWS, ROWS_S = 400, 100

#: What takes less has no length worth a figure, in microseconds.
BRIEF_US = 50_000

#: From here on what is left is told in minutes, in microseconds.
_MINUTES_US = 99_950_000

#: Colour and glyph of each kind of line; the glyph alone tells them apart.
LOOK = {
    "running": "run",
    "done": "good",
    "waits": "wait",
    "failed": "bad",
    "refused": "warn",
    "stopped": "warn",
    "replaced": "warn",
    "info": "muted",
    "warning": "warn",
    "error": "bad",
    "note": "run",
    "marker": "run",
    "driver": "warn",
    "stop": "bad",
    "forced": "wait",
    "heard": "run",
}


def chosen(picture: ConsoleState, height: int) -> list[Event]:
    """The newest events, newest first; failures that nobody has seen stay among them, in half of
    the rows at most: the status line counts all of them, and what happens now is to be seen.
    """
    events = list(picture.events)
    unseen = {failure.run for failure in picture.unseen()}
    older = events[: max(0, len(events) - height)]
    pins = [event for event in older if event.run and event.run in unseen]
    pinned = pins[max(0, len(pins) - max(0, height) // 2) :]
    newest = events[len(older) + len(pinned) :]
    return [*reversed(newest), *reversed(pinned)]


def event_rows(picture: ConsoleState, frame: Frame) -> list[Row]:
    """As many rows as the frame is high."""
    return [event_row(event, picture, frame) for event in chosen(picture, frame.height)]


def event_row(event: Event, picture: ConsoleState, frame: Frame) -> Row:
    """One event: when, its mark, what, details as far as there is room, how long it took."""
    glyphs = frame.glyphs
    look = LOOK.get(event.mark, "plain")
    mark = str(getattr(glyphs, event.mark, glyphs.info))
    front: tuple[Piece, ...] = ((f" {elapsed(event.t):>5} ", "muted"), (f"{mark} ", look))
    back = _back(event, picture, frame)
    room = frame.width - sum(cell_len(text) for text, _ in (*front, back))
    text = glyphs.plain(clean(event.text))
    times = f"{event.times} times" if event.times > 1 else ""
    detail = glyphs.plain(clean(", ".join(filter(None, (times, event.detail)))))
    tone = look if event.mark in ("failed", "error", "refused", "warning", "stop") else "plain"
    said = glyphs.plain(clean(event.said)) if event.said != UNTOLD else ""
    said = f" {glyphs.opening}{said}{glyphs.closing}" if said else ""
    body: Row = ((text, tone), (said, "muted"), (f"  {detail}" if detail else "", "muted"))
    if tone != "plain":  # why it went wrong comes before what it was
        body = (body[0], body[2], body[1])
    return (*front, *cut(body, max(1, room), glyphs.ellipsis), back)


def _back(event: Event, picture: ConsoleState, frame: Frame) -> Piece:
    if event.mistake:
        return (" mistake ", "warn")
    if event.took_us is not None:
        told = event.took_us >= BRIEF_US and event.mark not in ("refused", "failed")
        told = told and not event.untimed
        return (f" {seconds(event.took_us)} " if told else " ", "muted")
    if event.mark == "running":
        return _under_way(event, picture, frame)
    return (" ", "plain")


def _under_way(event: Event, picture: ConsoleState, frame: Frame) -> Piece:
    run = picture.runs.get(event.run)
    if run is None:
        return (" ", "plain")
    if (held := run.held_for(frame.now)) is not None:
        return (f" waits {seconds(held[0])} ", "wait")
    if not run.running:
        return (" queued ", "wait")
    to_go, _ = run.timing(frame.now)
    shown = seconds(frame.now - event.t)
    if to_go is not None:
        shown = f"{seconds(to_go)} left" if to_go < _MINUTES_US else f"{left(to_go)} left"
    return (f" {shown} ", "run")


class Events(Cells):
    """The list of events."""

    _shape = (0, 0, 0)
    _budget = float(BURST_ROWS)
    _painted_us = 0

    def paint(self, picture: ConsoleState, frame: Frame) -> None:
        """Show a heading and the newest events; in a flood of them not every time. A
        replay that stands still has no floods.
        """
        inner = replace(frame, height=frame.height - 1)
        rows = [heading("Events", frame), *event_rows(picture, inner)]
        if not picture.rate or self._affords(rows, frame, picture):
            self.show(rows)

    def _affords(self, rows: list[Row], frame: Frame, picture: ConsoleState) -> bool:
        """Whether so many rows may change now; a new size or a new beginning is always drawn."""
        passed_us = max(0, frame.now - self._painted_us) / picture.rate
        self._painted_us = frame.now
        self._budget = min(BURST_ROWS, self._budget + passed_us * ROWS_S / 1e6)
        shape, self._shape = self._shape, (frame.width, frame.height, picture.edition)
        if self._budget <= 0 and shape == self._shape:
            return False
        self._budget -= sum(old != new for old, new in zip_longest(self.rows, rows))
        return True
