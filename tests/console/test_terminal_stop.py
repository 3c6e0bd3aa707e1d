"""The stop on a real terminal: never lost, whatever is pressed with it or blocked behind it."""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.fakes.host import FakeHost, stops
from tests.fakes.terminal import FakeTerminal
from woz_tui.console.drawing.cells import clean_paste
from woz_tui.protocol.messages import Marker
from woz_tui.protocol.requests import AskAction, AskMarker, AskNote, AskStop, Beat

pytestmark = [pytest.mark.real_clock, pytest.mark.safety]

#: Bytes of keys -> the chord an experiment binds.
KEYS = {
    **{bytes((code,)): chr(code) for code in range(0x21, 0x7F) if chr(code) not in "[O<>:/.,?"},
    **{f"\x1bO{letter}".encode(): f"f{n}" for n, letter in enumerate("PQRS", 1)},
    b"\x1b[15~": "f5",
    b"\x1b[24~": "f12",
    b"\x1b[1;2P": "shift+f1",
    b"\x01": "ctrl+a",
    b"\x02": "ctrl+b",
    "é".encode(): "é",
    b"\x1b[3~": "delete",
    b"\x1b[5~": "pageup",
    # after these the stop takes a moment longer: they may begin an escape sequence
    b"[": "[",
    b"O": "O",
}


@pytest.fixture
def host(tmp_path: Path) -> Iterator[FakeHost]:
    keys = {chord: f"play {chord}" for chord in KEYS.values()}
    with FakeHost(tmp_path / "h.sock", keys=keys, verbs={"head": ["nudge"]}) as fake:
        yield fake


@pytest.fixture
def terminal(host: FakeHost) -> Iterator[FakeTerminal]:
    with started_terminal(host) as fake:
        yield fake


def started_terminal(host: FakeHost, answers: bool = True, kitty: bool = False) -> FakeTerminal:
    command = [sys.executable, "-m", "tests.console.small_app", str(host.path)]
    terminal = FakeTerminal(command, answers=answers, kitty=kitty)
    terminal.wait_text("ready")
    return terminal


def test_escape_alone_stops(host: FakeHost, terminal: FakeTerminal) -> None:
    terminal.send(b"\x1b")

    assert host.wait(AskStop).source == "key"
    terminal.wait_text("pressed:escape")


def test_ctrl_c_stops_and_does_not_quit(host: FakeHost, terminal: FakeTerminal) -> None:
    terminal.send(b"\x03")
    host.wait(AskStop)
    terminal.send(b"a")

    assert host.wait(AskAction).action == "play a"


def test_escape_right_before_any_key_stops_and_the_key_counts(
    host: FakeHost, terminal: FakeTerminal
) -> None:
    for count, (data, chord) in enumerate(KEYS.items(), 1):
        terminal.send(b"\x1b" + data)
        host.wait(AskStop, count)
        assert host.wait(AskAction, count).key == chord

    assert len(stops(host)) == len(KEYS)


def test_escape_stops_in_a_text_field_and_closes_it(host: FakeHost, terminal: FakeTerminal) -> None:
    terminal.send(b"/")
    terminal.wait_text("utterance")
    terminal.send(b"hello")
    terminal.wait_text("hello")
    terminal.send(b"\x1b")
    host.wait(AskStop)
    terminal.wait_text("pressed:escape")
    terminal.send(b"b")

    assert host.wait(AskAction).action == "play b"


def test_stop_and_keys_go_out_while_the_loop_is_blocked(
    host: FakeHost, terminal: FakeTerminal, tmp_path: Path
) -> None:
    host.say(Marker(text=f"block {tmp_path / 'go'}"))
    host.wait(AskNote)
    terminal.send(b"a")
    host.wait(AskAction)
    terminal.send(b"\x1b")
    host.wait(AskStop)
    (tmp_path / "go").touch()
    host.wait(AskNote, 2)

    order = [
        heard.request
        for heard in host.heard
        if isinstance(heard.request, AskNote | AskAction | AskStop)
    ]
    assert [getattr(request, "text", type(request).__name__) for request in order] == [
        "blocked",
        "AskAction",
        "AskStop",
        "unblocked",
    ]


def test_kitty_keys_and_stops(host: FakeHost) -> None:
    with started_terminal(host, kitty=True) as terminal:
        terminal.wait_text("terminal:kitty")
        for count, stop in enumerate((b"\x1b[27u", b"\x1b[99;5u", b"\x1b[27;5u"), 1):
            terminal.send(stop)
            host.wait(AskStop, count)
        terminal.send(b"\x1b[97;;97u")
        assert host.wait(AskAction).key == "a"
        terminal.send(b"\x1b[97;5u")
        assert host.wait(AskAction, 2).key == "ctrl+a"

        assert "screen:" not in terminal.text, "an answer of the terminal was taken for keys"


def test_a_terminal_without_answers_works_as_well(host: FakeHost) -> None:
    with started_terminal(host, answers=False) as terminal:
        terminal.send(b"a")
        host.wait(AskAction)
        terminal.send(b"\x1b")
        host.wait(AskStop)


def test_in_a_flood_of_keys_few_are_asked_for_and_none_delays_the_stop_behind_it(
    host: FakeHost, terminal: FakeTerminal
) -> None:
    """The reading thread has to go through all of them first; the screen must not, afterwards."""
    terminal.send(b"abcdefghijklmnopqrstuvwxyz \t" * 11_000 + b"\x1b")
    host.wait(AskStop)
    terminal.wait_text("pressed:escape")

    asked = host.all(AskAction)
    assert asked and all(each.stale for each in asked)
    assert len(asked) < 100


def test_a_flood_of_keys_goes_into_a_field_in_large_pieces(
    host: FakeHost, terminal: FakeTerminal
) -> None:
    terminal.send(b"/")
    terminal.wait_text("utterance")
    text = "two words " * 500
    terminal.send(f"{text}?")
    terminal.wait_for(lambda screen: "?" in screen)
    terminal.send("\x7f\r")

    assert host.wait(AskNote).text == f"said {text}"
    terminal.wait_text("pieces:")
    pieces = int(terminal.text.split("pieces:")[1].split()[0])
    assert pieces < 100, "each changes the field, and draws it"


def test_a_paste_plays_nothing(host: FakeHost, terminal: FakeTerminal) -> None:
    terminal.send(b"\x1b[200~ab\x1bcd\x1b[201~")
    terminal.send(b".")
    host.wait(AskMarker)

    assert host.all(AskAction) == []
    assert stops(host) == []


def test_a_paste_into_a_field_holds_nothing_that_a_terminal_obeys(
    host: FakeHost, terminal: FakeTerminal
) -> None:
    terminal.send(b"/")
    terminal.wait_text("utterance")
    terminal.send(b"\x1b[200~red \x1b[31m and\ttab\x1b[201~")
    terminal.send("\r")

    assert host.wait(AskNote).text == "said red  [31m and tab"


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("two\r\nlines\rthree\n", "two\nlines\nthree"),
        ("a\x1b[2Jb\x07\x9b0m", "a [2Jb  0m"),
        ("nul\0byte", "nulbyte"),
        ("\u202egnirts", " gnirts"),
        ("schöne Grüße 👋", "schöne Grüße 👋"),
    ],
)
def test_what_is_left_of_a_paste(text: str, kept: str) -> None:
    assert clean_paste(text) == kept


def test_keys_behind_a_key_that_opens_a_text_field_go_into_it(
    host: FakeHost, terminal: FakeTerminal, tmp_path: Path
) -> None:
    host.say(Marker(text=f"block {tmp_path / 'go'}"))
    host.wait(AskNote)
    for key in ("/", "a", "b"):
        terminal.send(key)
    (tmp_path / "go").touch()
    host.wait(AskNote, 2)
    terminal.send("\r")

    assert host.wait(AskNote, 3).text == "said ab"
    assert host.all(AskAction) == []


def test_a_burst_that_nobody_typed_is_listed_and_not_played(
    host: FakeHost, terminal: FakeTerminal
) -> None:
    terminal.send(b"1234567890")
    host.wait(AskAction, 10)

    assert all(action.stale for action in host.all(AskAction))
    terminal.wait_text("stale:0")
    host.wait(Beat, len(host.all(Beat)) + 2)  # half a second: what comes now is not its rest
    terminal.send(b"z")
    assert not host.wait(AskAction, 11).stale


def test_every_stop_of_a_burst_counts(host: FakeHost, terminal: FakeTerminal) -> None:
    terminal.send(b"".join(map(bytes, itertools.repeat(b"\x1b", 5))))
    host.wait(AskStop, 5)
