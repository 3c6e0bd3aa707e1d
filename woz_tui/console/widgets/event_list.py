"""Event list, newest on top: what people did and what is wrong comes first.

What machines tell of themselves has the rows that are left. The engagement model has one row,
always the lowest and without a time, in which each change replaces the one before. A key selects
what is listed.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import zip_longest

from rich.cells import cell_len

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Cells, Piece, Row, clean, cut, heading
from woz_tui.console.drawing.glyphs import Glyphs, PaintFrame
from woz_tui.console.drawing.number_text import seconds, time_left
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.event_sentences import EventLine
from woz_tui.console.state.remedy_text import remedy_text
from woz_tui.console.widgets.bottom_rows import quotation
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.text_cleaning import elapsed

#: Rows the list may repaint at once, and a second in the long run. A flood of lines moves every row
#: at every painting; nobody reads that, and it would fill a slow line to the terminal.
BURST_ROWS, ROWS_S = 400, 100

#: What may be listed; the heading names it. None of them leaves a fault out.
ALL, ACTS, FAULTS, MACHINE = VIEWS = ("all", "own acts", "faults", "machine")
_VIEW_WORDS = {
    ALL: Sentence("events.all", "all"),
    ACTS: Sentence("events.own_acts", "own acts"),
    FAULTS: Sentence("events.faults", "faults"),
    MACHINE: Sentence("events.machine", "machine"),
}
#: From so many rows on the engagement model has one.
MODEL_ROWS = 3
#: What takes less has no length worth a figure, in microseconds.
BRIEF_US = 50_000

#: From here on what is left is told in minutes, in microseconds.
_MINUTES_US = 99_950_000

#: Colour and glyph of each kind of line; the glyph alone tells them apart.
LOOK = {
    "running": "run",
    "done": "good",
    "sent": "plain",
    "waits": "wait",
    "left_out": "muted",
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


def listed_events(state: ConsoleState, height: int, view: str = ALL) -> list[EventLine]:
    """The newest events, newest first; failures that nobody has seen stay among them, in half of
    the rows at most: the status line counts all of them, and what happens now is to be seen.
    """
    listed = [event for event in state.events if not event.model]
    events = [event for event in listed if _is_in(view, event)]
    unseen = {failure.run for failure in state.runs.unseen()}
    older = events[: max(0, len(events) - height)]
    pins = [event for event in older if event.run and event.run in unseen]
    pinned = pins[max(0, len(pins) - max(0, height) // 2) :]
    newest = events[len(older) + len(pinned) :]
    spare = height - len(newest) - len(pinned) if view == ALL else 0
    if spare > 0:  # nothing is left out so far
        rest = [event for event in listed if not _is_in(view, event)][-spare:]
        shown = {id(event) for event in (*newest, *rest)}
        newest = [event for event in listed if id(event) in shown]
    return [*reversed(newest), *reversed(pinned)]


def _is_in(view: str, event: EventLine) -> bool:
    """Whether an event belongs to a view by right, and not only where rows are left."""
    if view == MACHINE:
        return event.machine or event.fault
    return event.fault or (view != FAULTS and not event.machine)


def event_rows(state: ConsoleState, frame: PaintFrame, view: str = ALL) -> list[Row]:
    """As many rows as the frame is high, at most; the engagement model's is the lowest."""
    model = next((event for event in reversed(state.events) if event.model), None)
    if model is None or view in (ACTS, FAULTS) or frame.height < MODEL_ROWS:
        return [
            event_row(event, state, frame) for event in listed_events(state, frame.height, view)
        ]
    height = frame.height - 1
    rows = [event_row(event, state, frame) for event in listed_events(state, height, view)]
    return [*rows, *[()] * (height - len(rows)), event_row(model, state, frame)]


def event_row(event: EventLine, state: ConsoleState, frame: PaintFrame) -> Row:
    """One event: when, its mark, what, details as far as there is room, how long it took."""
    glyphs = frame.glyphs
    look = LOOK.get(event.mark, "plain")
    mark = str(getattr(glyphs, event.mark, glyphs.info))
    # Where others have their time, so five cells in any language.
    when = say("events.model", "model") if event.model else elapsed(event.t)
    front: tuple[Piece, ...] = ((f" {when:>5} ", "muted"), (f"{mark} ", look))
    back = _time_piece(event, state, frame)
    room = frame.width - sum(cell_len(text) for text, _ in (*front, back))
    text = glyphs.plain(clean(event.text))
    times = say("events.times", "{number} times", number=event.times) if event.times > 1 else ""
    told = remedy_text(event.detail, state)
    detail = glyphs.plain(clean(", ".join(filter(None, (times, told)))))
    tone = look if event.mark in ("failed", "error", "refused", "warning", "stop") else "plain"
    said = quotation(event.utterance, glyphs)
    said = f" {said}" if said else ""
    body: Row = ((text, tone), (said, "muted"), (f"  {detail}" if detail else "", "muted"))
    if tone != "plain":  # why it went wrong comes before what it was
        body = (body[0], body[2], body[1])
    return (*front, *cut(body, max(1, room), glyphs.ellipsis), back)


def act_text(state: ConsoleState, run: str, action: str, glyphs: Glyphs) -> str:
    """What the list calls a run or a command, with what it said; `action`: its name, if the list
    does not have it.
    """
    event = state.event_of(run)
    if event is None:
        return state.label(action)
    return f"{event.text} {quotation(event.utterance, glyphs)}".strip()


def _time_piece(event: EventLine, state: ConsoleState, frame: PaintFrame) -> Piece:
    """What stands at the right: how long it took, takes or waits; that it was a mistake."""
    if event.mistake:
        return (f" {say('events.is_mistake', 'mistake')} ", "warn")
    if event.took_us is not None:
        told = event.took_us >= BRIEF_US and event.mark not in ("refused", "failed")
        told = told and not event.untimed
        return (f" {seconds(event.took_us)} " if told else " ", "muted")
    run = state.runs.get(event.run) if event.mark == "running" else None
    if run is None:
        return (" ", "plain")
    if (held := run.held_for(frame.now)) is not None:
        return (f" {say('events.waits', 'waits {time}', time=seconds(held[0]))} ", "wait")
    if not run.running:
        return (f" {say('events.queued', 'queued')} ", "wait")
    untimed = event.untimed or state.untimed(event.action)
    to_go = None if untimed else run.timing(frame.now)[0]
    shown = seconds(frame.now - event.t)
    if to_go is not None:
        left = seconds(to_go) if to_go < _MINUTES_US else time_left(to_go)
        shown = say("events.left", "{time} left", time=left)
    return (f" {shown} ", "run")


class EventList(Cells):
    """The list of events; `view` is what of them."""

    view = ALL
    #: The key that turns to the next view.
    key = ""
    _shape: tuple[object, ...] = ()
    _budget = float(BURST_ROWS)
    _painted_us = 0

    def turn(self) -> None:
        """Go on to the next view."""
        self.view = VIEWS[(VIEWS.index(self.view) + 1) % len(VIEWS)]

    def paint(self, state: ConsoleState, frame: PaintFrame) -> None:
        """Show a heading and the newest events; in a flood of them not every time. A
        replay that stands still has no floods.
        """
        inner = replace(frame, height=frame.height - 1)
        rows = [self._heading(frame), *event_rows(state, inner, self.view)]
        if not state.rate or self._affords(rows, frame, state):
            self.show(rows)

    def _heading(self, frame: PaintFrame) -> Row:
        """Title, rule, at the right the view and the key that turns it, where there is room."""
        turns = word(_VIEW_WORDS[self.view])
        if self.key:
            filters = say("events.filters", "{key} filters", key=self.key)
            turns = f"{turns} {frame.glyphs.middle} {filters}"
        width = max(0, frame.width - cell_len(turns) - 1)
        bare = heading(say("events.heading", "Events"), replace(frame, width=width))
        return (*bare, (turns, "muted"), (" ", "plain"))

    def _affords(self, rows: list[Row], frame: PaintFrame, state: ConsoleState) -> bool:
        """Whether so many rows may change now; a new size or a new beginning is always drawn."""
        passed_us = max(0, frame.now - self._painted_us) / state.rate
        self._painted_us = frame.now
        self._budget = min(BURST_ROWS, self._budget + passed_us * ROWS_S / 1e6)
        now = (frame.width, frame.height, state.edition, self.view)
        shape, self._shape = self._shape, now
        if self._budget <= 0 and shape == self._shape:
            return False
        self._budget -= sum(old != new for old, new in zip_longest(self.rows, rows))
        return True
