"""Where the parts of the main screen stand: decided by its size and by the file, nothing else.

Narrow: panels above, meters and events side by side below. Wide: panels at the left, meters and
events at the right. Roomy: the same with the events under the panels, where their lines have room,
and the script with its words under the meters.
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
#: Lines of status and stop bar.
BARS = 4
#: Lines the events keep at least.
EVENTS = 10
#: The smallest screen with all parts, and the smallest with panels.
WHOLE, LEAST = Size(80, 24), Size(50, 12)


class Needs(NamedTuple):
    """Lines that panels and meters would like to have, headings included."""

    panels: int
    meters: int


def shape(screen: Size) -> str:
    """`narrow`, `wide` or `roomy`."""
    if screen.width < WIDE or screen.height < WHOLE.height:
        return "narrow"
    return "roomy" if screen.height >= ROOMY else "wide"


def upper(screen: Size, needs: Needs) -> int:
    """Lines of the upper row of parts; the lower row has the rest."""
    body = screen.height - BARS
    match shape(screen):
        case "narrow":
            return max(3, body - (TALL_SIDE if screen.height >= TALL else SIDE))
        case "wide":
            return max(3, min(needs.meters + 1, body * 3 // 5))
        case _:
            return max(3, min(max(needs.panels, needs.meters) + 1, body - EVENTS))


class Body(Container):
    """All between the status line and the stop bar."""

    _laid_out: tuple[str, int] | None = None

    def lay_out(self, screen: Size, needs: Needs) -> bool:
        """Give every part its place; says whether one has moved."""
        wanted = (shape(screen), upper(screen, needs))
        if wanted == self._laid_out:
            return False
        self._laid_out = wanted
        for name in ("narrow", "wide", "roomy"):
            self.set_class(name == wanted[0], f"-{name}")
        self.styles.grid_rows = f"{wanted[1]} 1fr"
        return True
