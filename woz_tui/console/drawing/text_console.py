"""Rich's console for texts of files and logs: they are shown as they are, never obeyed."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any

from rich.console import Console, ConsoleOptions, RenderableType  # noqa: TID251 - the one that is made of it
from rich.segment import Segment
from rich.text import Text

from woz_tui.system.terminal_size import LEAST_COLUMNS
from woz_tui.system.text_cleaning import clean_lines


class TextConsole(Console):
    """Prints without markup (`[bold]`), emoji codes (`:smile:`) and highlighting; looks are given
    as `style`. Nothing that a terminal would obey comes from a text.

    Args:
        page: Columns where no terminal and no COLUMNS say how many there are; None: Rich's 80.
        options: Rich's own.
    """

    def __init__(self, *, page: int | None = None, **options: Any) -> None:
        super().__init__(markup=False, emoji=False, highlight=False, **options)
        if page is not None and not self.is_terminal and "COLUMNS" not in os.environ:
            self.width = page
        self.width = max(self.width, LEAST_COLUMNS)

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """As Rich does, of cleaned texts: these before they are laid out, so that columns fit."""
        if isinstance(renderable, Text) and not renderable.plain.isprintable():
            renderable = renderable.copy()
            renderable.plain = clean_lines(renderable.plain)
        for segment in super().render(renderable, options):
            if segment.control or segment.text.isprintable():
                yield segment
            else:
                yield Segment(clean_lines(segment.text), segment.style)
