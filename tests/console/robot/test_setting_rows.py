"""The rows of a robot's settings: as many and as wide as there is room, whatever is in them."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from woz_tui.console.drawing.cells import length
from woz_tui.console.drawing.glyphs import ASCII, UNICODE, PaintFrame
from woz_tui.console.robot_settings.rows import (
    ListPosition,
    list_room,
    row_of,
    scrolled,
    settings_rows,
)
from woz_tui.console.robot_settings.view import LineView, RobotView

signs = st.characters() | st.sampled_from(" 漢字コ́\n")
words = st.text(signs, max_size=40)
pieces = st.tuples(words, st.sampled_from(["plain", "warn", "bad"]))
lines = st.builds(
    LineView,
    section=st.sampled_from(["Robot", "Voice", "Eyes"]),
    label=words,
    value=words,
    color=st.sampled_from(["", "#00ff80"]),
    stale=st.booleans(),
    signs=st.lists(pieces, max_size=3).map(tuple),
    about=st.lists(pieces, max_size=3).map(tuple),
)
views = st.builds(
    RobotView,
    driver=words,
    state=pieces,
    count=words,
    conflicts=st.lists(st.text(signs, max_size=200), max_size=5).map(tuple),
    lines=st.lists(lines, max_size=40).map(tuple),
)


@given(views, st.integers(0, 120), st.integers(10, 60), st.integers(0, 50), st.booleans())
def test_rows_fill_their_room_and_no_more(
    view: RobotView, width: int, height: int, chosen: int, ascii_only: bool
) -> None:
    frame = PaintFrame(width, height, 0, ASCII if ascii_only else UNICODE)
    chosen = min(chosen, max(0, len(view.lines) - 1))
    top = scrolled(view.lines, chosen, 0, frame)
    rows = settings_rows(view, ListPosition(chosen, top, 0, 2), frame)
    assert len(rows) == height
    assert all(length(row) <= max(width, 12) for row in rows)


@given(st.lists(lines, min_size=1, max_size=40).map(tuple), st.data())
def test_what_is_chosen_is_seen_and_so_is_the_beginning(
    lines: tuple[LineView, ...], data: st.DataObject
) -> None:
    frame = PaintFrame(80, data.draw(st.integers(10, 40)), 0)
    top = 0
    for chosen in data.draw(st.lists(st.integers(0, len(lines) - 1), min_size=1, max_size=20)):
        top = scrolled(lines, chosen, top, frame)
        assert 0 <= row_of(lines, chosen) - top < list_room(frame)
    assert scrolled(lines, 0, top, frame) == 0
