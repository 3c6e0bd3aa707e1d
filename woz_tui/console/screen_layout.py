"""Where the parts of the main screen stand: decided by its size and by the file, nothing else.

Narrow: panels above, meters and events side by side below. Wide: panels at the left, meters and
events at the right. Roomy: the same with the events under the panels, where their lines have room,
and the script with its words under the meters. Bodies stand with the meters: beside them where it
is narrow, under them elsewhere.
"""

from __future__ import annotations

from typing import NamedTuple

from textual.containers import Container
from textual.geometry import Size

#: From this width on meters and events stand beside the panels, in cells.
WIDE = 120
#: From this height on a wide screen is roomy, in lines.
ROOMY = 40
#: Lines of meters and events below the panels, on a low screen and on one of 32 lines or more.
SIDE, TALL_SIDE, TALL = 7, 12, 32
#: Lines of status, repairs and stop bar: without a script, and with its next sentence.
STATUS, REPAIRS, BAR, SCRIPT_BAR = 2, 1, 2, 4
#: Below this height the sentence gives way to panels, in lines.
SENTENCE_FROM = 18
#: Lines of bodies under the meters on a wide screen and on a roomy one; columns of each body, and
#: bodies at the most, beside the meters.
LOW_BODIES, BODIES, BODY_WIDTH, NARROW_BODIES = 6, 20, 14, 2
#: Lines the events keep at least.
EVENTS = 10
#: The smallest screen with all parts, and the smallest with panels.
FULL_SIZE, LEAST_SIZE = Size(80, 24), Size(50, 12)


class Needs(NamedTuple):
    """Lines that panels and meters would like to have, headings included; how many bodies; lines
    of the stop bar.
    """

    panels: int
    meters: int
    bodies: int = 0
    bar: int = BAR


def shape(screen: Size) -> str:
    """`narrow`, `wide` or `roomy`."""
    if screen.width < WIDE or screen.height < FULL_SIZE.height:
        return "narrow"
    return "roomy" if screen.height >= ROOMY else "wide"


def bar_lines(screen: Size, script: bool) -> int:
    """Lines of the stop bar."""
    return SCRIPT_BAR if script and screen.height >= SENTENCE_FROM else BAR


def upper_lines(screen: Size, needs: Needs) -> int:
    """Lines of the upper row of parts; the lower row has the rest."""
    body = screen.height - STATUS - REPAIRS - needs.bar
    match shape(screen):
        case "narrow":
            return max(3, body - (TALL_SIDE if screen.height >= TALL else SIDE))
        case "wide":
            return max(3, min(needs.meters + body_lines(screen, needs) + 1, body * 3 // 5))
        case _:
            side = needs.meters + body_lines(screen, needs)
            return max(3, min(max(needs.panels, side) + 1, body - EVENTS))


def body_lines(screen: Size, needs: Needs) -> int:
    """Lines of bodies under the meters."""
    if not needs.bodies:
        return 0
    return {"narrow": 0, "wide": LOW_BODIES, "roomy": BODIES}[shape(screen)]


def body_columns(screen: Size, needs: Needs) -> int:
    """Columns of bodies beside the meters."""
    if shape(screen) != "narrow":
        return 0
    return BODY_WIDTH * min(needs.bodies, NARROW_BODIES)


class SidePane(Container):
    """Meters and bodies."""

    def lay_out(self, lines: int, columns: int) -> None:
        """Give the bodies their place: lines under the meters, or columns beside them."""
        bodies = self.query_one("BodyPane")
        bodies.display = bool(lines or columns)
        self.set_class(bool(columns), "-beside")
        bodies.styles.height = lines or "100%"
        bodies.styles.width = columns or "100%"


class MainArea(Container):
    """All between the status line and the stop bar."""

    _laid_out: tuple[object, ...] | None = None

    def lay_out(self, screen: Size, needs: Needs) -> None:
        """Give every part its place."""
        below, beside = body_lines(screen, needs), body_columns(screen, needs)
        wanted = (shape(screen), upper_lines(screen, needs), below, beside and screen.width)
        if wanted == self._laid_out:
            return
        self._laid_out = wanted
        for name in ("narrow", "wide", "roomy"):
            self.set_class(name == wanted[0], f"-{name}")
        self.styles.grid_rows = f"{wanted[1]} 1fr"
        columns = f"{(screen.width + beside) // 2} 1fr" if beside else "1fr 1fr"
        self.styles.grid_columns = columns if wanted[0] == "narrow" else "1fr 50"
        self.query_one(SidePane).lay_out(below, beside)
