"""Cells in which a colour of the robot can be shown as it is."""

from __future__ import annotations

from rich.color import Color
from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from woz_tui.console.cells import Cells
from woz_tui.console.robot_settings.setting_rows import SWATCH


class Swatches(Cells):
    """Rows whose pieces may have the look `swatch #rrggbb`: blanks on that colour."""

    def render_line(self, y: int) -> Strip:
        """One row, swatches in their colour."""
        base = self.get_component_rich_style("cells--plain")
        if y >= len(self.rows):
            return Strip.blank(self.size.width, base)
        segments = [Segment(text, self._style(look)) for text, look in self.rows[y] if text]
        return Strip(segments).adjust_cell_length(self.size.width, base)

    def _style(self, look: str) -> Style:
        if look.startswith(SWATCH):
            return Style(bgcolor=Color.parse(look.removeprefix(SWATCH)))
        return self.get_component_rich_style(f"cells--{look}")
