"""Panels of actions: their places, and for each action its key, label, state and time left.

File and screen size alone decide the places.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from rich.cells import cell_len, set_cell_size

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Cells, Row, clean, cut, fit, fit_most
from woz_tui.console.drawing.glyphs import Glyphs, PaintFrame
from woz_tui.console.drawing.key_caps import KeyCap, caption
from woz_tui.console.drawing.number_text import time_left
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.remedy_text import button_of
from woz_tui.console.state.view_models import ButtonState, ButtonView
from woz_tui.console.widgets.bottom_rows import quotation
from woz_tui.protocol.panels import TYPED, ActionView, PanelView
from woz_tui.protocol.sentence import Sentence

#: Cells of a column: below, labels suffer; above, the eye has too far to go.
NARROW, COMFORTABLE, BEST, WIDE = 18, 24, 32, 38
#: From this width on there is room for what is said beside the labels: columns are wider then.
ROOM_FOR_WORDS, BEST_WITH_WORDS, WIDE_WITH_WORDS = 100, 54, 74
#: Cells between two columns.
GUTTER = 1
#: Cells of a slot beside key cap and label: a blank, the state's glyph, a blank.
FIXED = 3


class Slot(NamedTuple):
    """One line of a column: a panel's title (`action` is None) or an action.

    `panel` counts from 0; `again` marks the title of a panel that goes on in a new column.
    """

    page: int
    column: int
    row: int
    panel: int
    action: ActionView | None = None
    again: bool = False


@dataclass(frozen=True, slots=True)
class PanelLayout:
    """All slots, how many pages they fill, and the columns' geometry in cells."""

    slots: tuple[Slot, ...]
    pages: int
    columns: int
    width: int
    cut: int
    splits: int

    def page_of(self, panel: int) -> int:
        """The page on which a panel begins."""
        return next((slot.page for slot in self.slots if slot.panel == panel), 0)


def lay_out(panels: Sequence[PanelView], width: int, height: int, cap: int) -> PanelLayout:
    """The best arrangement in `width` x `height` cells with key caps of `cap` cells.

    Fewest pages first, then fewest labels cut short, then fewest panels torn apart, then air
    between the panels, then columns of a comfortable width.
    """
    height = max(3, height)
    roomy = width >= ROOM_FOR_WORDS
    best, widest = (BEST_WITH_WORDS, WIDE_WITH_WORDS) if roomy else (BEST, WIDE)
    most = max(1, (width + GUTTER) // (NARROW + GUTTER))
    candidates = []
    for columns in range(1, most + 1):
        cells = min(widest, (width - GUTTER * (columns - 1)) // columns)
        for split, air in ((False, 1), (False, 0), (True, 1), (True, 0)):
            flow = _flow(panels, columns, height, air, split)
            if flow is None:
                continue
            if flow.pages == 1:
                flow = _balanced(panels, flow, columns, height, air=air, split=split)
                if flow.used < columns:
                    continue
            short = sum(
                cell_len(action.label) > cells - cap - FIXED
                for panel in panels
                for action in panel.actions
            )
            far = abs(best - cells)
            cost = (flow.pages, short, flow.splits, -air, cells < COMFORTABLE, far)
            found = PanelLayout(tuple(flow.slots), flow.pages, columns, cells, short, flow.splits)
            candidates.append((cost, found))
            if flow.pages == 1 and not flow.splits:
                break  # no other of as many columns is better
    if not candidates:  # no panels at all
        return PanelLayout((), 1, 1, min(widest, width), 0, 0)
    return min(candidates, key=lambda candidate: candidate[0])[1]


def append_panel(arranged: PanelLayout, panel: PanelView, number: int, height: int) -> PanelLayout:
    """The same with one panel more, behind all others, of which none moves: in the column with the
    most room on the last page, or else on a page of its own.
    """
    height, page = max(3, height), arranged.pages - 1
    filled = dict.fromkeys(range(arranged.columns), 0)
    for slot in arranged.slots:
        if slot.page == page:
            filled[slot.column] = max(filled[slot.column], slot.row + 1)
    column = min(filled, key=lambda each: (filled[each], -each))
    rest = height - filled[column] - 1 - len(panel.actions)
    flow = _flow([panel], arranged.columns, height, 0, split=True)
    if flow is None:  # never of one that may be split
        return arranged
    if rest >= 0:
        row = filled[column] + (filled[column] > 0 and rest > 0)
        moved = [each._replace(column=column, row=row + each.row) for each in flow.slots]
    else:
        page += 1
        moved = flow.slots
    slots = [each._replace(page=page + each.page, panel=number) for each in moved]
    pages = page + (flow.pages if rest < 0 else 1)
    return replace(arranged, slots=(*arranged.slots, *slots), pages=pages)


def _balanced(
    panels: Sequence[PanelView], flow: _Flow, columns: int, height: int, *, air: int, split: bool
) -> _Flow:
    """The same on one page with columns as equally tall as can be."""
    total = sum(1 + len(panel.actions) for panel in panels)
    for lower in range(max(3, total // columns), height):
        lowered = _flow(panels, columns, lower, air, split)
        if lowered is not None and (lowered.pages, lowered.splits) <= (1, flow.splits):
            return lowered
    return flow


@dataclass(frozen=True, slots=True)
class _Flow:
    slots: list[Slot]
    pages: int
    splits: int

    @property
    def used(self) -> int:
        """Columns that hold something on the first page."""
        return 1 + max((slot.column for slot in self.slots), default=-1)


def _flow(
    panels: Sequence[PanelView], columns: int, height: int, air: int, split: bool
) -> _Flow | None:
    """Fill column after column, page after page; None if a panel is too tall to stay whole."""
    slots: list[Slot] = []
    page = column = row = splits = 0
    for number, panel in enumerate(panels):
        needed = 1 + len(panel.actions)
        if needed > height and not split:
            return None
        if row:
            row += air
        rest = height - row
        least = min(needed, 3) if split else needed  # never a title without actions beneath it
        if row and rest < least:
            page, column, row = _next(page, column, columns)
        slots.append(Slot(page, column, row, number))
        row += 1
        for action in panel.actions:
            if row >= height:
                page, column, row = _next(page, column, columns)
                slots.append(Slot(page, column, row, number, again=True))
                splits += 1
                row += 1
            slots.append(Slot(page, column, row, number, action))
            row += 1
    return _Flow(slots, page + 1, splits)


def _next(page: int, column: int, columns: int) -> tuple[int, int, int]:
    return (page, column + 1, 0) if column + 1 < columns else (page + 1, 0, 0)


#: Key caps are at least and at most this wide, with a blank at each side.
CAP_LEAST, CAP_MOST = 3, 8
#: Lines that panels get at most on a roomy screen, where events stand beneath them.
MOST = 32

#: Cells of what is said, beside the longest label of its panel, at the least; and beside a label
#: with a word behind it.
WORDS, FEW_WORDS = 12, 5

_LOOK = {
    ButtonState.READY: "plain",
    ButtonState.QUEUED: "wait",
    ButtonState.HELD: "wait",
    ButtonState.RUNNING: "run",
    ButtonState.DONE: "good",
    ButtonState.SENT: "plain",
    ButtonState.WAITS: "wait",
    ButtonState.LEFT_OUT: "muted",
    ButtonState.FAILED: "bad",
    ButtonState.REFUSED: "warn",
    ButtonState.STOPPED: "warn",
    ButtonState.REPLACED: "warn",
    ButtonState.LOCKED: "muted",
    ButtonState.UNREACHABLE: "muted",
}


@dataclass(frozen=True, slots=True)
class PanelSelection:
    """What does not come from messages: key caps, the chosen panel, the key just pressed.

    `further`: how many pages behind the one on which the chosen panel begins are turned.
    """

    caps: Mapping[str, KeyCap]
    chosen: int = 0
    pressed: str = ""
    further: int = 0

    def page(self, arranged: PanelLayout) -> int:
        """The page that is shown."""
        return min(arranged.page_of(self.chosen) + self.further, arranged.pages - 1)

    def at(self, page: int, arranged: PanelLayout, panel: int | None = None) -> PanelSelection:
        """The same with this page turned, and `panel` chosen; else the first one that begins on the
        page, or the one that goes on there.
        """
        if panel is None:
            there = [slot.panel for slot in arranged.slots if slot.page == page]
            begun = (each for each in there if arranged.page_of(each) == page)
            panel = min(begun, default=max(there, default=0))
        return replace(self, chosen=panel, further=page - arranged.page_of(panel))


def cap_width(state: ConsoleState, board: PanelSelection, glyphs: Glyphs) -> int:
    """One width for all key caps, so that labels stand in line."""
    longest = max(
        (
            cell_len(caption(board.caps.get(action.name, KeyCap(action.key)), glyphs))
            for panel in state.panels
            for action in panel.actions
        ),
        default=1,
    )
    return min(CAP_MOST, max(CAP_LEAST, longest + 2))


def arrange(panels: Sequence[PanelView], width: int, height: int, cap: int) -> PanelLayout:
    """The best arrangement of the file's panels; the one of typed sentences comes and grows while
    the wizard works, and nothing may move then.
    """
    own = panels[:-1] if panels and panels[-1].title == TYPED else panels
    arranged = lay_out(own or panels, width, height, cap)
    if own and len(own) < len(panels):
        return append_panel(arranged, panels[-1], len(own), height)
    return arranged


def panel_rows(
    state: ConsoleState, frame: PaintFrame, arranged: PanelLayout, board: PanelSelection
) -> list[Row]:
    """The page with the chosen panel, as large as the frame."""
    page = board.page(arranged)
    cap = cap_width(state, board, frame.glyphs)
    column_frame = replace(frame, width=arranged.width)
    slots = [slot for slot in arranged.slots if slot.page == page]
    panels = {slot.panel for slot in slots}
    said = _shown_sentences(
        state, [slot for slot in arranged.slots if slot.panel in panels], column_frame, cap
    )
    grid = {
        (slot.row, slot.column): _slot(state, slot, column_frame, board, cap, said=said)
        for slot in slots
    }
    rows = []
    blank: Row = ((" " * arranged.width, "plain"),)
    for y in range(frame.height):
        row: Row = ()
        for column in range(arranged.columns):
            if column:
                row += ((" " * GUTTER, "plain"),)
            row += grid.get((y, column), blank)
        rows.append(cut(row, frame.width, frame.glyphs.ellipsis))
    return rows


def _shown_sentences(
    state: ConsoleState, slots: Sequence[Slot], frame: PaintFrame, cap: int
) -> dict[str, str]:
    """What actions say, by their names; of a panel in which one has no room for it, of none."""
    panels: dict[int, dict[str, str]] = {}
    narrow = set()
    for slot in slots:
        if slot.action is None:
            continue
        standing = state.button_view(state.front[slot.panel], slot.action, frame.now)
        words = quotation(state.words_on(slot.action.name, standing), frame.glyphs)
        if not words:
            continue
        panels.setdefault(slot.panel, {})[slot.action.name] = words
        if frame.width - cap - FIXED - 2 - cell_len(clean(slot.action.label)) < WORDS:
            narrow.add(slot.panel)
    return {
        name: words
        for panel, told in panels.items()
        if panel not in narrow
        for name, words in told.items()
    }


def _slot(
    state: ConsoleState,
    slot: Slot,
    frame: PaintFrame,
    board: PanelSelection,
    cap: int,
    *,
    said: Mapping[str, str],
) -> Row:
    """A panel's title, or an action: key cap, glyph, label, what is said where there is room, and
    a word; while it runs, the ground behind them is the time left.
    """
    panel, action, glyphs = state.front[slot.panel], slot.action, frame.glyphs
    if action is None:
        return _title(state, slot, frame, slot.panel == board.chosen)
    standing = state.button_view(panel, action, frame.now)
    ready = standing.state is ButtonState.READY
    dim = state.session.stop is not None or bool(state.lost)
    look = "muted" if dim and ready else _LOOK[standing.state]
    told = _told(state, panel, standing)
    if without := [what for what in action.without if "." not in what]:
        told = told or say("panels.lacks", "no {what}", what=", ".join(without))
        if not action.verbs and ready:
            look = "muted"
    key = caption(board.caps.get(action.name, KeyCap(action.key)), glyphs)
    keylook = "flash" if board.pressed == action.name else "key" if key else "plain"
    key = fit_most(key, cap - 1, glyphs.ellipsis)
    before = (cap - cell_len(key)) // 2
    key = " " * before + key + " " * (cap - before - cell_len(key))
    label, words = clean(action.label), said.get(action.name, "")
    room = frame.width - cap - 1
    spare = room - 2 - cell_len(label)
    timed = standing.state in (ButtonState.RUNNING, ButtonState.HELD)
    shown = f" {told} " if told else " "
    if not (told if timed else spare > cell_len(told) + 1):
        shown = ""
    left_over = spare - 2 - cell_len(shown)
    beside = ""
    if words and left_over >= FEW_WORDS:
        beside = f"  {fit(words, left_over, glyphs.ellipsis)}"
    sign = " " if ready else str(getattr(glyphs, standing.state.value))
    width = room - 2 - cell_len(shown) - cell_len(beside)
    front = f"{sign} {fit(label, width, glyphs.ellipsis)}"
    body: Row = ((front, look), (beside, "muted"), (shown, look))
    if timed and standing.share is not None:
        text = f"{front}{beside}{shown}"
        filled = round((1 - standing.share) * room)
        gone = set_cell_size(text, filled)
        body = ((gone, "fill"), (set_cell_size(text[len(gone) :], room - filled), look))
    return ((key, keylook), (" ", "plain"), *body)


def _title(state: ConsoleState, slot: Slot, frame: PaintFrame, chosen: bool) -> Row:
    panel = state.front[slot.panel]
    glyphs, width = frame.glyphs, frame.width
    mark = f"{glyphs.here} " if chosen and not slot.again else "  "
    whose = clean(state.played_by(panel))
    if whose:
        whose = f" {glyphs.middle} {fit_most(whose, max(WORDS, width // 3), glyphs.ellipsis)}"
    title = state.title(panel)
    room = width - 3 - cell_len(clean(title)) - cell_len(whose)
    continued = say("panels.continued", "continued")
    note = f" {continued}" if slot.again else ""
    if state.is_locked(panel):  # with the key that opens it, where there is one and room
        opener = state.keys.get(button_of("unlock", panel.title, state), "")
        told = [say("panels.locked", "locked")]
        if opener:
            told.insert(0, say("panels.locked_by", "locked ({key})", key=opener))
            told.insert(0, say("panels.opens_it", "locked, {key} opens it", key=opener))
        note = next((f" {each}" for each in told if cell_len(each) < room), f" {told[-1]}")
    note += whose
    if slot.again and cell_len(clean(title)) > width - 3 - cell_len(note):
        note = note.replace(continued, glyphs.ellipsis)  # rather than half a title
    title = fit_most(title, width - 2 - cell_len(note) - 1, glyphs.ellipsis)
    used = 2 + cell_len(title) + cell_len(note)
    rule = glyphs.rule * max(0, width - used - 1)
    return ((mark, "title"), (title, "title"), (note, "muted"), (" ", "plain"), (rule, "faint"))


def _told(state: ConsoleState, panel: PanelView, standing: ButtonView) -> str:
    """How an action stands; nothing where the title or the status line says it for all."""
    match standing.state:
        case ButtonState.READY | ButtonState.DONE:
            return ""
        case ButtonState.RUNNING:
            return "" if standing.left_us is None else time_left(standing.left_us)
        case ButtonState.HELD:
            return say("panels.waits", "waits {left}", left=time_left(standing.left_us or 0))
        case ButtonState.LOCKED if state.is_locked(panel) or state.is_of_others(panel):
            return ""
        case ButtonState.UNREACHABLE:
            if len(state.drivers) == 1:
                return ""
            return say("panels.no_driver", "no {driver}", driver=standing.note)
        case other:
            return word(_WORDS[other])


#: States in a word.
_WORDS = {
    ButtonState.QUEUED: Sentence("panels.queued", "queued"),
    ButtonState.SENT: Sentence("panels.sent", "sent"),
    ButtonState.WAITS: Sentence("panels.after_mode", "after mode"),
    ButtonState.LEFT_OUT: Sentence("panels.left_out", "left out"),
    ButtonState.FAILED: Sentence("panels.failed", "failed"),
    ButtonState.REFUSED: Sentence("panels.refused", "refused"),
    ButtonState.STOPPED: Sentence("panels.stopped", "stopped"),
    ButtonState.REPLACED: Sentence("panels.replaced", "replaced"),
    ButtonState.LOCKED: Sentence("panels.locked", "locked"),
}


class ActionPanels(Cells):
    """All panels in one widget; tab and page keys turn the pages."""

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 - Textual's name
        super().__init__(id=id)
        self.board = PanelSelection({})
        self._arranged: PanelLayout | None = None
        self._front: Sequence[PanelView] = ()
        self._phase = ""
        self._layouts: dict[tuple[int, int, int], PanelLayout] = {}

    def paint(self, state: ConsoleState, frame: PaintFrame) -> None:
        """Show the panels as they are now."""
        if not state.welcomed:
            text = say("panels.waiting", "Waiting for the robot process")
            text = f" {text}{frame.glyphs.ellipsis}"
            self.show([((fit(text, frame.width), "muted"),)])
        elif frame.width and frame.height:
            self.show(panel_rows(state, frame, self.arranged(state, frame), self.board))

    def arranged(self, state: ConsoleState, frame: PaintFrame) -> PanelLayout:
        """The arrangement for this size."""
        self._arranged = self._layout(state, frame.width, frame.height, frame.glyphs)
        return self._arranged

    def _layout(self, state: ConsoleState, width: int, height: int, glyphs: Glyphs) -> PanelLayout:
        """Made anew only where the file or the size has changed."""
        if state.front != self._front:
            self._front, self._layouts = state.front, {}
            phase = state.phase.name if state.phase is not None else ""
            if phase != self._phase:  # it has put others in front
                self._phase = phase
                self.board = replace(self.board, chosen=0, further=0)
        size = width, height, cap_width(state, self.board, glyphs)
        if size not in self._layouts:
            self._layouts[size] = arrange(state.front, *size)
        return self._layouts[size]

    @property
    def page(self) -> str:
        """Which page is shown; empty if there is only one."""
        arranged = self._arranged
        if arranged is None or arranged.pages < 2:
            return ""
        page = self.board.page(arranged) + 1
        return say("panels.page", "page {page}/{pages}", page=page, pages=arranged.pages)

    def needs(self, state: ConsoleState, glyphs: Glyphs) -> int:
        """Lines in which all panels find room on one page of this width, as far as they do."""
        found = self._layout(state, self.size.width, MOST, glyphs)
        return 1 + max((slot.row for slot in found.slots), default=0)

    def walk(self, state: ConsoleState, by: int) -> None:
        """Turn to the next page, or with a negative `by` to the one before; where there is one
        alone, choose the next panel.
        """
        if not state.front:
            return
        arranged = self._arranged
        if arranged is not None and arranged.pages > 1:
            page = (self.board.page(arranged) + by) % arranged.pages
            self.board = self.board.at(page, arranged)
        else:
            chosen = (self.board.chosen + by) % len(state.front)
            self.board = replace(self.board, chosen=chosen, further=0)

    def turn_to(self, action: str) -> None:
        """Turn to the page on which an action is, and choose its panel."""
        arranged = self._arranged
        if arranged is None:
            return
        for slot in arranged.slots:
            if slot.action is not None and slot.action.name == action:
                self.board = self.board.at(slot.page, arranged, slot.panel)

    def bear(self, caps: Mapping[str, KeyCap]) -> None:
        self.board = replace(self.board, caps=caps)

    def press(self, action: str) -> None:
        """Let an action's key cap light up; an empty name lets all go dark."""
        self.board = replace(self.board, pressed=action)
