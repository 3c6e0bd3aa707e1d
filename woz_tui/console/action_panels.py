"""Panels of actions: for each its key, its label, how it stands, how long it still takes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from rich.cells import cell_len, set_cell_size

from woz_tui.console.cells import Cells, Piece, Row, clean, cut, fit, fit_most
from woz_tui.console.console_state import ConsoleState
from woz_tui.console.glyphs import Glyphs, PaintFrame
from woz_tui.console.key_caps import KeyCap, caption
from woz_tui.console.number_text import time_left
from woz_tui.console.panel_columns import GUTTER, PanelLayout, Slot, append_panel, lay_out
from woz_tui.console.sentence_rows import quotation
from woz_tui.console.view_models import ButtonState, ButtonView
from woz_tui.protocol.panels import PanelView
from woz_tui.session.typed_actions import PANEL as TYPED

#: Key caps are at least and at most this wide, with a blank at each side.
CAP_LEAST, CAP_MOST = 3, 8
#: Lines that panels get at most on a roomy screen, where events stand beneath them.
MOST = 32

#: Cells of what is said, beside its label, at the least.
SAID = 12

_LOOK = {
    ButtonState.READY: "plain",
    ButtonState.QUEUED: "wait",
    ButtonState.HELD: "wait",
    ButtonState.RUNNING: "run",
    ButtonState.DONE: "good",
    ButtonState.WAITS: "wait",
    ButtonState.FAILED: "bad",
    ButtonState.REFUSED: "warn",
    ButtonState.STOPPED: "warn",
    ButtonState.REPLACED: "warn",
    ButtonState.LOCKED: "muted",
    ButtonState.UNREACHABLE: "muted",
}


@dataclass(frozen=True, slots=True)
class PanelSelection:
    """What does not come from messages: key caps, the chosen panel, the key just pressed."""

    caps: Mapping[str, KeyCap]
    chosen: int = 0
    pressed: str = ""


def cap_width(picture: ConsoleState, board: PanelSelection, glyphs: Glyphs) -> int:
    """One width for all key caps, so that labels stand in line."""
    longest = max(
        (
            cell_len(caption(board.caps.get(action.name, KeyCap(action.key)), glyphs))
            for panel in picture.panels
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
    picture: ConsoleState, frame: PaintFrame, arranged: PanelLayout, board: PanelSelection
) -> list[Row]:
    """The page with the chosen panel, as large as the frame."""
    page = arranged.page_of(board.chosen)
    cap = cap_width(picture, board, frame.glyphs)
    column_frame = replace(frame, width=arranged.width)
    grid: dict[tuple[int, int], Row] = {}
    for slot in arranged.slots:
        if slot.page == page:
            grid[slot.row, slot.column] = _slot(picture, slot, column_frame, board, cap)
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


def _slot(
    picture: ConsoleState, slot: Slot, frame: PaintFrame, board: PanelSelection, cap: int
) -> Row:
    panel = picture.front[slot.panel]
    if slot.action is None:
        return _title(picture, slot, frame, slot.panel == board.chosen)
    standing = picture.standing(panel, slot.action, frame.now)
    dim = picture.stop is not None or bool(picture.lost)
    look = "muted" if dim and standing.state is ButtonState.READY else _LOOK[standing.state]
    key = caption(board.caps.get(slot.action.name, KeyCap(slot.action.key)), frame.glyphs)
    keylook = "flash" if board.pressed == slot.action.name else "key" if key else "plain"
    word = "" if _said_above(picture, panel, standing.state) else _word(standing)
    said = quotation(picture.words_on(slot.action.name, standing), frame.glyphs)
    room = frame.width - cap - 1
    texts = clean(slot.action.label), said
    body = _body(texts, standing, (word, look), room, frame.glyphs)
    return ((_centred(key, cap, frame.glyphs.ellipsis), keylook), (" ", "plain"), *body)


def _said_above(picture: ConsoleState, panel: PanelView, state: ButtonState) -> bool:
    """Whether the title or the status line has the word that would stand on every line here."""
    if state is ButtonState.LOCKED:
        return picture.is_locked(panel)
    return state is ButtonState.UNREACHABLE and len(picture.drivers) == 1


def _title(picture: ConsoleState, slot: Slot, frame: PaintFrame, chosen: bool) -> Row:
    panel = picture.front[slot.panel]
    glyphs, width = frame.glyphs, frame.width
    mark = f"{glyphs.here} " if chosen and not slot.again else "  "
    note = " locked" if picture.is_locked(panel) else " continued" if slot.again else ""
    if slot.again and cell_len(clean(panel.title)) > width - 3 - len(note):
        note = note.replace("continued", glyphs.ellipsis)  # rather than half a title
    title = fit_most(panel.title, width - 2 - len(note) - 1, glyphs.ellipsis)
    used = 2 + cell_len(title) + len(note)
    rule = glyphs.rule * max(0, width - used - 1)
    return ((mark, "title"), (title, "title"), (note, "muted"), (" ", "plain"), (rule, "faint"))


def _centred(text: str, width: int, ellipsis: str) -> str:
    text = fit_most(text, width - 1, ellipsis)
    before = (width - cell_len(text)) // 2
    return " " * before + text + " " * (width - before - cell_len(text))


def _body(
    texts: tuple[str, str], standing: ButtonView, how: Piece, room: int, glyphs: Glyphs
) -> tuple[Piece, ...]:
    """Glyph, label, what is said where there is room, and word; while it runs, the ground behind
    them is the time left.
    """
    (label, said), (word, look) = texts, how
    glyph = (
        " " if standing.state is ButtonState.READY else str(getattr(glyphs, standing.state.value))
    )
    spare = room - 2 - cell_len(label)
    timed = standing.state in (ButtonState.RUNNING, ButtonState.HELD)
    shown = f" {word} " if word else " "
    if not (word if timed else spare > cell_len(word) + 1):
        shown = ""
    left_over = room - 4 - cell_len(label) - cell_len(shown)
    beside = f"  {fit(said, left_over, glyphs.ellipsis)}" if said and left_over >= SAID else ""
    width = room - 2 - cell_len(shown) - cell_len(beside)
    front = f"{glyph} {fit(label, width, glyphs.ellipsis)}"
    if not timed or standing.share is None:
        return ((front, look), (beside, "muted"), (shown, look))
    text = f"{front}{beside}{shown}"
    filled = round((1 - standing.share) * room)
    front = set_cell_size(text, filled)
    return ((front, "fill"), (set_cell_size(text[len(front) :], room - filled), look))


def _word(standing: ButtonView) -> str:
    match standing.state:
        case ButtonState.READY | ButtonState.DONE:
            return ""
        case ButtonState.RUNNING:
            return "" if standing.left_us is None else time_left(standing.left_us)
        case ButtonState.HELD:
            return f"waits {time_left(standing.left_us or 0)}"
        case ButtonState.WAITS:
            return "after mode"
        case ButtonState.UNREACHABLE:
            return f"no {standing.note}"
        case state:
            return str(state.value)


class ActionPanels(Cells):
    """All panels in one widget; tab and page keys turn the pages."""

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 - Textual's name
        super().__init__(id=id)
        self.board = PanelSelection({})
        self._arranged: PanelLayout | None = None
        self._arranged_for: tuple[object, ...] = ()
        self._needed = 1
        self._needed_for: tuple[object, ...] = ()

    def paint(self, picture: ConsoleState, frame: PaintFrame) -> None:
        """Show the picture's panels as they stand."""
        if not picture.welcomed:
            text = f" Waiting for the robot process{frame.glyphs.ellipsis}"
            self.show([((fit(text, frame.width), "muted"),)])
        elif frame.width and frame.height:
            self.show(panel_rows(picture, frame, self.arranged(picture, frame), self.board))

    def arranged(self, picture: ConsoleState, frame: PaintFrame) -> PanelLayout:
        """The arrangement, made anew only when the file or the size has changed."""
        cap = cap_width(picture, self.board, frame.glyphs)
        wanted = (picture.front, frame.width, frame.height, cap)
        if self._arranged is None or wanted != self._arranged_for:
            self._arranged_for = wanted
            self._arranged = arrange(picture.front, frame.width, frame.height, cap)
        return self._arranged

    @property
    def page(self) -> str:
        """Which page is shown; empty if there is only one."""
        arranged = self._arranged
        if arranged is None or arranged.pages < 2:
            return ""
        return f"page {arranged.page_of(self.board.chosen) + 1}/{arranged.pages}"

    def needs(self, picture: ConsoleState, glyphs: Glyphs) -> int:
        """Lines in which all panels find room on one page of this width, as far as they do."""
        wanted = (picture.front, self.size.width, MOST, cap_width(picture, self.board, glyphs))
        if wanted != self._needed_for:
            self._needed_for = wanted
            found = arrange(picture.front, *wanted[1:])
            self._needed = 1 + max((slot.row for slot in found.slots), default=0)
        return self._needed

    def walk(self, picture: ConsoleState, by: int) -> None:
        """Turn to the next page, or with a negative `by` to the one before; where there is one
        alone, choose the next panel.
        """
        if not picture.front:
            return
        firsts = self._firsts(len(picture.front))
        if len(firsts) > 1 and self._arranged is not None:
            pages = list(firsts)
            at = pages.index(self._arranged.page_of(self.board.chosen))
            chosen = firsts[pages[(at + by) % len(pages)]]
        else:
            chosen = (self.board.chosen + by) % len(picture.front)
        self.board = replace(self.board, chosen=chosen)

    def _firsts(self, panels: int) -> dict[int, int]:
        """Page -> the first panel that begins on it."""
        arranged, found = self._arranged, dict[int, int]()
        if arranged is not None:
            for panel in range(panels):
                found.setdefault(arranged.page_of(panel), panel)
        return found

    def turn_to(self, picture: ConsoleState, action: str) -> None:
        """Choose the panel on which an action is."""
        for index, panel in enumerate(picture.front):
            if any(each.name == action for each in panel.actions):
                self.board = replace(self.board, chosen=index)

    def bear(self, caps: Mapping[str, KeyCap]) -> None:
        """Show these key caps."""
        chosen = self.board.chosen if self.board.caps else 0
        self.board = PanelSelection(caps, chosen)

    def press(self, action: str) -> None:
        """Let an action's key cap light up; an empty name lets all go dark."""
        self.board = replace(self.board, pressed=action)
