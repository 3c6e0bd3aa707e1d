"""One body as large as there is room: face, links from two sides, the table of its values."""

from __future__ import annotations

from woz_tui.console.bodies.bodies_pane import GAP, VIEW, face_rows, view_rows
from woz_tui.console.bodies.body_text import FORMATS, table_rows
from woz_tui.console.bodies.body_view import BodyView
from woz_tui.console.bodies.face_lights import size as face_size
from woz_tui.console.cells import Row, clean, cut
from woz_tui.console.glyphs import PaintFrame
from woz_tui.console.meter_rows import side_by_side

#: Cells of one column of the table, and lines of the picture at the least.
COLUMN, PICTURE = 24, 9


def full_rows(seen: BodyView, frame: PaintFrame) -> list[Row]:
    """As large as the frame."""
    columns = max(1, frame.width // COLUMN)
    table = min(-(-len(FORMATS) // columns), max(0, frame.height - PICTURE - 2))
    picture = frame.height - table - 2
    title: Row = ((clean(seen.outline.driver), "title"), (f"  {seen.old}", "stale"))
    rows = [title, *_picture(seen, frame, picture), ()]
    rows += table_rows(seen, frame.glyphs, frame.width, table)
    return [cut(row, frame.width, frame.glyphs.ellipsis) for row in rows[: frame.height]]


def _picture(seen: BodyView, frame: PaintFrame, lines: int) -> list[Row]:
    """Face and views beside each other, the face compact where it would take all the room."""
    lights = seen.outline.face
    if lights is None:
        return view_rows(seen, frame.glyphs, frame.width, lines)
    compact = True
    columns, high = face_size(*lights, compact=False)
    if columns + GAP + 2 * VIEW[0] <= frame.width and high <= lines:
        compact = False
    else:
        columns, _ = face_size(*lights, compact=True)
    face = face_rows(seen, frame.glyphs, compact=compact)
    room = frame.width - columns - GAP
    views = view_rows(seen, frame.glyphs, room, lines) if room >= 2 * VIEW[0] + GAP else []
    return side_by_side([(face, columns), (views, max(0, room))], lines, frame.glyphs, GAP)
