"""Draws small bars: the fill of a sign's queue, and the visitor's distance in Hall's zones."""

from __future__ import annotations

import math

from woz_tui.console.drawing.cells import Piece, Row
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.console.drawing.meter_rows import merge_pieces, track_cell
from woz_tui.protocol.messages import SignShown
from woz_tui.sensing.sample_values import ZONES

#: The far end of a ruler of distances, in metres.
FARTHEST = 4.8
#: The narrowest bar: one cell at each side of its tick.
LEAST = 3


def queue_bar(sign: SignShown, width: int, glyphs: Glyphs, look: str = "good") -> Row:
    """The places that speak for the sign, and a tick behind the one that decides.

    Exactly `width` cells. Filled up to the tick or beyond means yes, and only then.
    """
    if width < LEAST:
        return ((" " * max(0, width), "plain"),)
    if sign.places <= 0:
        return ((glyphs.track * width, "faint"),)
    room = width - 1
    places = max(1, sign.places)
    needed = min(places, max(0, sign.needed))
    count = min(places, max(0, sign.count))
    before = round(needed / places * room)
    if 0 < needed < places:
        before = min(room - 1, max(1, before))
    after = room - before
    full = before if count >= needed else math.floor(count / needed * before)
    beyond = math.floor((count - needed) / (places - needed) * after) if count > needed else 0
    if count < needed:
        full = min(full, before - 1)
    reached = count >= needed
    row: list[Piece] = [
        *((glyphs.bar, look if reached else "muted") for _ in range(full)),
        *((glyphs.track, "faint") for _ in range(before - full)),
        (glyphs.tick, "strong"),
        *((glyphs.bar, look) for _ in range(beyond)),
        *((glyphs.track, "faint") for _ in range(after - beyond)),
    ]
    return merge_pieces(row)


def distance_bar(
    metres: float | None, social: float, width: int, glyphs: Glyphs, *, stale: bool = False
) -> Row:
    """Hall's spaces with ticks between them; as far as the robot talks (S_d) the line is solid."""
    near = track_cell(social / FARTHEST, width) if math.isfinite(social) else 0
    ticks = {track_cell(limit / FARTHEST, width) for limit, _ in ZONES}
    cells: list[Piece] = []
    for x in range(width):
        if x in ticks:
            cells.append((glyphs.tick, "muted" if x <= near else "faint"))
        elif x <= near:
            cells.append((glyphs.rule, "muted"))
        else:
            cells.append((glyphs.track, "faint"))
    if metres is not None and not math.isnan(metres):
        cells[track_cell(metres / FARTHEST, width)] = (glyphs.spot, "stale" if stale else "strong")
    return merge_pieces(cells)
