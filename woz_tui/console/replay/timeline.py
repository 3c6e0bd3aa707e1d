"""The two lowest lines of a replay: the session's bar of that moment, and the time line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from rich.cells import cell_len

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Piece, Row, cut, fit, length, spread
from woz_tui.console.drawing.glyphs import Glyphs, PaintFrame
from woz_tui.console.drawing.meter_rows import merge_pieces
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.replay import ReplayState, wall_time
from woz_tui.console.state.stop_confirmation import settled_row, stopped_words
from woz_tui.console.widgets.bottom_rows import (
    BarInfo,
    StopBar,
    hint_row,
    order_row,
    sentence_rows,
    upcoming,
)
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.text_cleaning import elapsed

#: The most important first: they share cells of the line. Sign and look.
SIGNS: Mapping[str, tuple[str, str]] = {
    "stop": ("stop", "bad"),
    "lost": ("error", "bad"),
    "mistake": ("warning", "warn"),
    "marker": ("marker", "run"),
    "code": ("marker", "strong"),
    "note": ("note", "plain"),
    "questionnaire": ("queued", "wait"),
    "trial": ("tick", "strong"),
    "phase": ("tick", "muted"),
    "break": ("tick", "muted"),
}
#: Cells of the line at least; below that it is left out.
LEAST = 8
#: What the key that lists the keys does.
KEYS = Sentence("replay.hint_keys", "keys")
#: Columns from which hints stand behind the line.
ROOMY = 140


def sign_of(sort: str, glyphs: Glyphs) -> Piece:
    """Glyph and look of a sort of place."""
    name, look = SIGNS.get(sort, ("info", "muted"))
    return str(getattr(glyphs, name)), look


def replay_rows(state: ConsoleState, frame: PaintFrame, bar: BarInfo) -> list[Row]:
    """As many rows as the frame has, two at least."""
    rows = [_session_row(state, frame, bar)]
    if frame.height > 2:
        rows += sentence_rows(state, replace(frame, height=frame.height - 2), upcoming(state))
    return [*rows, time_row(state, frame, bar.hints)]


def _session_row(state: ConsoleState, frame: PaintFrame, bar: BarInfo) -> Row:
    """A sentence for the viewer; else the stop as it was, with who had confirmed; else what came
    next, or what keys do.
    """
    glyphs, width = frame.glyphs, frame.width
    if bar.news.text:
        return ((fit(f" {glyphs.plain(bar.news.text)}", width, glyphs.ellipsis), bar.news.look),)
    stop = state.session.stop
    if stop is None:
        return order_row(state, frame) or cut(hint_row(bar.hints, width), width, glyphs.ellipsis)
    row: Row = ((f"{stopped_words(stop, state.others, glyphs)} ", "alarm"),)
    if stop.settled:
        row += settled_row(stop, state.short_names, glyphs, width - length(row))
    return cut((*row, (" " * width, "alarm-soft")), width, " ")


def time_row(
    state: ConsoleState, frame: PaintFrame, hints: tuple[tuple[str, str], ...] = ()
) -> Row:
    """Where the replay is: state, time, the line with its places, clock of then, speed."""
    replay, glyphs = state.replay, frame.glyphs
    if replay is None:
        reading = say("replay.reading", "reading the log")
        return ((fit(f" {reading}{glyphs.ellipsis}", frame.width), "muted"),)
    now = min(frame.now, replay.length_us) if replay.length_us else frame.now
    if replay.ended:
        plays: Piece = (f" {glyphs.stopped}  ", "muted")
    elif replay.paused:
        plays = (f" {glyphs.pause} ", "warn")
    else:
        plays = (f" {glyphs.running}  ", "run")
    whole = elapsed(replay.length_us)
    # As wide at the end as at the beginning, so that the line stands still.
    left: Row = (plays, (elapsed(now).rjust(cell_len(whole)), "strong"), (f" / {whole} ", "muted"))
    right: Row = ((" ", "plain"),)
    if clock := wall_time(state.settings, now):
        right += ((f"{clock:%H:%M:%S} UTC ", "plain"),)
    if replay.cut_us:
        cut_out = say("replay.cut", "{time} cut", time=elapsed(replay.cut_us))
        right += ((f"{cut_out} ", "wait"),)
    right += ((f"{f'{replay.rate:g}x':>5} ", "plain" if replay.rate == 1 else "strong"),)
    for key, does in [hint for hint in hints if hint[1] == word(KEYS)][:1]:
        right += ((key, "strong"), (f" {does} ", "muted"))
    if frame.width >= ROOMY:
        right += hint_row(hints[:4], frame.width // 3)
    room = frame.width - length(left) - length(right)
    if room < LEAST:
        return spread(left, right, frame.width, glyphs.ellipsis)
    return (*left, *line_pieces(replay, now, room, glyphs), *right)


def line_pieces(replay: ReplayState, now: int, width: int, glyphs: Glyphs) -> Row:
    """The line in `width` cells: what has been played, the rest, the places, where it is."""
    played = "=" if glyphs.ascii else glyphs.bar
    here = _cell(now, replay.length_us, width)
    cells: list[Piece] = [
        (played, "run") if x < here else (glyphs.rule, "faint") for x in range(width)
    ]
    order, sorts = list(SIGNS), dict[int, str]()
    for place in replay.places:
        if place.sort in SIGNS:
            x = _cell(place.t, replay.length_us, width)
            sorts[x] = min(place.sort, sorts.get(x, order[-1]), key=order.index)
    for x, sort in sorts.items():
        cells[x] = sign_of(sort, glyphs)
    cells[here] = (glyphs.spot, "strong")
    return merge_pieces(cells)


def _cell(t: int, length_us: int, width: int) -> int:
    if length_us <= 0:
        return 0
    return min(width - 1, max(0, t * (width - 1) // length_us))


class TimeBar(StopBar):
    """The bar over the whole width at the bottom of a replay."""

    def paint(self, state: ConsoleState, frame: PaintFrame, bar: BarInfo) -> None:
        """Show the stop or what came next then, and the time line."""
        self.show(replay_rows(state, frame, bar))
