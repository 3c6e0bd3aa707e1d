"""Long rows in dialogs: where they are broken, and where they go on."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from tests.console.dialogs import open_dialog
from tests.console.piloting import piloted_console
from tests.console.scenes import NOW, played_action, welcome
from woz_tui.console.drawing.cells import Row, length, wrap_row

ROW: Row = (("  key     ", "strong"), ("what it does, and with many words", "plain"))


def text(rows: list[Row]) -> list[str]:
    return ["".join(piece for piece, _ in row).rstrip() for row in rows]


def test_a_long_row_goes_on_beneath_its_words() -> None:
    assert text(wrap_row(ROW, 10, 28)) == [
        "  key     what it does, and",
        "          with many words",
    ]
    assert [look for row in wrap_row(ROW, 10, 28) for _, look in row if look == "strong"]


def test_a_row_with_room_is_left_alone() -> None:
    assert wrap_row(ROW, 10, 43) == [ROW]
    assert text(wrap_row((*ROW, ("  ", "plain")), 10, 43)) == text([ROW]), "blanks need no room"
    assert wrap_row(ROW, 10, 19) == [ROW], "too narrow to indent anything"


@given(st.text("ab 中", max_size=60), st.integers(0, 8), st.integers(20, 40))
def test_no_word_is_lost_and_only_words_are_too_long(words: str, indent: int, width: int) -> None:
    rows = wrap_row(((words, "plain"),), indent, width)
    assert "".join(text(rows)).replace(" ", "") == words.replace(" ", "")
    for row in rows[:-1]:
        assert length(row) <= width or len(text([row])[0].split()) == 1


async def test_a_failures_reason_stays_beneath_its_beginning() -> None:
    reason = "silence and nothing else, " * 6
    async with piloted_console(welcome()) as pilot:
        await pilot.tell(*played_action("f", "Hello", NOW, 1, how="failed", reason=reason))
        await open_dialog(pilot, "FailuresDialog")
        place = pilot.console.screen.query_one("#report").region
        lines = pilot.drawn().splitlines()[place.y : place.bottom]
        drawn = [row[place.x : place.right] for row in lines]
        rows = [row for row in drawn if "silence" in row or "nothing" in row]
    assert len(rows) > 1
    assert {len(row) - len(row.lstrip()) for row in rows} == {9}
