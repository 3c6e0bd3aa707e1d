"""Keys as people write them, and what terminals make of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.config import keys
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.keys import (
    KITTY,
    LAYOUTS,
    LINUX,
    PLAIN,
    SCREEN,
    TMUX,
    KeyNameError,
    KeyOutcome,
    Terminal,
    deliver,
    from_textual,
    normal_key,
)
from woz_tui.config.keys.chords import NAMED
from woz_tui.config.keys.keymap_file import load_keymap
from woz_tui.console.input.byte_scanner import Scanner
from woz_tui.console.input.escape_sequences import Key


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        *[(key, key) for key in ("a", "A", "1", "!", "é", "+", "-", "^", "#")],
        *[(text, "ctrl+a") for text in ("ctrl+a", "Ctrl-A", "CTRL+a", "^A", "^a", "C-a", "Strg+A")],
        *[(text, "escape") for text in ("esc", "Escape", "ESC")],
        *[(text, "enter") for text in ("Return", "enter", "CR")],
        *[(text, "pageup") for text in ("PgUp", "page up", "page_up", "Page-Up")],
        *[(text, "space") for text in ("space", "Spacebar", " ")],
        *[(text, "f1") for text in ("F1", "f1")],
        *[(text, "!") for text in ("shift+1", "Shift-1", "exclamation_mark", "S-1")],
        *[(text, "A") for text in ("shift+a", "Shift+A", "S-a")],
        (1, "1"),
        (["shift", 1], "!"),
        (["1", "shift"], "!"),
        (["ctrl", "shift", "a"], "ctrl+shift+a"),
        ("shift+ctrl+a", "ctrl+shift+a"),
        ("alt+ctrl+x", "ctrl+alt+x"),
        ("ctrl+!", "ctrl+shift+1"),
        ("ctrl++", "ctrl+shift+="),
        ("ctrl+plus", "ctrl+shift+="),
        ("ctrl+-", "ctrl+-"),
        ("ctrl--", "ctrl+-"),
        ("Ctrl+Space", "ctrl+space"),
        ("backtab", "shift+tab"),
        ("Shift+F10", "shift+f10"),
        ("c r", "c r"),
        ("ctrl+x  s", "ctrl+x s"),
        ("e\u0301", "é"),
    ],
)
def test_the_normal_form(written: Any, expected: str) -> None:
    assert normal_key(written) == expected


@pytest.mark.parametrize(
    ("layout", "expected"),
    [("us", "!@#"), ("gb", '!"£'), ("de", '!"§'), ("es", '!"·'), ("fr", "123")],
)
def test_shift_and_the_digits_of_each_keyboard(layout: str, expected: str) -> None:
    assert "".join(normal_key(f"shift+{digit}", layout) for digit in "123") == expected


def test_a_french_keyboard_gives_digits_with_shift() -> None:
    assert "".join(normal_key(f"shift+{key}", "fr") for key in "&é\"'(-è_çà") == "1234567890"
    assert normal_key("ctrl+1", "fr") == "ctrl+shift+&"


@pytest.mark.parametrize(
    "written",
    ["", "ctrl", "ctrl+", "shift", "spaec", "f0", "f25", "a b c", "ctrl a", "a+b", "super+a",
     [], ["a", "b"], ["shift"], None, True, 1.5, {"a": 1}, "\n", "\t", "a\x07", "\u0301"],
)  # fmt: skip
def test_what_is_no_key_is_refused_with_a_sentence(written: Any) -> None:
    with pytest.raises(KeyNameError) as caught:
        normal_key(written)
    assert len(str(caught.value)) > 10


modifiers = st.lists(st.sampled_from(["ctrl", "alt", "shift"]), max_size=3)
bases = st.one_of(st.sampled_from(NAMED), st.characters(exclude_categories=["C"]))
layouts = st.sampled_from(sorted(LAYOUTS))


@given(modifiers, bases, layouts)
def test_the_normal_form_of_a_normal_form_is_itself(
    held: list[str], base: str, layout: str
) -> None:
    try:
        chord = normal_key("+".join([*held, base]), layout)
    except KeyNameError:
        return
    assert normal_key(chord, layout) == chord


@given(st.text(max_size=12), layouts)
def test_any_text_is_a_key_or_a_key_name_error(text: str, layout: str) -> None:
    try:
        chord = normal_key(text, layout)
    except KeyNameError:
        return
    assert normal_key(chord, layout) == chord


@given(st.permutations(["ctrl", "shift", "q"]))
def test_the_order_of_a_list_does_not_matter(parts: list[str]) -> None:
    assert normal_key(parts) == "ctrl+shift+q"


# -- what a terminal sends: the table ------------------------------------------------------------

ARRIVES, SAME, STOP, NEVER = KeyOutcome.ARRIVES, KeyOutcome.SAME, KeyOutcome.STOP, KeyOutcome.NEVER


@pytest.mark.parametrize(
    ("chord", "verdict", "data", "arrives"),
    [
        ("a", ARRIVES, b"a", "a"),
        ("!", ARRIVES, b"!", "!"),
        ("f1", ARRIVES, b"\x1bOP", "f1"),
        ("f5", ARRIVES, b"\x1b[15~", "f5"),
        ("shift+f1", ARRIVES, b"\x1b[1;2P", "shift+f1"),
        ("ctrl+f5", ARRIVES, b"\x1b[15;5~", "ctrl+f5"),
        ("tab", ARRIVES, b"\t", "tab"),
        ("shift+tab", ARRIVES, b"\x1b[Z", "shift+tab"),
        ("up", ARRIVES, b"\x1b[A", "up"),
        ("shift+up", ARRIVES, b"\x1b[1;2A", "shift+up"),
        ("alt+up", ARRIVES, b"\x1b[1;3A", "alt+up"),
        ("ctrl+up", ARRIVES, b"\x1b[1;5A", "ctrl+up"),
        ("ctrl+a", ARRIVES, b"\x01", "ctrl+a"),
        ("ctrl+1", SAME, b"1", "1"),
        ("ctrl+9", SAME, b"9", "9"),
        ("ctrl+0", SAME, b"0", "0"),
        ("ctrl+2", SAME, b"\0", "ctrl+@"),
        ("ctrl+space", SAME, b"\0", "ctrl+@"),
        ("ctrl+3", STOP, b"\x1b", "escape"),
        ("ctrl+[", STOP, b"\x1b", "escape"),
        ("ctrl+shift+[", STOP, b"\x1b", "escape"),
        ("ctrl+c", STOP, b"\x03", "ctrl+c"),
        ("ctrl+shift+c", STOP, b"\x03", "ctrl+c"),
        ("escape", STOP, b"\x1b", "escape"),
        ("ctrl+4", SAME, b"\x1c", "ctrl+\\"),
        ("ctrl+5", SAME, b"\x1d", "ctrl+]"),
        ("ctrl+6", SAME, b"\x1e", "ctrl+^"),
        ("ctrl+7", SAME, b"\x1f", "ctrl+_"),
        ("ctrl+8", SAME, b"\x7f", "backspace"),
        ("ctrl+i", SAME, b"\t", "tab"),
        ("ctrl+m", SAME, b"\r", "enter"),
        ("ctrl+h", SAME, b"\b", "backspace"),
        ("ctrl+shift+1", SAME, b"!", "!"),
        ("ctrl+shift+a", SAME, b"\x01", "ctrl+a"),
        ("alt+1", NEVER, b"\x1b1", ""),
        ("alt+a", NEVER, b"\x1ba", ""),
        ("alt+enter", NEVER, b"\x1b\r", ""),
        ("shift+enter", SAME, b"\r", "enter"),
        ("shift+space", SAME, b" ", "space"),
        ("c r", ARRIVES, b"cr", "c r"),
        ("c ctrl+i", SAME, b"c\t", "c tab"),
        ("c ctrl+3", STOP, b"\x1b", "escape"),
        ("shift+pageup", NEVER, b"", ""),
        ("é", NEVER, b"", ""),
    ],
)
def test_a_plain_terminal(chord: str, verdict: KeyOutcome, data: bytes, arrives: str) -> None:
    key_delivery = deliver(chord, PLAIN)
    assert (key_delivery.verdict, key_delivery.data, key_delivery.arrives) == (
        verdict,
        data,
        arrives,
    )
    assert bool(key_delivery.why) is (verdict is not ARRIVES)


@pytest.mark.parametrize(
    "chord",
    ["ctrl+1", "ctrl+2", "ctrl+3", "ctrl+4", "ctrl+8", "ctrl+i", "ctrl+m", "ctrl+h", "ctrl+[",
     "ctrl+shift+1", "ctrl+shift+a", "alt+1", "alt+a", "shift+enter", "shift+space", "ctrl+space",
     "alt+c", "a", "!", "f1", "tab", "up", "alt+up", "c r"],
)  # fmt: skip
def test_the_kitty_protocol_tells_chords_apart(chord: str) -> None:
    key_delivery = deliver(chord, KITTY)
    assert (key_delivery.verdict, key_delivery.arrives) == (ARRIVES, chord)


@pytest.mark.parametrize(
    "chord", ["escape", "ctrl+c", "shift+escape", "ctrl+escape", "ctrl+shift+c"]
)
def test_the_stop_is_the_stop_on_every_terminal(chord: str) -> None:
    for terminal in keys.TERMINALS.values():
        assert deliver(chord, terminal).verdict is STOP


@pytest.mark.parametrize(
    ("chord", "terminal", "verdict"),
    [
        ("alt+up", LINUX, NEVER),
        ("alt+f1", LINUX, NEVER),
        ("alt+f1", PLAIN, ARRIVES),
        ("shift+up", LINUX, SAME),
        ("ctrl+f1", LINUX, NEVER),
        ("f1", LINUX, ARRIVES),
        ("shift+f1", LINUX, ARRIVES),
        ("shift+f9", LINUX, NEVER),
        ("ctrl+b", TMUX, NEVER),
        ("ctrl+b", SCREEN, ARRIVES),
        ("ctrl+a", SCREEN, NEVER),
        ("ctrl+1", TMUX, SAME),
        ("ctrl+1", SCREEN, SAME),
        ("alt+f4", PLAIN, NEVER),
        ("alt+tab", KITTY, NEVER),
        ("alt+home", PLAIN, ARRIVES),
        ("alt+home", TMUX, STOP),
        ("alt+end", SCREEN, STOP),
        ("alt+up", TMUX, ARRIVES),
        ("x alt+end", TMUX, STOP),
    ],
)
def test_what_terminals_keep_for_themselves(
    chord: str, terminal: Terminal, verdict: KeyOutcome
) -> None:
    assert deliver(chord, terminal).verdict is verdict


@given(modifiers, bases, layouts, st.sampled_from(sorted(keys.TERMINALS)))
def test_whatever_sends_the_bytes_of_the_stop_is_never_said_to_arrive(
    held: list[str], base: str, layout: str, name: str
) -> None:
    try:
        chord = normal_key("+".join([*held, base]), layout)
    except KeyNameError:
        return
    key_delivery = deliver(chord, keys.TERMINALS[name], layout)
    stops = (
        key_delivery.data[:1] == b"\x03"
        or key_delivery.data == b"\x1b"
        or key_delivery.arrives in keys.STOPS
    )
    if stops:
        assert key_delivery.verdict is STOP
        assert keys.is_stop(chord, layout)


def test_layouts_decide_what_ctrl_sends() -> None:
    assert deliver(normal_key("ctrl+3", "us"), PLAIN, "us").verdict is STOP
    assert deliver(normal_key('ctrl+"', "fr"), PLAIN, "fr").verdict is SAME
    assert deliver(normal_key("ctrl+3", "fr"), PLAIN, "fr").verdict is STOP
    assert deliver("é", PLAIN, "fr").data == "é".encode()
    assert deliver("^", PLAIN, "de").why == "an accent key: press it, then space"


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({"TERM": "xterm-256color"}, PLAIN),
        ({}, PLAIN),
        ({"TERM": "linux"}, LINUX),
        ({"TERM": "xterm-kitty"}, KITTY),
        ({"TERM": "xterm-kitty", "TMUX": "/tmp/x"}, TMUX),
        ({"TERM": "tmux-256color"}, TMUX),
        ({"TERM": "screen.xterm-256color", "STY": "1"}, SCREEN),
    ],
)
def test_the_terminal_by_its_environment(environment: dict[str, str], expected: Terminal) -> None:
    assert keys.detect_terminal(environment) is expected


def test_bytes_as_people_read_them() -> None:
    assert keys.describe_bytes(b"\x1b[1;2A") == "ESC [ 1 ; 2 A"
    assert keys.describe_bytes(b"\x01") == "^A"
    assert keys.describe_bytes("é".encode()) == "é"
    assert keys.describe_bytes(b"\x7f \r\t\0") == "DEL space CR TAB NUL"


# -- Textual's names -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("key", "character", "expected"),
    [
        ("a", "a", "a"),
        ("A", "A", "A"),
        ("upper_a", None, "A"),
        ("exclamation_mark", "!", "!"),
        ("exclamation_mark", None, "!"),
        ("pound_sign", "£", "£"),
        ("full_stop", None, "."),
        ("slash", None, "/"),
        ("colon", None, ":"),
        ("space", " ", "space"),
        ("ctrl+@", "\0", "ctrl+@"),
        ("ctrl+a", "\x01", "ctrl+a"),
        ("backspace", "\x7f", "backspace"),
        ("enter", "\r", "enter"),
        ("tab", "\t", "tab"),
        ("ctrl+backslash", "\x1c", "ctrl+\\"),
        ("ctrl+right_square_bracket", "\x1d", "ctrl+]"),
        ("ctrl+circumflex_accent", "\x1e", "ctrl+^"),
        ("ctrl+underscore", "\x1f", "ctrl+_"),
        ("shift+up", None, "shift+up"),
        ("alt+ctrl+shift+a", None, "ctrl+alt+shift+a"),
        ("alt+a", "a", "alt+a"),
        ("ctrl+shift+1", None, "ctrl+shift+1"),
        ("shift+a", None, "A"),
        ("shift+exclamation_mark", None, "!"),
        ("ctrl+left_square_bracket", None, "ctrl+["),
        ("ctrl+hyphen_minus", None, "ctrl+-"),
        ("f13", None, "f13"),
        ("pageup", None, "pageup"),
        ("escape", "\x1b", "escape"),
        ("plus", "+", "+"),
        ("comma", None, ","),
        ("é", "é", "é"),
    ],
)
def test_textuals_names(key: str, character: str | None, expected: str) -> None:
    assert from_textual(key, character) == expected


@given(st.text(max_size=20), st.one_of(st.none(), st.text(min_size=1, max_size=1)))
def test_no_name_of_textuals_is_too_strange(key: str, character: str | None) -> None:
    assert isinstance(from_textual(key, character), str)


# -- a wizard's keymap ---------------------------------------------------------------------------


def keymap_errors(path: Path, text: str) -> list[str]:
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ExperimentError) as caught:
        load_keymap(path)
    return [str(problem).removeprefix(f"{path}:") for problem in caught.value.problems]


def test_the_consoles_keys_are_all_different_and_none_is_the_stop_but_the_stop() -> None:
    chords = [item.chord for item in keys.BUILTIN_KEYS]
    assert len(set(chords)) == len(chords)
    assert [item.chord for item in keys.BUILTIN_KEYS if not item.movable] == list(keys.STOPS)
    for item in keys.BUILTIN_KEYS:
        assert normal_key(item.chord) == item.chord
        assert keys.is_stop(item.chord) is not item.movable
        assert not any(keys.is_stop(chord) for chord in item.reserves)


def test_a_keymap_moves_the_consoles_keys(tmp_path: Path) -> None:
    path = tmp_path / "keymap.yaml"
    path.write_text("say: Ctrl-G\nmarker: '#'\n")
    moved = {item.id: item.chord for item in load_keymap(path)}
    assert (moved["say"], moved["marker"], moved["note"]) == ("ctrl+g", "#", ",")


def test_an_empty_keymap_changes_nothing(tmp_path: Path) -> None:
    path = tmp_path / "keymap.yaml"
    path.write_text("# nothing\n")
    assert load_keymap(path) == keys.BUILTIN_KEYS


def test_a_keymap_may_use_the_key_of_one_that_yields(tmp_path: Path) -> None:
    path = tmp_path / "keymap.yaml"
    path.write_text("say: '@'\n")
    assert {item.id: item.chord for item in load_keymap(path)}["say"] == "@"
    text = "say: '@'\nrobot: '@'\n"
    assert len(keymap_errors(tmp_path / "k.yaml", text)) == 2


def test_two_keys_may_change_places(tmp_path: Path) -> None:
    path = tmp_path / "keymap.yaml"
    path.write_text("say: ':'\nfind: /\n")
    assert {item.id: item.chord for item in load_keymap(path)}["find"] == "/"


def test_the_stop_cannot_be_moved_nor_taken(tmp_path: Path) -> None:
    text = "stop: x\nstop_too: y\nsay: esc\nnote: ctrl+3\nmarker: ^c\n"
    assert keymap_errors(tmp_path / "k.yaml", text) == [
        "1:1: stop: the key of the stop cannot be changed",
        "2:1: stop_too: the key of the stop cannot be changed",
        "3:1: say: 'esc' means stop, and nothing else",
        "4:1: note: 'ctrl+3' means stop, and nothing else",
        "5:1: marker: '^c' means stop, and nothing else",
    ]


@pytest.mark.parametrize("name", ["leave", "release"])
def test_what_counts_in_text_fields_is_on_no_key_that_is_typed(tmp_path: Path, name: str) -> None:
    (found,) = keymap_errors(tmp_path / "k.yaml", f"{name}: R\n")
    assert found.startswith(f"1:1: {name}: 'R' could not be typed")
    (tmp_path / "k.yaml").write_text(f"{name}: f10\n")
    assert {each.id: each.chord for each in load_keymap(tmp_path / "k.yaml")}[name] == "f10"


def test_what_else_a_keymap_cannot_say(tmp_path: Path) -> None:
    text = "sya: x\nsay: spaec\nnote: c r\nmarker: [a]\nhelp: '.'\nfind: '/'\n"
    assert keymap_errors(tmp_path / "k.yaml", text) == [
        "1:1: sya: unknown; did you mean 'say'?",
        "2:1: say: 'spaec' is not a key; did you mean 'space'?",
        "3:1: note: only one key is possible here, not two after each other",
        "4:1: marker: expected a key, not a list; if a text begins with a bracket, put the text"
        " in quotes",
        "5:1: help: '.' already means 'put a marker into the log'",
        "6:1: find: '/' already means 'type something to say'",
    ]


def test_a_keymap_that_is_not_there_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ExperimentError, match="there is no such file"):
        load_keymap(tmp_path / "none.yaml")


@pytest.mark.parametrize("number", range(13, 25))
def test_pedals_are_keys_where_they_arrive(number: int) -> None:
    key = f"f{number}"
    assert keys.normal_key(f"F{number}") == key
    for terminal in (keys.PLAIN, keys.KITTY):
        key_delivery = keys.deliver(key, terminal)
        assert key_delivery.verdict is keys.KeyOutcome.ARRIVES
        (token,) = Scanner().feed(key_delivery.data)
        assert isinstance(token, Key)
        assert token.chord == key
    assert keys.deliver(key, keys.PLAIN).why
    assert keys.deliver(key, keys.TMUX).verdict is keys.KeyOutcome.NEVER


def test_a_sign_in_a_keymap_is_written_as_itself(tmp_path: Path) -> None:
    """An experiment may name another keyboard, on which shift+0 is another sign."""
    (problem,) = keymap_errors(tmp_path / "k.yaml", "note: shift+0\n")
    assert "the sign itself" in problem
    (tmp_path / "k.yaml").write_text("note: shift+n\nsay: shift+f5\n")
    moved = {item.id: item.chord for item in load_keymap(tmp_path / "k.yaml")}
    assert (moved["note"], moved["say"]) == ("N", "shift+f5")
