"""The terminal's answer to the question for pictures, and stops that look like its beginning."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.console.camera import kitty
from woz_tui.console.camera.picture_terminal import question
from woz_tui.console.input.byte_scanner import GRAPHICS, Scanner
from woz_tui.console.input.escape_sequences import Key, StopToken, TerminalReply, Token

YES = b"\x1b_Gi=31;OK\x1b\\"


def expecting() -> Scanner:
    scanner = Scanner()
    scanner.expects_graphics = True
    return scanner


def read(scanner: Scanner, *reads: bytes) -> list[Token]:
    return [token for data in reads for token in scanner.feed(data)]


@given(st.lists(st.integers(0, len(YES))))
def test_the_answer_however_it_is_split(cuts: list[int]) -> None:
    places = [0, *sorted(cuts), len(YES)]
    pieces = [YES[a:b] for a, b in pairwise(places)]
    assert read(expecting(), *pieces) == [TerminalReply("graphics", (1,), YES)]


def test_an_error_is_a_no() -> None:
    no = b"\x1b_Gi=31;EINVAL:no pictures here\x1b\\"
    assert read(expecting(), no, b"h") == [
        TerminalReply("graphics", (0,), no),
        Key("h", b"h", b"h"),
    ]


def test_the_question_has_the_number_of_the_answer() -> None:
    number = GRAPHICS.decode().removeprefix("\x1b_G").removesuffix(";")
    assert kitty.QUESTION.startswith(f"\x1b_G{number},")


@pytest.mark.parametrize(
    "data", [b"\x1b_", b"\x1b_h", b"\x1b_Gi=3", b"\x1b_Gi=31;OK\x03", b"\x1b_\x03"]
)
@pytest.mark.parametrize("expects", [True, False])
def test_escape_before_the_cameras_key_is_a_stop(data: bytes, expects: bool) -> None:
    scanner = expecting() if expects else Scanner()
    tokens = scanner.feed(data)
    assert scanner.waiting is None or scanner.waiting <= 1.0
    tokens += scanner.expire()
    assert isinstance(tokens[0], StopToken)
    assert b"".join(token.raw for token in tokens) == data


@pytest.mark.parametrize("data", [b"\x1b_h", b"\x1b_GO", b"\x1b_Gi=32", b"\x1b_Gi=31;O\x1bK"])
def test_what_cannot_be_the_answer_stops_at_once(data: bytes) -> None:
    tokens = expecting().feed(data)
    assert isinstance(tokens[0], StopToken)
    assert b"".join(token.raw for token in tokens) == data


@given(st.binary(max_size=30))
def test_nothing_is_lost_of_what_only_begins_like_it(rest: bytes) -> None:
    scanner = expecting()
    data = b"\x1b_Gi=31;" + rest
    tokens = scanner.feed(data)
    while scanner.waiting is not None:
        tokens += scanner.expire()
    tokens += scanner.close()
    assert b"".join(token.raw for token in tokens) == data
    whole = b"\x1b\\" in rest
    assert whole or isinstance(tokens[0], StopToken)


@pytest.mark.parametrize(
    ("environment", "asked"),
    [
        ({"TERM": "xterm-kitty"}, True),
        ({"TERM": "xterm-ghostty"}, True),
        ({"TERM": "xterm-kitty", "TMUX": "/tmp/tmux"}, False),
        ({"TERM": "xterm-256color"}, False),
        ({"TERM": "linux"}, False),
        ({}, False),
    ],
)
def test_only_terminals_are_asked_that_may_know(environment: dict[str, str], asked: bool) -> None:
    assert bool(question(environment)) == asked
