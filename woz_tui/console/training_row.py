"""The cue of a training, large, above the panels: what the visitor does, and the time left."""

from __future__ import annotations

from textual.geometry import Size

from woz_tui.console.cells import Cells, Row, clean, fit
from woz_tui.console.console_state import ConsoleState
from woz_tui.console.glyphs import PaintFrame
from woz_tui.console.study.study_view import verdict_text

#: Lines on a low screen, and on one of so many lines or more.
_LOW, _HIGH, _TALL = 3, 5, 32
_SORTS = {
    "approach": "A visitor comes.",
    "silence": "The visitor is silent.",
    "turn-away": "The visitor turns away.",
    "leave": "The visitor leaves.",
}


def cue_lines(size: Size, picture: ConsoleState) -> int:
    """Lines of the cue; none outside of a training."""
    training = picture.session.training
    if training is None or training.state != "runs":
        return 0
    return _HIGH if size.height >= _TALL else _LOW


class CueBoard(Cells):
    """The cue that waits; between two of them what became of the last one."""

    def paint(self, picture: ConsoleState, frame: PaintFrame) -> None:
        """Show it."""
        cue, last = picture.session.cue, picture.study.judged
        if cue is not None:
            given = cue.given
            text = f"\N{LEFT DOUBLE QUOTATION MARK}{given.text}\N{RIGHT DOUBLE QUOTATION MARK}"
            said = (text if given.text else _SORTS.get(given.sort, given.sort), "strong")
            left = max(0, given.t + given.window_us - frame.now)
            full = round(left / max(1, given.window_us) * (frame.width // 2))
            rows = [said, (frame.glyphs.bar * full, "run")]
        elif last is not None:
            rows = [verdict_text(last), ("", "plain")]
        else:
            rows = [("The first cue comes soon.", "muted"), ("", "plain")]
        above: list[Row] = [()] * max(0, (frame.height - len(rows)) // 2)
        self.show([*above, *(_centred(text, look, frame) for text, look in rows)])


def _centred(text: str, look: str, frame: PaintFrame) -> Row:
    shown = fit(frame.glyphs.plain(clean(text)), len(text), frame.glyphs.ellipsis)
    return (
        ((shown if len(shown) < frame.width else shown[: frame.width]).center(frame.width), look),
    )
