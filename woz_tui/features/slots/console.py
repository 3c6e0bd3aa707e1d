"""Slots on the wizard's screen."""

from __future__ import annotations

from collections.abc import Sequence

from rich.cells import cell_len

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row, clean, cut, length, spread
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.event_sentences import EventContext, EventLine
from woz_tui.console.widgets.feature_console import AskedWords, FeatureConsole
from woz_tui.features.slots.kinds import KEPT, SlotFilled
from woz_tui.features.slots.open_slots import (
    Gap,
    asks_again,
    gap,
    heard,
    lacking,
    open_slots,
    view_of,
)
from woz_tui.protocol.sentence import Sentence

#: Cells that the sentence before a slot keeps at least, and what stands in an empty slot.
BEFORE = 12


def offers(state: ConsoleState, slot: str) -> Row:
    """A digit for each value that is offered, tab for the word that it would take."""
    row: Row = ()
    for digit, value in enumerate(view_of(state, slot).offer, 1):
        row += ((f" {digit} ", "key"), (f" {clean(value)}  ", "plain"))
    if words := heard(state, slot):
        row += ((" tab ", "key"), (f" {clean(words[0])}  ", "plain"))
    return row


def with_hint(row: Row, hint: str, width: int, ellipsis: str) -> Row:
    """What the keys do stands behind a row, as much of it as there is room for; the row gives way
    to the first key.
    """
    first = hint.partition(" · ")[0]
    for keys in (hint, first):
        whole: Row = (*row, (f" {keys}", "muted"))
        if length(whole) <= width:
            return whole
    return spread(row, ((f" {first}", "muted"),), width, ellipsis)


def around(told: Gap, frame: PaintFrame, field: int) -> tuple[str, str]:
    """As much of the sentence as stands beside a field of so many cells: of what is before the end,
    of what is behind the beginning.
    """
    room = max(0, frame.width - field - 3)
    ellipsis = frame.glyphs.ellipsis
    before, after = frame.glyphs.plain(told.before), frame.glyphs.plain(told.after)
    left = max(min(BEFORE, room), room - cell_len(after))
    if cell_len(before) > left:
        while before and cell_len(before) > left - 1:
            before = before[1:]
        before = f"{ellipsis}{before}"
    rest = room - cell_len(before)
    if cell_len(after) > rest:
        while after and cell_len(after) > rest - 1:
            after = after[:-1]
        after = f"{after}{ellipsis}"
    return before, after


def next_rows(state: ConsoleState, frame: PaintFrame, action: str) -> Sequence[Row]:
    """The sentence of the action that comes next, with its first open slot, before its key is
    pressed.
    """
    slot = open_slots(state, action)[0]
    told, glyphs = gap(state, action, slot, {}), frame.glyphs
    name = f" {slot} "
    before, after = around(told, frame, len(name))
    row: Row = ((f" {before}", "strong"), (name, "flash"), (after, "strong"))
    asked = say("slots.asked_before", "asked for before it is said")
    below = with_hint(offers(state, slot), asked, frame.width, glyphs.ellipsis)
    return [cut(each, frame.width, glyphs.ellipsis) for each in (row, below)][: frame.height]


def _filled(message: SlotFilled, shown: EventContext) -> EventLine | None:
    if message.source == KEPT:  # its sentence says it
        return None
    known = _SOURCES.get(message.source)
    source = message.source if known is None else word(known)
    return EventLine("info", f"{message.slot}: {message.text}", source)


#: Where what stands in a slot came from.
_SOURCES = {
    "typed": Sentence("slots.typed", "typed"),
    "offered": Sentence("slots.offered", "offered"),
    "heard": Sentence("slots.heard", "heard"),
    "program": Sentence("slots.program", "program"),
}


SENTENCES = {SlotFilled: _filled}
CONSOLE = FeatureConsole(
    asks=AskedWords(
        lacking=lacking,
        again=asks_again,
        dialog=f"{__package__}.dialog:SlotDialog",
        rows=next_rows,
    ),
)
