"""The key map and the console's scanner mean the same key by the same bytes."""

from __future__ import annotations

import itertools

import pytest

from woz_tui.config import keys
from woz_tui.config.keys.chords import NAMED
from woz_tui.config.keys.terminals import merged_chords
from woz_tui.console.input.byte_scanner import Scanner
from woz_tui.console.input.escape_sequences import Key, StopToken

MODIFIERS = ("", "ctrl+", "alt+", "shift+", "ctrl+alt+", "ctrl+shift+", "alt+shift+")
CHARACTERS = "abcehimqz019278AZ!#+-/:?[]\\^_{@~ éß§"


def chords(layout: str) -> list[str]:
    found = set()
    for held, base in itertools.product(MODIFIERS, (*NAMED, *CHARACTERS)):
        found.add(keys.normal_key(held + (base.strip() or "space"), layout))
    return sorted(found)


def scanned(data: bytes, terminal: keys.Terminal) -> list[str]:
    """What the console makes of the bytes; `stop` for the stop."""
    scanner = Scanner(merged_chords(terminal))
    tokens = [*scanner.feed(data), *scanner.expire()]
    return [
        token.chord if isinstance(token, Key) else "stop"
        for token in tokens
        if isinstance(token, Key | StopToken)
    ]


@pytest.mark.parametrize("layout", sorted(keys.LAYOUTS))
@pytest.mark.parametrize("terminal", keys.TERMINALS.values(), ids=lambda terminal: terminal.name)
def test_what_is_said_to_arrive_is_what_the_scanner_sees(
    terminal: keys.Terminal, layout: str
) -> None:
    wrong = []
    for chord in chords(layout):
        key_delivery = keys.deliver(chord, terminal, layout)
        if key_delivery.verdict is keys.KeyOutcome.NEVER:
            continue
        expected = (
            ["stop"] if key_delivery.verdict is keys.KeyOutcome.STOP else [key_delivery.arrives]
        )
        if scanned(key_delivery.data, terminal) != expected:
            wrong.append((chord, key_delivery.data, expected, scanned(key_delivery.data, terminal)))
    assert wrong == []
