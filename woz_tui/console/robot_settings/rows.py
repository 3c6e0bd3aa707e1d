"""Draws a robot's settings as rows of cells.

On top the robot and its conflicts, at the bottom what is known of the chosen line, between them as
many lines as fit. All three keep their places whatever the robot says.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from rich.cells import cell_len, chop_cells
from rich.color import Color
from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Cells, Piece, Row, clean, cut, fit, length, spread
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.robot_settings.view import LineView, RobotView

#: From this height on there is more room for sentences, above and below the lines.
TALL = 26
#: From this width on the columns are wider.
WIDE = 90
#: Rows for the conflicts and for what is known of the chosen line, in a low and in a tall frame.
_LOW, _HIGH = (3, 2), (4, 3)
#: Look of a swatch: this, and the colour behind it.
SWATCH = "swatch "


@dataclass(frozen=True, slots=True)
class ListPosition:
    """What is chosen, counted from 0 among the lines; the first row of the list that is shown;
    which of how many robots; whether the terminal shows colours.
    """

    chosen: int = 0
    top: int = 0
    robot: int = 0
    robots: int = 1
    colours: bool = True


def settings_rows(view: RobotView, place: ListPosition, frame: PaintFrame) -> list[Row]:
    """The whole screen: as many rows as the frame is high."""
    glyphs, lines = frame.glyphs, view.lines
    number_of = say(
        "settings.robot_of", "{robot} of {robots}", robot=place.robot + 1, robots=place.robots
    )
    which = f" {number_of}" if place.robots > 1 else ""
    state, look = view.state
    robot: Row = (
        (f" {clean(view.driver)}", "title"),
        (f"{which}  ", "muted"),
        (glyphs.plain(clean(state)), look),
    )
    count = f"  {glyphs.warning} {view.count} " if view.count else ""
    above, below = _sentences(frame)
    listed: list[Row] = []
    for number, line in enumerate(lines):
        if number == 0 or line.section != lines[number - 1].section:
            listed.append(((f" {clean(line.section)}", "title"),))
        listed.append(_line(line, number == place.chosen, place.colours, frame))
    room = list_room(frame)
    shown = listed[place.top : place.top + room]
    hidden = len(listed) - place.top - room
    sides = (
        say("settings.above", "{lines} above", lines=place.top) if place.top > 0 else "",
        say("settings.below", "{lines} below", lines=hidden) if hidden > 0 else "",
    )
    told = ", ".join(filter(None, sides))
    words = f" {told} " if told else ""
    rule = glyphs.rule * max(0, frame.width - len(words) - 1)
    about = lines[place.chosen].about if place.chosen < len(lines) else ()
    wrapped = [row for text, look in about for row in _wrapped(clean(text), look, frame)]
    return [
        spread(robot, ((count, "warn"),), frame.width, glyphs.ellipsis),
        *_conflicts(view, above, frame),
        *shown,
        *[()] * (room - len(shown)),
        ((rule, "faint"), (words, "muted"), (glyphs.rule, "faint")),
        *_cut_off(wrapped, below, frame),
    ]


def list_room(frame: PaintFrame) -> int:
    return max(1, frame.height - sum(_sentences(frame)) - 2)


def _sentences(frame: PaintFrame) -> tuple[int, int]:
    """Rows of sentences above and below the list."""
    return _HIGH if frame.height >= TALL else _LOW


def scrolled(lines: tuple[LineView, ...], chosen: int, top: int, frame: PaintFrame) -> int:
    """The list's first row such that the chosen line is seen, with its section's heading."""
    at = row_of(lines, chosen)
    first = at - 1 if chosen == 0 or lines[chosen - 1].section != lines[chosen].section else at
    room, count = list_room(frame), row_of(lines, len(lines) - 1) + 1 if lines else 0
    top = min(max(top, at - room + 1), first)
    return max(0, min(top, count - room))


def row_of(lines: tuple[LineView, ...], index: int) -> int:
    """Where a line stands in the list: every section has a heading before it."""
    sections = 0
    for number, line in enumerate(lines[: index + 1]):
        sections += number == 0 or line.section != lines[number - 1].section
    return index + sections


def _conflicts(view: RobotView, rows: int, frame: PaintFrame) -> list[Row]:
    """As many sentences as there is room for, and how many more there are."""
    sign = frame.glyphs.warning
    texts = [f"{sign} {frame.glyphs.plain(clean(text))}" for text in view.conflicts]
    for kept in range(len(texts), 0, -1):
        more = len(texts) - kept
        others = say("settings.and_more", "and {more} more", more=more)
        told = [*texts[:kept], *([f"{sign} {others}"] if more else [])]
        wrapped = [row for text in told for row in _wrapped(text, "warn", frame)]
        if len(wrapped) <= rows:
            return [*wrapped, *[()] * (rows - len(wrapped))]
    return _cut_off(_wrapped(" ".join(texts), "warn", frame), rows, frame)


def _line(line: LineView, chosen: bool, colours: bool, frame: PaintFrame) -> Row:
    """Its name, its value with the colour to go with it, its signs."""
    glyphs = frame.glyphs
    label, value = (26, 24) if frame.width >= WIDE else (20, 18)
    mark = f" {glyphs.here} " if chosen else "   "
    name = fit(glyphs.plain(line.label), label, glyphs.ellipsis)
    swatch: Row = ()
    if line.color and colours:
        swatch = (("    ", f"{SWATCH}{line.color}"), (" ", "plain"))
    shown = fit(line.value, value - length(swatch), glyphs.ellipsis)
    row: Row = (
        (mark + name, "fill" if chosen else "plain"),
        (" ", "plain"),
        *swatch,
        (shown, "stale" if line.stale else "muted" if line.fixed else "strong"),
        *((f" {glyphs.plain(clean(text))} ", look) for text, look in line.signs),
    )
    return cut(row, frame.width, glyphs.ellipsis)


def _wrapped(text: str, look: str, frame: PaintFrame) -> list[Row]:
    """Sentences in rows, by cells: a sign of Chinese takes two."""
    room = max(10, frame.width - 2)
    rows = [""]
    for part in (part for word in text.split() for part in chop_cells(word, room)):
        longer = f"{rows[-1]} {part}".strip()
        if cell_len(longer) <= room:
            rows[-1] = longer
        else:
            rows.append(part)
    return [((f" {row}", look),) for row in rows if row]


def _cut_off(rows: Iterable[Row], room: int, frame: PaintFrame) -> list[Row]:
    """`room` rows: what is beyond them is left out, and an ellipsis says so."""
    found = list(rows)
    kept = found[:room]
    if len(found) > room and kept:
        text, look = kept[-1][-1]
        last: Piece = (f"{text}{frame.glyphs.ellipsis}", look)
        kept[-1] = cut((*kept[-1][:-1], last), frame.width, frame.glyphs.ellipsis)
    return [*kept, *[()] * (room - len(kept))]


class Swatches(Cells):
    """Rows whose pieces may have the look `swatch #rrggbb`: blanks on that colour."""

    def render_line(self, y: int) -> Strip:
        """One row, swatches in their colour."""
        base = self.style_of("plain")
        if y >= len(self.rows):
            return Strip.blank(self.size.width, base)
        segments = [Segment(text, self._style(look)) for text, look in self.rows[y] if text]
        return Strip(segments).adjust_cell_length(self.size.width, base)

    def _style(self, look: str) -> Style:
        if look.startswith(SWATCH):
            return Style(bgcolor=Color.parse(look.removeprefix(SWATCH)))
        return self.style_of(look)
