"""Draws the nine states and their edges, with the present state and the last edges marked."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from woz_tui.console.drawing.cells import Piece, Row
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.console.drawing.meter_rows import merge_pieces
from woz_tui.console.state.engagement_text import short_state

#: Cells of the drawing.
WIDTH, HEIGHT = 64, 5
#: Where each state's name begins: column, line.
PLACES = {
    "Wait": (1, 0),
    "PersonDetected": (12, 0),
    "EngagedWithUnknown": (30, 0),
    "Handshake": (50, 0),
    "RobotSpeaks": (1, 2),
    "EngagedWithKnown": (17, 2),
    "UserSpeaks": (9, 4),
    "RobotThinks": (27, 4),
    "RobotReplies": (47, 4),
}
#: The line between two states, cell by cell from the first to the second: column, line.
Cell = tuple[int, int]


def _across(line: int, begin: int, end: int) -> tuple[Cell, ...]:
    return tuple((x, line) for x in range(begin, end))


#: Each pair of states with an edge between them; the line stands for both directions.
LINES: dict[tuple[str, str], tuple[Cell, ...]] = {
    ("Wait", "PersonDetected"): _across(0, 8, 11),
    ("PersonDetected", "EngagedWithUnknown"): _across(0, 27, 29),
    ("EngagedWithUnknown", "Handshake"): _across(0, 47, 49),
    ("PersonDetected", "EngagedWithKnown"): ((18, 1),),
    ("EngagedWithUnknown", "EngagedWithKnown"): ((30, 1),),
    ("Handshake", "EngagedWithKnown"): ((54, 1), *((x, 2) for x in range(54, 31, -1))),
    ("EngagedWithKnown", "RobotSpeaks"): tuple((x, 2) for x in range(15, 13, -1)),
    ("EngagedWithKnown", "UserSpeaks"): ((18, 3),),
    ("EngagedWithKnown", "RobotThinks"): ((28, 3),),
    ("EngagedWithKnown", "RobotReplies"): ((30, 3), *_across(3, 31, 53)),
    ("UserSpeaks", "RobotThinks"): _across(4, 24, 26),
    ("RobotThinks", "RobotReplies"): _across(4, 44, 46),
}
#: Corners of those that turn: what stands there instead of a straight line.
_CORNERS = {(54, 2): "upper-left", (30, 3): "upper-right", (52, 3): "lower-left"}


#: Signs of a line: across, down, and its corners.
_Strokes = Mapping[str, str]


def _strokes(signs: str) -> _Strokes:
    return dict(
        zip(("across", "down", "upper-left", "upper-right", "lower-left"), signs, strict=True)
    )


_THIN, _THICK = _strokes("─│┘└┐"), _strokes("━┃┛┗┓")
_ASCII, _ASCII_THICK = _strokes("-|+++"), _strokes("=#+++")


def diagram(state: str, way: Sequence[tuple[str, str]], glyphs: Glyphs) -> list[Row]:
    """`HEIGHT` rows of `WIDTH` cells. `way`: the edges taken last, newest first, as pairs of
    states; the newest is thick and has an arrow, the one before is only lighter than the rest.
    """
    cells: dict[Cell, Piece] = {}
    for line in LINES.values():
        _draw(cells, line, _ASCII if glyphs.ascii else _THIN, "faint")
    for number, edge in reversed(list(enumerate(way[:3]))):
        line = line_of(*edge)
        if number:
            _draw(cells, line, _ASCII if glyphs.ascii else _THIN, "muted")
        else:
            _draw(cells, line, _ASCII_THICK if glyphs.ascii else _THICK, "run")
            _arrow(cells, edge, glyphs)
    been = {name for edge in way[:3] for name in edge}
    for name, (column, y) in PLACES.items():
        words, look = short_state(name), "plain" if name in been else "muted"
        x = column
        if name == state:
            x, words, look = column - 1, f"[{words}]", "fill"
        for offset, letter in enumerate(words):
            cells[x + offset, y] = (letter, look)
    return [
        merge_pieces([cells.get((x, y), (" ", "plain")) for x in range(WIDTH)])
        for y in range(HEIGHT)
    ]


def line_of(was: str, now: str) -> tuple[Cell, ...]:
    """The cells from one state to the other, in this order; none where there is no edge."""
    if (was, now) in LINES:
        return LINES[was, now]
    return tuple(reversed(LINES.get((now, was), ())))


def _draw(cells: dict[Cell, Piece], line: Iterable[Cell], strokes: _Strokes, look: str) -> None:
    told = set(line)
    for x, y in told:
        straight = "across" if y % 2 == 0 or {(x - 1, y), (x + 1, y)} & told else "down"
        cells[x, y] = (strokes[_CORNERS.get((x, y), straight)], look)


def _arrow(cells: dict[Cell, Piece], edge: tuple[str, str], glyphs: Glyphs) -> None:
    """The arrow at the end of the newest edge; a corner has none."""
    line = line_of(*edge)
    if not line or line[-1] in _CORNERS:
        return
    x, y = line[-1]
    if len(line) > 1:
        sign = "<>"[x > line[-2][0]] if glyphs.ascii else "←→"[x > line[-2][0]]
    else:
        below = PLACES[edge[1]][1] > y
        sign = "^v"[below] if glyphs.ascii else "↑↓"[below]
    cells[x, y] = (sign, "run")
