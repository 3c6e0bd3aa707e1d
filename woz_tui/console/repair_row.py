"""The row of moves that save a dialogue, above the script's line on every page."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.console.cells import Cells, Piece, Row, clean, cut, length
from woz_tui.console.console_state import ConsoleState
from woz_tui.console.glyphs import PaintFrame
from woz_tui.protocol.panels import ActionView


def repair_row(picture: ConsoleState, frame: PaintFrame, keys: Mapping[str, str]) -> Row:
    """Each repair with its key, in a replay alone; what is under way stands out."""
    found = [_repair(picture, frame, action, keys) for action in picture.settings.repairs]
    need = sum(map(length, found))
    apart = 3 if need + 3 * len(found) <= frame.width else 1
    row: Row = ((" ", "plain"),)
    for each in found:
        row += (*each, (" " * apart, "plain"))
    return cut(row, frame.width, frame.glyphs.ellipsis)


def _repair(
    picture: ConsoleState, frame: PaintFrame, action: ActionView, keys: Mapping[str, str]
) -> Row:
    key = keys.get(action.name, "")
    if picture.runs.of(action.name) is not None:
        mark, look = frame.glyphs.running, "run"
    elif picture.runs.failure_of(action.name) is not None:
        mark, look = frame.glyphs.failed, "bad"
    else:
        mark, look = " ", "muted"
    label: Piece = (f"{mark}{clean(action.label)}", look)
    if picture.replay is not None:  # no key plays anything there
        return (label,)
    return (key, "key") if key else ("no key", "faint"), label


class RepairRow(Cells):
    """One row."""

    #: Action -> its key, as a cap shows it; the app says so.
    keys: Mapping[str, str] = {}

    def paint(self, picture: ConsoleState, frame: PaintFrame) -> None:
        """Show it."""
        self.show([repair_row(picture, frame, self.keys)])
