from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.config.keys.terminals import PLAIN, TMUX, merged_chords
from woz_tui.console.input.byte_scanner import LONE_ESC_S, PASTE_LIMIT, Scanner
from woz_tui.console.input.escape_sequences import (
    Key,
    KeyUp,
    Paste,
    Raw,
    StopToken,
    TerminalReply,
    Token,
)

PRESSES = {
    b"a": "a",
    b"A": "A",
    b"!": "!",
    "é".encode(): "é",
    "→".encode(): "→",
    b" ": "space",
    b"\t": "tab",
    b"\r": "enter",
    b"\x7f": "backspace",
    b"\x01": "ctrl+a",
    b"\x12": "ctrl+r",
    b"\x1a": "ctrl+z",
    b"\x1c": "ctrl+\\",
    b"\x1b[A": "up",
    b"\x1bOA": "up",
    b"\x1b[1;2A": "shift+up",
    b"\x1b[1;3D": "alt+left",
    b"\x1b[1;5C": "ctrl+right",
    b"\x1b[1;6C": "ctrl+shift+right",
    b"\x1b[1;7C": "ctrl+alt+right",
    b"\x1b[5A": "ctrl+up",
    b"\x1b[Z": "shift+tab",
    b"\x1b[3~": "delete",
    b"\x1b[5;5~": "ctrl+pageup",
    b"\x1bOP": "f1",
    b"\x1b[[A": "f1",
    b"\x1b[[E": "f5",
    b"\x1b[11~": "f1",
    b"\x1b[15~": "f5",
    b"\x1b[24;2~": "shift+f12",
    b"\x1b[1;2P": "shift+f1",
    b"\x1bO1;5P": "ctrl+f1",
    b"\x1b[1;5R": "ctrl+f3",
    b"\x1b[3$": "shift+delete",
    b"\x1b[3^": "ctrl+delete",
    b"\x1b[a": "shift+up",
    b"\x1bOa": "ctrl+up",
    b"\x1bOq": "1",
    # kitty
    b"\x1b[97u": "a",
    b"\x1b[97;;97u": "a",
    b"\x1b[97;2;65u": "A",
    b"\x1b[97;2u": "A",
    b"\x1b[97:65;2;65u": "A",
    b"\x1b[97;5u": "ctrl+a",
    b"\x1b[97;133u": "ctrl+a",
    b"\x1b[97;6u": "ctrl+shift+a",
    b"\x1b[97;3u": "alt+a",
    b"\x1b[49;5u": "ctrl+1",
    b"\x1b[49;2;33u": "!",
    b"\x1b[13u": "enter",
    b"\x1b[13;2u": "shift+enter",
    b"\x1b[32;2;32u": "shift+space",
    b"\x1b[9;5u": "ctrl+tab",
    b"\x1b[97;1:2u": "a",
    b"\x1b[1;1:2A": "up",
    b"\x1b[57400;;49u": "1",
    b"\x1b[57419u": "up",
    b"\x1b[233;;233u": "é",
    # xterm's modifyOtherKeys
    b"\x1b[27;5;49~": "ctrl+1",
    b"\x1b[27;2;65~": "A",
    b"\x1b[27;6;65~": "ctrl+shift+a",
    b"\x1b[27;2;13~": "shift+enter",
}
STOPS = [
    b"\x03",
    b"\x1b[27u",
    b"\x1b[27;5u",
    b"\x1b[27;1:1u",
    b"\x1b[27;129u",
    b"\x1b[99;5u",
    b"\x1b[99;69u",
    b"\x1b[99;6u",
    b"\x1b[99;5:2u",
    b"\x1b[1089::99;5u",
    b"\x1b[1089;5u",
    b"\x1b[27;5;99~",
    b"\x1b[27;1;27~",
]
OTHERS = [
    b"\x1b[?25u",
    b"\x1b[?62;22c",
    b"\x1b[?12;40R",
    b"\x1b[12;40R",
    b"\x1b[0n",
    b"\x1b[?2026;2$y",
    b"\x1b[<35;10;4M",
    b"\x1b[<0;10;4m",
    b"\x1b[M !!",
    b"\x1b[35;10;4M",
    b"\x1b[I",
    b"\x1b[O",
    b"\x1b[48;24;80;480;800t",
    b"\x1b[57441;2u",
    b"\x1b[97;1:3u",
    b"\x1b[>1;4000;30c",
    b"\x1b[99999999;5u",
    b"\x1b[0;;110000000u",
    b"\xff",
    b"\xc2\x9b",
    b"\xed\xa0\x80",
]
PASTES = [b"\x1b[200~hello\x1b[201~", b"\x1b[200~\x1b\x03 a\x1b[A\x1b[201~", b"\x1b[200~\x1b[201~"]


def scan(data: bytes) -> list[Token]:
    """All tokens of `data`, after which nothing more comes."""
    return scan_in(data, [len(data)])


def scan_in(data: bytes, cuts: list[int]) -> list[Token]:
    scanner = Scanner()
    tokens: list[Token] = []
    for start, end in itertools.pairwise([0, *sorted(cuts), len(data)]):
        tokens += scanner.feed(data[start:end])
    return tokens + scanner.close()


def stops(tokens: list[Token]) -> list[str]:
    return [token.source for token in tokens if isinstance(token, StopToken)]


def chords(tokens: list[Token]) -> list[str]:
    return [token.chord for token in tokens if isinstance(token, Key)]


# -- keys, replies, pastes ----------------------------------------------------------------------


@pytest.mark.parametrize(("data", "chord"), PRESSES.items())
def test_a_press_has_the_normal_form_of_its_chord(data: bytes, chord: str) -> None:
    (token,) = scan(data)

    assert isinstance(token, Key)
    assert token.chord == chord


@pytest.mark.parametrize("data", OTHERS)
def test_what_is_no_key_presses_nothing_and_stops_nothing(data: bytes) -> None:
    assert all(isinstance(token, TerminalReply | Raw | KeyUp) for token in scan(data))


def test_replies_carry_their_numbers() -> None:
    tokens = scan(b"\x1b[?25u\x1b[?62;22c\x1b[0n\x1b[12;40R")

    assert [(token.what, token.values) for token in tokens if isinstance(token, TerminalReply)] == [
        ("kitty", (25,)),
        ("attributes", (62, 22)),
        ("status", (0,)),
        ("position", (12, 40)),
    ]


def test_what_textual_cannot_read_is_rewritten_for_it() -> None:
    tokens = scan(b"\x1b[97:65;2:2;65u\x1b[27;6;65~\x1bO1;5P")

    assert [token.screen for token in tokens if isinstance(token, Key)] == [
        b"\x1b[97;2;65u",
        b"\x1b[65;6u",
        b"\x1b[1;5P",
    ]


def test_text_of_an_input_method_is_text_and_no_keys() -> None:
    (token,) = scan(b"\x1b[0;;20320:22909u")

    assert token == Paste("你好", b"\x1b[0;;20320:22909u")


def test_a_paste_is_text_whatever_stands_in_it() -> None:
    tokens = scan(b"x" + PASTES[1] + b"y")

    assert [type(token) for token in tokens] == [Key, Paste, Key]
    assert isinstance(tokens[1], Paste)
    assert tokens[1].text == "\x1b\x03 a\x1b[A"


def test_a_paste_without_measure_is_cut_off() -> None:
    (token,) = scan(b"\x1b[200~" + b"x" * (PASTE_LIMIT * 24) + b"\x1b[201~")

    assert isinstance(token, Paste)
    assert len(token.text) == PASTE_LIMIT
    assert len(token.raw) < PASTE_LIMIT * 20


# -- the stop -------------------------------------------------------------------------------------


@pytest.mark.parametrize("data", STOPS)
def test_each_stop_key_stops(data: bytes) -> None:
    scanner = Scanner()

    (token,) = scanner.feed(data)

    assert isinstance(token, StopToken)


def test_an_escape_at_the_end_of_a_read_waits_ten_milliseconds() -> None:
    scanner = Scanner()

    assert scanner.feed(b"a\x1b") == [Key("a", b"a", b"a")]
    assert scanner.waiting == LONE_ESC_S
    assert scanner.expire() == [StopToken("escape", b"\x1b")]
    assert scanner.waiting is None


def test_two_escapes_stop_before_anything_more_is_known() -> None:
    assert stops(Scanner().feed(b"\x1b\x1b")) == ["escape"]


def test_escape_before_an_escape_sequence_is_a_stop_and_the_key() -> None:
    tokens = scan(b"\x1b\x1b[A")

    assert stops(tokens) == ["escape"]
    assert chords(tokens) == ["up"]


#: After `ESC`, these cannot be told from the rest of an escape sequence at once.
AMBIGUOUS = {b"[", b"O"}


@pytest.mark.parametrize("key", [bytes((byte,)) for byte in range(0x20, 0x7F)])
def test_escape_and_a_character_in_one_read(key: bytes) -> None:
    scanner = Scanner()

    tokens = scanner.feed(b"\x1b" + key)
    if key in AMBIGUOUS:
        assert tokens == []
        tokens = scanner.expire()

    assert stops(tokens) == ["escape"]
    assert [token.raw for token in tokens if isinstance(token, Key)] == [key]


@pytest.mark.parametrize(("key", "chord"), PRESSES.items())
def test_escape_and_any_key_in_one_read(key: bytes, chord: str) -> None:
    tokens = scan(b"\x1b" + key)

    assert stops(tokens) == ["escape"]
    assert chords(tokens) == [chord]


@pytest.mark.parametrize("broken", [b"\x1b[\x1b", b"\x1b[1;\x03", b"\x1bO\x1b", b"\x1b[Mab\x1b"])
def test_a_sequence_that_breaks_off_is_a_stop(broken: bytes) -> None:
    assert stops(Scanner().feed(broken))[:1] == ["escape"]


def test_a_sequence_that_never_ends_is_a_stop() -> None:
    assert stops(scan(b"\x1b[" + b"1" * 3000)) == ["escape"]


def test_a_paste_that_stands_still_does_not_swallow_the_stop() -> None:
    for stop in (b"\x1b", b"\x03", b"\x1bx"):
        scanner = Scanner()
        assert scanner.feed(b"\x1b[200~cut off") == []
        assert scanner.expire() == []

        tokens = scanner.feed(stop)
        tokens += scanner.expire() if stop == b"\x1b" else []

        assert len(stops(tokens)) == 1, stop


def test_a_paste_in_two_halves_with_a_standstill_ends_where_it_ends() -> None:
    scanner = Scanner()
    tokens = scanner.feed(b"\x1b[200~one ")
    tokens += scanner.expire()
    tokens += scanner.feed(b"two\x1b")
    tokens += scanner.expire()
    tokens += scanner.feed(b"\x1b") + scanner.feed(b"[201~z")

    assert [token.text for token in tokens if isinstance(token, Paste)] == ["one two\x1b"]
    assert chords(tokens) == ["z"]
    assert stops(tokens) == []


def test_a_paste_without_end_is_over_after_a_while() -> None:
    scanner = Scanner()
    scanner.feed(b"\x1b[200~cut off")

    assert scanner.expire() == []
    assert scanner.expire() == [Paste("cut off", b"\x1b[200~cut off")]
    assert chords(scanner.feed(b"k")) == ["k"]


# -- properties -----------------------------------------------------------------------------------

pieces = st.one_of(
    st.sampled_from([*PRESSES, *STOPS, *OTHERS, *PASTES, b"\x1b", b"\x1b[", b"\x1bO", b"\xc3"]),
    st.binary(max_size=6),
)
streams = st.lists(pieces, max_size=12).map(b"".join)


@given(streams, st.lists(st.integers(0, 100), max_size=8))
def test_reads_may_be_cut_anywhere(data: bytes, cuts: list[int]) -> None:
    assert scan_in(data, [cut for cut in cuts if cut <= len(data)]) == scan(data)


@given(streams)
def test_no_byte_is_lost(data: bytes) -> None:
    assert b"".join(token.raw for token in scan(data)) == data


@given(st.lists(st.sampled_from([*PRESSES, *OTHERS, *PASTES]), max_size=8), st.integers(0, 8))
def test_a_stop_key_stops_between_all_others(around: list[bytes], at: int) -> None:
    for stop in (b"\x1b", *STOPS):
        tokens = scan(b"".join([*around[:at], stop, *around[at:]]))

        assert len(stops(tokens)) >= 1


@given(st.lists(st.sampled_from([*PRESSES, *OTHERS, *PASTES]), max_size=12))
def test_nothing_else_stops(stream: list[bytes]) -> None:
    wellformed = [piece for piece in stream if piece not in (b"\xff", b"\xed\xa0\x80")]

    assert stops(scan(b"".join(wellformed))) == []


@given(streams)
def test_bytes_after_their_silence_leave_nothing_waiting(data: bytes) -> None:
    scanner = Scanner()
    scanner.feed(data)
    for _ in range(len(data) + 3):
        scanner.expire()

    assert scanner.waiting is None


@pytest.mark.parametrize("sequence", [b"\x1b[1;3H", b"\x1b[1;3F", b"\x1b[57423;3u"])
def test_an_escape_folded_into_the_key_behind_it_is_a_stop(sequence: bytes) -> None:
    inside = Scanner(merged_chords(TMUX))

    assert inside.feed(sequence) == [StopToken("escape", sequence)]
    assert isinstance(Scanner(merged_chords(PLAIN)).feed(sequence)[0], Key)
    assert inside.feed(b"\x1b[1;3A") == [Key("alt+up", b"\x1b[1;3A", b"\x1b[1;3A")]


@pytest.mark.parametrize(
    ("data", "chord"),
    [
        (b"\x1b[97;1:3u", "a"),
        (b"\x1b[97:65;2:3u", "A"),
        (b"\x1b[1;3:3A", "alt+up"),
        (b"\x1b[57376;1:3u", "f13"),
        (b"\x1b[15;1:3~", "f5"),
    ],
)
def test_a_key_that_is_let_go_is_no_press(data: bytes, chord: str) -> None:
    assert scan(data) == [KeyUp(chord, data)]


@pytest.mark.parametrize("data", [b"\x1b[27;1:3u", b"\x1b[99;5:3u"])
def test_a_stop_key_that_is_let_go_is_no_second_stop(data: bytes) -> None:
    assert not [token for token in scan(data) if isinstance(token, StopToken | KeyUp)]
