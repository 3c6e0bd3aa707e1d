"""How many bytes pictures may cost on lines of all speeds; and kitty's sequences."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.console.camera import kitty
from woz_tui.console.camera.picture_requests import BUDGET, FILLS_S, MOST, RATE, PictureBudget

SECOND = 1_000_000


def sent_pictures(
    pace: PictureBudget, speed: float, wanted: int, seconds: float
) -> list[tuple[int, int, float]]:
    """Pictures over a line: when each began, what it cost, how long it filled the line."""
    now, sent = 0, []
    while now < seconds * SECOND:
        if not pace.due(now):
            now += 10_000
            continue
        cost = min(wanted, pace.allowance)
        took = cost / speed
        sent.append((now, cost, took))
        pace.requested(now)
        began, now = now, now + round(took * SECOND) + 1000
        pace.drawn(began, cost, round(took * SECOND))
    return sent


@given(st.floats(5_000, 1e8), st.integers(100, 400_000))
def test_no_line_is_filled_for_long_nor_for_more_than_half_of_the_time(
    speed: float, wanted: int
) -> None:
    sent = sent_pictures(PictureBudget(), speed, wanted, 20.0)
    first, rest = sent[0], sent[1:]
    assert first[2] <= 3_000 / speed + 0.01
    assert max(took for _, _, took in rest) <= FILLS_S * 4
    assert sum(took for _, _, took in rest[2:]) <= 0.5 * 20.0 + FILLS_S
    assert sum(cost for _, cost, _ in sent) <= BUDGET * 20 + MOST
    assert len(sent) <= RATE * 20 + 1


@pytest.mark.parametrize("speed", [10_000, 50_000, 150_000])
def test_a_slow_line_is_used_as_far_as_it_may(speed: int) -> None:
    sent = sent_pictures(PictureBudget(), speed, MOST, 30.0)
    assert sent[-1][2] == pytest.approx(FILLS_S, rel=0.05)
    assert sum(cost for _, cost, _ in sent) >= 0.4 * speed * 30


def test_a_fast_line_is_known_after_a_few_pictures() -> None:
    sent = sent_pictures(PictureBudget(), 1e9, 60_000, 2.0)
    assert [cost for _, cost, _ in sent][:4] == [3_000, 25_000, 60_000, 60_000]


def test_a_line_that_turns_slow_is_heard_of_at_once() -> None:
    pace = PictureBudget()
    sent_pictures(pace, 1e9, 60_000, 2.0)
    pace.drawn(10 * SECOND, 40_000, 2 * SECOND)
    assert pace.allowance == 20_000 * FILLS_S
    assert not pace.due(13 * SECOND)
    assert pace.due(14 * SECOND)


def test_small_pictures_tell_nothing_and_drawing_counts() -> None:
    pace = PictureBudget()
    before = pace.allowance
    pace.requested(0)
    assert not pace.due(200_000 - 1)
    pace.drawn(0, 500, 3 * SECOND)
    assert pace.allowance == before
    assert not pace.due(6 * SECOND - 1)
    pace.drawn(10 * SECOND, 0, 0, drawing_us=SECOND)
    assert not pace.due(12 * SECOND - 1)
    assert pace.due(12 * SECOND)


# -- kitty's sequences -----------------------------------------------------------------------------


@pytest.mark.parametrize("size", [0, 1, 4096, 4097, 20_000])
def test_a_picture_is_sent_in_pieces_that_make_it_whole(size: int) -> None:
    data = ("0123456789abcdef" * (size // 16 + 1))[:size]
    pieces = kitty.transmission(213, 40, 12, data).split("\x1b\\")
    assert pieces.pop() == ""
    heads, parts = zip(*(piece.removeprefix("\x1b_G").split(";") for piece in pieces), strict=True)
    assert "".join(parts) == data
    assert max(map(len, parts)) <= 4096
    assert heads[0].startswith("a=T,U=1,q=2,f=100,i=213,c=40,r=12,m=")
    more = [head.rpartition("m=")[2] for head in heads]
    assert more == ["1"] * (len(more) - 1) + ["0"]


def test_placeholders_count_their_rows_as_the_protocol_does() -> None:
    marks = kitty.row_marks()
    assert len(marks) == kitty.MOST_ROWS
    known = {0: 0x305, 1: 0x30D, 17: 0x363, 30: 0x483, 35: 0x592, 54: 0x610, 97: 0x747, 131: 0x954}
    assert {row: ord(marks[row]) for row in known} == known
    assert kitty.placeholders(2, 3) == "\U0010eeee\u030e\u0305\U0010eeee\U0010eeee"


def test_tmuxs_envelope() -> None:
    wrapped = kitty.tmux_passthrough(kitty.deletion(1, 2))
    one, two = "\x1b\x1b_Ga=d,d=I,i=1,q=2\x1b\x1b\\", "\x1b\x1b_Ga=d,d=I,i=2,q=2\x1b\x1b\\"
    assert wrapped == f"\x1bPtmux;{one}\x1b\\\x1bPtmux;{two}\x1b\\"
