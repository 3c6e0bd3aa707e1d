"""Sends the cells that changed and none before them.

Textual 8 knows exactly which cells of a line are to be painted, but writes that part of the line
from the left edge of its widget on. Over a slow line that is most of what a moving robot costs.

A screen beneath another one hands on what has changed, and takes the same for a new change of its
own: once it has been painted whole, it is painted whole for ever, and the dialog on top with it.
"""

from __future__ import annotations

from rich.console import Console, RenderableType  # noqa: TID251 - a type
from rich.control import Control
from textual._compositor import ChopsUpdate
from textual.screen import Screen, ScreenResultType


class CroppedUpdate(ChopsUpdate):
    """Spans of lines, cropped at both ends."""

    def render_segments(self, console: Console) -> str:
        """What a terminal gets: for each stretch of cells a move to it and the cells."""
        sent: list[str] = []
        for y, begin, end in self.spans:
            for until, (x, strip) in zip(self.chop_ends[y], self.chops[y].items(), strict=False):
                first, last = max(x, begin), min(until, end)
                if strip is None or first >= last:
                    continue
                part = strip if (first, last) == (x, until) else strip.crop(first - x, last - x)
                sent += (Control.move_to(first, y).segment.text, part.render(console))
        return "".join(sent)


def cropped(update: RenderableType | None) -> RenderableType | None:
    """The same update with fewer bytes, if it is one of single cells."""
    if type(update) is ChopsUpdate:
        return CroppedUpdate(update.chops, update.spans, update.chop_ends)
    return update


class PartialScreen(Screen[ScreenResultType]):
    """A screen that hands on a change once while another one lies over it, and paints what it is
    handed beside what its own widgets have to paint.
    """

    def _compositor_refresh(self) -> None:
        super()._compositor_refresh()
        if self is not self.app.screen:
            self._exchange_repaint_regions()
            self._repaint_required = False

    def _on_timer_update(self) -> None:
        if self._repaint_required:  # Textual would forget the widgets: as if all were painted
            self._repaint_required = False
            self._dirty_widgets.add(self)
        super()._on_timer_update()
