from __future__ import annotations

import itertools
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console
from rich.segment import Segment
from rich.style import Style
from textual._compositor import ChopsUpdate
from textual.strip import Strip

from tests.console import bodies
from tests.console.piloting import piloted_console
from woz_tui.console.drawing.cells import Cells, Row, differences, length
from woz_tui.console.drawing.partial_update import cropped

WIDTH, HEIGHT = 24, 3
_MOVE = re.compile(r"\x1b\[(?P<line>\d+);(?P<column>\d+)H|\x1b\[[\d;]*m|(?P<text>[^\x1b]+)")
TEXTS = st.lists(st.text("ab ●█⣿", min_size=WIDTH, max_size=WIDTH), min_size=3, max_size=3)
CUTS = st.lists(st.integers(1, WIDTH - 1), max_size=3, unique=True).map(sorted)
SPANS = st.lists(
    st.tuples(st.integers(0, HEIGHT - 1), st.integers(0, WIDTH - 1), st.integers(1, WIDTH)).filter(
        lambda span: span[1] < span[2]
    ),
    min_size=1,
    max_size=5,
).map(sorted)


def update(texts: list[str], cuts: list[int], spans: list[tuple[int, int, int]]) -> ChopsUpdate:
    """Lines cut into parts as widgets side by side cut them."""
    edges = [0, *cuts, WIDTH]
    chops = [
        {a: Strip([Segment(text[a:b], Style(bold=True))]) for a, b in itertools.pairwise(edges)}
        for text in texts
    ]
    return ChopsUpdate(chops, spans, [edges[1:]] * HEIGHT)


def terminal_screen(sent: str, before: list[str]) -> list[str]:
    """A terminal's screen afterwards."""
    screen = [list(line) for line in before]
    y = x = 0
    for found in _MOVE.finditer(sent):
        if found["line"]:
            y, x = int(found["line"]) - 1, int(found["column"]) - 1
        for sign in found["text"] or "":
            screen[y][x] = sign
            x += 1
    return ["".join(line) for line in screen]


@given(TEXTS, TEXTS, CUTS, SPANS)
def test_all_cells_that_changed_are_sent_and_no_others(
    before: list[str], after: list[str], cuts: list[int], spans: list[tuple[int, int, int]]
) -> None:
    made = cropped(update(after, cuts, spans))
    assert isinstance(made, ChopsUpdate)
    sent = made.render_segments(Console(force_terminal=True, color_system="truecolor"))
    wanted = [list(line) for line in before]
    for y, begin, end in spans:
        wanted[y][begin:end] = after[y][begin:end]
    assert terminal_screen(sent, before) == ["".join(line) for line in wanted]


def test_other_updates_go_through_as_they_are() -> None:
    assert cropped(None) is None
    assert cropped("text") == "text"


@given(st.text("ab ●⣿é", max_size=30), st.text("ab ●⣿é", max_size=30), st.booleans())
def test_the_regions_to_paint_are_all_that_differs(a: str, b: str, cut: bool) -> None:
    size = max(len(a), len(b))
    old: Row = ((a.ljust(size), "plain"),)
    new: Row = ((b.ljust(size), "plain"),)
    if cut:
        new = ((new[0][0][: size // 2], "plain"), (new[0][0][size // 2 :], "plain"))
    painted = {x for part in differences(old, new, 0, size) for x in range(part.x, part.right)}
    differs = {x for x in range(size) if a.ljust(size)[x] != b.ljust(size)[x]}
    assert differs <= painted
    if not differs:
        assert not painted


@pytest.mark.parametrize("wide", ["日本", "e\u0301", "👍"])
def test_letters_of_other_widths_are_painted_with_their_pieces(wide: str) -> None:
    old: Row = (("name ", "muted"), (f"{wide} a ", "plain"))
    new: Row = (("name ", "muted"), (f"{wide} b ", "plain"))
    (region,) = differences(old, new, 0, 40)
    assert region.x == 5
    assert region.right == length(new)


async def test_a_breath_repaints_few_cells() -> None:
    async with piloted_console(bodies.welcome(bodies.alive()), size=(160, 50)) as pilot:
        pane = pilot.console.query_one("BodyPane", Cells)
        rows = list(pane.rows)
        await pilot.tell(*bodies.joints({"middle": 64.0, "top": 54.0}, {}))
        after = list(pane.rows)
        painted = sum(
            region.width
            for y, (old, new) in enumerate(zip(rows, after, strict=True))
            for region in differences(old, new, y, 50)
            if old != new
        )
        assert 0 < painted < 80
