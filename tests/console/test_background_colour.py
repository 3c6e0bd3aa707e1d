"""The terminal is asked for its ground: an escape stops, and no answer does, whenever it comes."""

from __future__ import annotations

import contextlib
import os
import pty
import termios
import threading
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.console.piloting import piloted_console
from woz_tui.console.drawing.theme import choose_appearance, save_theme, saved_theme
from woz_tui.console.input.background_colour import QUESTION, TerminalBackground, ask_background
from woz_tui.console.input.byte_scanner import Scanner
from woz_tui.console.input.escape_sequences import Key, StopToken, TerminalReply, Token

WHITE = b"\x1b]11;rgb:ffff/ffff/ffff\x1b\\"
BLACK = b"\x1b]11;rgb:00/00/00\x07"
#: What every terminal answers behind it: which terminal it is.
KIND = b"\x1b[?62;22c"
#: What a person may press meanwhile; no key begins like the rest of an answer.
TYPED = st.lists(st.sampled_from([b"\x1b", b"\x03", b"h", b" ", b"\x1b[A", b"\r"]), max_size=6)
ANSWERS = st.sampled_from([WHITE, BLACK, b"\x1b]11;rgb:12/ab\x07", b"\x1b]11;rgba:1/2/3/4\x1b\\"])
XTERM = {"TERM": "xterm-256color"}


def expecting() -> Scanner:
    scanner = Scanner()
    scanner.expects_background = True
    return scanner


def cut(data: bytes, cuts: list[int]) -> list[bytes]:
    places = [0, *sorted(min(each, len(data)) for each in cuts), len(data)]
    return [data[a:b] for a, b in pairwise(places)]


def stops(tokens: list[Token]) -> list[str]:
    return [token.source for token in tokens if isinstance(token, StopToken)]


@given(ANSWERS, st.lists(st.integers(0, 40)))
def test_an_answer_never_stops_however_it_is_split(answer: bytes, cuts: list[int]) -> None:
    scanner = expecting()
    tokens = [token for piece in cut(answer, cuts) for token in scanner.feed(piece)]
    assert [token.what for token in tokens if isinstance(token, TerminalReply)] == ["background"]
    assert len(tokens) == 1


@given(TYPED, ANSWERS, TYPED, st.lists(st.integers(0, 60)))
def test_every_escape_in_the_window_stops_and_no_answer_does(
    before: list[bytes], answer: bytes, after: list[bytes], cuts: list[int]
) -> None:
    """As pressed: each press is a read of its own at least."""
    scanner = expecting()
    tokens: list[Token] = []
    for press in before:
        tokens += scanner.feed(press)
        tokens += scanner.expire() if scanner.waiting is not None else []
    for piece in cut(answer, cuts):
        tokens += scanner.feed(piece)
    for press in after:
        tokens += scanner.feed(press)
        tokens += scanner.expire() if scanner.waiting is not None else []
    pressed = [press for press in (*before, *after) if press in (b"\x1b", b"\x03")]
    assert len(stops(tokens)) == len(pressed)
    assert any(isinstance(token, TerminalReply) and token.what == "background" for token in tokens)


@given(TYPED)
def test_an_escape_right_before_the_answer_stops(rest: list[bytes]) -> None:
    tokens = expecting().feed(b"\x1b" + WHITE + b"".join(rest))
    assert stops(tokens)[:1] == ["escape"]
    assert [token.what for token in tokens if isinstance(token, TerminalReply)][:1] == [
        "background"
    ]


@given(st.integers(len(b"\x1b]11;rgb"), len(WHITE) - 1))
def test_an_answer_that_breaks_off_is_no_stop(length: int) -> None:
    scanner = expecting()
    tokens = [*scanner.feed(WHITE[:length]), *scanner.expire(), *scanner.feed(b"h")]
    assert tokens[1:] == [Key("h", b"h", b"h")]
    assert not stops(tokens)


@pytest.mark.parametrize("data", [b"\x1b]", b"\x1b]h", b"\x1b]1", b"\x1b]10;", b"\x1b]11;rg\x1b"])
def test_what_is_no_answer_is_the_stop(data: bytes) -> None:
    scanner = expecting()
    tokens = [*scanner.feed(data), *scanner.close()]
    assert stops(tokens)[:1] == ["escape"]
    assert b"".join(token.raw for token in tokens) == data


def test_where_nothing_was_asked_it_is_a_stop_at_once() -> None:
    assert stops(Scanner().feed(b"\x1b]")) == ["escape"]


# -- in the window ---------------------------------------------------------------------------------


@contextlib.contextmanager
def terminal(*pieces: bytes) -> Iterator[int]:
    """A terminal that sends these once it was asked, or at once if its first piece is nothing."""
    master, slave = pty.openpty()

    def answer() -> None:
        asked = b""
        while QUESTION not in asked:
            asked += os.read(master, 100)
        for piece in pieces:
            os.write(master, piece)

    thread = threading.Thread(target=answer, daemon=True)
    thread.start()
    try:
        yield slave
    finally:
        thread.join(5)
        os.close(slave)
        os.close(master)


@pytest.mark.parametrize(
    ("pieces", "found"),
    [
        ((WHITE + KIND,), TerminalBackground(True)),
        ((BLACK, KIND), TerminalBackground(False)),
        ((b"h", b"\x1b", WHITE, KIND), TerminalBackground(True, ("escape",), ("h",))),
        ((WHITE[:9], WHITE[9:] + KIND), TerminalBackground(True)),
        ((b"\x03", BLACK + KIND), TerminalBackground(False, ("ctrl+c",))),
        ((KIND,), TerminalBackground()),
        ((b"h", b"\x03", KIND), TerminalBackground(None, ("ctrl+c",), ("h",))),
    ],
)
def test_the_window_is_over_with_the_answers(
    pieces: tuple[bytes, ...], found: TerminalBackground
) -> None:
    with terminal(*pieces) as tty:
        before = termios.tcgetattr(tty)
        assert ask_background(tty, tty, 3600.0) == found
        assert termios.tcgetattr(tty) == before


@pytest.mark.parametrize(
    ("pieces", "kept"), [((), ()), ((b"\x1b",), ("escape",)), ((b"hello",), ())]
)
def test_a_terminal_that_does_not_answer_is_not_waited_for(
    pieces: tuple[bytes, ...], kept: tuple[str, ...]
) -> None:
    with terminal(*pieces) as tty:
        assert ask_background(tty, tty, 4.0 if kept else 0.3).stops == kept


def test_what_is_no_terminal_is_not_asked(tmp_path: Path) -> None:
    with (tmp_path / "f").open("w+b") as file:
        assert ask_background(file.fileno(), file.fileno()) == TerminalBackground()
    assert (tmp_path / "f").read_bytes() == b""


# -- what is chosen --------------------------------------------------------------------------------


def test_the_ground_decides_where_nothing_else_does(tmp_path: Path) -> None:
    environ = {**XTERM, "XDG_CONFIG_HOME": str(tmp_path)}

    def never() -> bool:
        raise AssertionError("nobody is to be asked")

    assert choose_appearance(environ, "utf-8", light=lambda: True).theme == "woz-light"
    assert choose_appearance(environ, "utf-8", light=lambda: None).theme == "woz-dark"
    assert (
        choose_appearance({**environ, "COLORFGBG": "0;15"}, "utf-8", light=never).theme
        == "woz-light"
    )
    assert choose_appearance({**environ, "NO_COLOR": "1"}, "utf-8", light=never).theme == "woz-16"
    assert choose_appearance(environ, "utf-8", theme="light", light=never).theme == "woz-light"
    save_theme("light", environ)
    assert choose_appearance(environ, "utf-8", light=never).theme == "woz-light"
    assert choose_appearance({**environ, "TERM": "linux"}, "utf-8", light=never).theme == "woz-16"
    save_theme("", environ)
    assert saved_theme(environ) == ""


async def test_a_key_changes_the_colours_and_they_are_remembered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    async with piloted_console() as pilot:
        assert pilot.console.theme == "woz-dark"
        await pilot.press(pilot.console.key_of("theme"))
        assert pilot.console.theme == "woz-light"
        assert saved_theme(os.environ) == "light"
        await pilot.press(pilot.console.key_of("theme"))
        assert pilot.console.theme == "woz-16"


def test_a_folder_that_takes_no_file_is_no_reason_not_to_play(tmp_path: Path) -> None:
    (tmp_path / "f").touch()
    save_theme("light", {"XDG_CONFIG_HOME": str(tmp_path / "f")})
