"""The scanner, the experiments' key names and Textual's parser must mean the same by a key."""

from __future__ import annotations

import pytest
from textual._xterm_parser import XTermParser
from textual.events import Key as KeyEvent

from woz_tui.config.keys import (
    TERMINALS,
    KeyOutcome,
    Terminal,
    deliver,
    from_textual,
    is_stop,
    normal_key,
)
from woz_tui.config.keys.terminals import merged_chords
from woz_tui.console.input.byte_scanner import Scanner
from woz_tui.console.input.escape_sequences import Key, StopToken, Token

CHARACTERS = [chr(code) for code in range(0x21, 0x7F)]
NAMED = [
    *("space", "tab", "enter", "backspace", "delete", "insert", "home", "end"),
    *("pageup", "pagedown", "up", "down", "left", "right"),
    *(f"f{number}" for number in range(1, 13)),
]
HELD = ["", "ctrl+", "alt+", "shift+", "ctrl+shift+", "ctrl+alt+", "alt+shift+", "ctrl+alt+shift+"]


def scan(data: bytes, terminal: Terminal) -> list[Token]:
    scanner = Scanner(merged_chords(terminal))
    return scanner.feed(data) + scanner.close()


@pytest.mark.parametrize("terminal", TERMINALS.values(), ids=lambda terminal: terminal.name)
@pytest.mark.parametrize("held", HELD)
def test_what_reaches_the_console_is_what_the_key_map_says(terminal: Terminal, held: str) -> None:
    for key in [*CHARACTERS, *NAMED]:
        chord = normal_key(f"{held}{key}")
        key_delivery = deliver(chord, terminal)
        if not key_delivery.data or key_delivery.verdict is KeyOutcome.NEVER:
            continue
        (token, *rest) = scan(key_delivery.data, terminal)
        if key_delivery.verdict is KeyOutcome.STOP or isinstance(token, StopToken):
            assert isinstance(token, StopToken), chord
            assert is_stop(chord), chord
        else:
            assert isinstance(token, Key), chord
            assert token.chord == key_delivery.arrives, chord
        assert rest == [], chord


@pytest.mark.parametrize("terminal", TERMINALS.values(), ids=lambda terminal: terminal.name)
@pytest.mark.parametrize("held", HELD)
def test_textual_reads_the_same_key(terminal: Terminal, held: str) -> None:
    for key in [*CHARACTERS, *NAMED]:
        key_delivery = deliver(normal_key(f"{held}{key}"), terminal)
        if not key_delivery.data or key_delivery.verdict in (KeyOutcome.NEVER, KeyOutcome.STOP):
            continue
        (token,) = scan(key_delivery.data, terminal)
        if isinstance(token, StopToken):
            continue
        assert isinstance(token, Key)
        events = [e for e in XTermParser().feed(token.screen.decode()) if isinstance(e, KeyEvent)]
        named = [from_textual(event.key, event.character) for event in events]

        assert named == [token.chord], key_delivery.data
