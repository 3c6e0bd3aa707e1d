"""Where each panel and action stands: depends on the file and the screen's size, nothing else."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from rich.cells import cell_len

from woz_tui.protocol.panels import ActionView, PanelView

#: Cells of a column: below, labels suffer; above, the eye has too far to go.
NARROW, COMFORTABLE, BEST, WIDE = 18, 24, 32, 38
#: From this width on there is room for what is said beside the labels: columns are wider then.
ROOM_FOR_WORDS, BEST_WITH_WORDS, WIDE_WITH_WORDS = 100, 54, 74
#: Cells between two columns.
GUTTER = 1
#: Cells of a slot beside key cap and label: a blank, the state's glyph, a blank.
FIXED = 3


@dataclass(frozen=True, slots=True)
class Slot:
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
        for split in (False, True):
            for air in (1, 0):
                flow = _flow(panels, columns, height, air, split)
                if flow is None:
                    continue
                if flow.pages == 1:
                    flow = _balanced(panels, flow, columns, height, air=air, split=split)
                    if flow.used < columns:
                        continue
                short = _cut_short(panels, cells - cap - FIXED)
                far = abs(best - cells)
                cost = (flow.pages, short, flow.splits, -air, cells < COMFORTABLE, far)
                found = PanelLayout(
                    tuple(flow.slots), flow.pages, columns, cells, short, flow.splits
                )
                candidates.append((cost, found))
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
        moved = [replace(each, column=column, row=row + each.row) for each in flow.slots]
    else:
        page += 1
        moved = flow.slots
    slots = [replace(each, page=page + each.page, panel=number) for each in moved]
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


def _cut_short(panels: Sequence[PanelView], room: int) -> int:
    return sum(cell_len(action.label) > room for panel in panels for action in panel.actions)


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
