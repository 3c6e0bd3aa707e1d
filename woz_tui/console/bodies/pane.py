"""Draws bodies, small on the main screen or one alone: face, links from two sides, what they do.

How much of that is drawn follows from the room and from the bodies' outlines alone, so nothing
moves about while the robot does.
"""

from __future__ import annotations

from dataclasses import replace

from rich.cells import cell_len

from woz_tui.config.screen_language import say
from woz_tui.console.bodies.face_lights import brightness_look, frame_of, light_rows
from woz_tui.console.bodies.face_lights import size as face_size
from woz_tui.console.bodies.link_views import ABOVE, SIDE, draw_view, projections
from woz_tui.console.bodies.text import FORMATS, short_rows, table_rows, word_rows
from woz_tui.console.bodies.view import BodyView, body_views
from woz_tui.console.drawing.cells import Cells, Row, clean, cut_rows, fit
from woz_tui.console.drawing.glyphs import Glyphs, PaintFrame
from woz_tui.console.drawing.meter_rows import hidden_word, side_by_side
from woz_tui.console.state.console_state import ConsoleState

#: Cells that words beside a face need, and a view at the least (columns, lines).
WORDS, VIEW = 16, (10, 4)
#: Cells that the longer caption of a view needs.
CAPTION = 14
#: Cells between bodies.
GAP = 2
#: The narrowest place in which a body can be shown.
NARROWEST = 12


def pane_rows(state: ConsoleState, frame: PaintFrame) -> list[Row]:
    """All bodies side by side, as many as have room."""
    seen = body_views(state, frame.now, frame.glyphs)
    count = min(len(seen), max(1, (frame.width + GAP) // (NARROWEST + GAP)))
    if not count:
        return []
    width = (frame.width - GAP * (count - 1)) // count
    place = replace(frame, width=width)
    blocks = []
    for body in seen[:count]:
        lights = body.outline.face
        tight = lights is not None and face_size(*lights, compact=False)[0] == width
        indent = 0 if tight else 1
        inner = replace(place, width=width - indent, height=frame.height - 1)
        rows = [_title(body, place, len(seen) - count)]
        rows += [((" " * indent, "plain"), *row) for row in _arranged(body, inner)]
        blocks.append((rows, width))
    return cut_rows(side_by_side(blocks, frame.height, frame.glyphs, GAP), frame)


def _title(seen: BodyView, frame: PaintFrame, more: int) -> Row:
    title = f" {clean(seen.outline.title)} "
    others = f" +{more} " if more else ""
    old = f" {seen.old} " if seen.old and frame.width >= cell_len(title) + 14 else ""
    room = frame.width - cell_len(title) - cell_len(old) - cell_len(others)
    rule = frame.glyphs.rule * max(0, room)
    return ((title, "title"), (rule, "faint"), (others, "muted"), (old, "stale"))


def _arranged(seen: BodyView, frame: PaintFrame) -> list[Row]:
    """Large face and both views, or a compact face with one view beside or beneath it."""
    glyphs, width, height = frame.glyphs, frame.width, frame.height
    lights = seen.outline.face or (24, 16)
    columns, lines = face_size(*lights, compact=False)
    if width >= columns and height >= lines + 2 + 1 + VIEW[1]:
        rows = face_rows(seen, glyphs, compact=False)
        words = width - columns - GAP
        if words >= WORDS:
            described = word_rows(seen, glyphs, words, lines)
            rows = side_by_side([(rows, columns), (described, words)], lines, glyphs, GAP)
        else:
            rows += short_rows(seen, glyphs)
        return rows + view_rows(seen, glyphs, width, height - len(rows))
    columns, _ = face_size(*lights, compact=True)
    face = face_rows(seen, glyphs, compact=True)
    view = width - columns - WORDS - 2 * GAP
    if view >= VIEW[0]:
        side = _view_blocks(seen, {SIDE: (view, height)}, glyphs)[SIDE]
        words_beside = word_rows(seen, glyphs, WORDS, height)
        blocks = [(face, columns), (side, view), (words_beside, WORDS)]
        return side_by_side(blocks, height, glyphs, GAP)
    rows = [*face, *short_rows(seen, glyphs)]
    spare = height - len(rows)
    if spare >= VIEW[1] and width >= VIEW[0]:
        rows += _view_blocks(seen, {SIDE: (width, spare)}, glyphs)[SIDE]
    return rows


def face_rows(seen: BodyView, glyphs: Glyphs, *, compact: bool) -> list[Row]:
    """The face; a body without one has none, but keeps its place."""
    size = seen.outline.face
    if size is None:
        return []
    frame = frame_of(seen.face, *size)
    look = "stale" if seen.old else brightness_look(seen.face.brightness if seen.face else 1.0)
    rows = light_rows(frame, glyphs, look, compact=compact)
    if seen.face is None:
        columns, _ = face_size(*size, compact=compact)
        told = say("body.no_face", "no face yet")
        if "face" in seen.hidden:
            told = hidden_word()
        rows[len(rows) // 2] = ((fit(told.center(columns), columns, glyphs.ellipsis), "muted"),)
    return rows


def view_rows(seen: BodyView, glyphs: Glyphs, width: int, height: int) -> list[Row]:
    """A line of captions, beneath it the views from the side and from above."""
    lines = height - 1
    if lines < VIEW[1]:
        return []
    above = max(VIEW[0], (width - GAP) * 2 // 5)
    side = width - GAP - above
    drawn = _view_blocks(seen, {SIDE: (side, lines), ABOVE: (above, lines)}, glyphs)
    from_side, from_above = say("body.side", "side"), say("body.top", "top")
    if above >= CAPTION:
        from_side = say("body.side_front", "side, front")
        from_above = say("body.top_front", "top, front")
    captions: Row = (
        (fit(f"{from_side} {glyphs.next}", side + GAP, glyphs.ellipsis), "muted"),
        (fit(f"{from_above} {glyphs.up}", above, glyphs.ellipsis), "muted"),
    )
    return [
        captions,
        *side_by_side([(drawn[SIDE], side), (drawn[ABOVE], above)], lines, glyphs, GAP),
    ]


def _view_blocks(
    seen: BodyView, sizes: dict[str, tuple[int, int]], glyphs: Glyphs
) -> dict[str, list[Row]]:
    if "joints" in seen.hidden:
        hidden: dict[str, list[Row]] = {}
        for view, (width, height) in sizes.items():
            hidden[view] = [((" " * width, "plain"),)] * height
            hidden[view][height // 2] = ((fit(hidden_word().center(width), width), "muted"),)
        return hidden
    return {
        view: draw_view(seen.outline, seen.pose, sight, sizes[view]).rows(glyphs)
        for view, sight in projections(seen.outline, sizes).items()
    }


class BodyPane(Cells):
    """The bodies; takes no room in a session without one."""

    def paint(self, state: ConsoleState, frame: PaintFrame) -> None:
        """Show what they look like now."""
        if self.display:
            self.show(pane_rows(state, frame))


#: Cells of one column of the table, and lines of the picture at the least.
COLUMN, PICTURE = 24, 9


def full_rows(seen: BodyView, frame: PaintFrame) -> list[Row]:
    """As large as the frame: face and views beside each other, the face compact where it would
    take all the room; beneath them the table.
    """
    glyphs = frame.glyphs
    columns = max(1, frame.width // COLUMN)
    table = min(-(-len(FORMATS) // columns), max(0, frame.height - PICTURE - 2))
    lines = frame.height - table - 2
    lights = seen.outline.face
    if lights is None:
        picture = view_rows(seen, glyphs, frame.width, lines)
    else:
        wide, high = face_size(*lights, compact=False)
        compact = wide + GAP + 2 * VIEW[0] > frame.width or high > lines
        if compact:
            wide, _ = face_size(*lights, compact=True)
        face = face_rows(seen, glyphs, compact=compact)
        room = frame.width - wide - GAP
        views = view_rows(seen, glyphs, room, lines) if room >= 2 * VIEW[0] + GAP else []
        picture = side_by_side([(face, wide), (views, max(0, room))], lines, glyphs, GAP)
    title: Row = ((clean(seen.outline.driver), "title"), (f"  {seen.old}", "stale"))
    return cut_rows([title, *picture, (), *table_rows(seen, glyphs, frame.width, table)], frame)
