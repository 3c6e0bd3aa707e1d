"""What the scanner makes of the bytes a terminal sends.

Every token keeps the bytes it was made of in `raw`: put end to end, they are what was read.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class StopToken:
    """Somebody wants everything to stop; `source` is `escape` or `ctrl+c`."""

    source: str
    raw: bytes


@dataclass(frozen=True, slots=True)
class Key:
    """A key press: `chord` in the normal form of `woz_tui.config.keys`.

    `screen` is what Textual's parser is given if nobody else wants the key; it differs from `raw`
    where that parser would trip over details (event types, key codes of other protocols).
    """

    chord: str
    raw: bytes
    screen: bytes


@dataclass(frozen=True, slots=True)
class Paste:
    """Text pasted in one go, between the terminal's marks; never a key press."""

    text: str
    raw: bytes


@dataclass(frozen=True, slots=True)
class TerminalReply:
    """The terminal's answer to a question.

    `what`: `status` (to `CSI 5 n`), `kitty` (keyboard flags, in `values`), `attributes`
    (`CSI c`), `graphics` (kitty's pictures: 1 if it draws them), `ground` (its colour: red, green
    and blue in per mille), `position`, or `unknown`: not understood, and therefore kept from
    everybody.
    """

    what: str
    values: tuple[int, ...]
    raw: bytes


@dataclass(frozen=True, slots=True)
class Raw:
    """For Textual's parser alone: mouse, focus, size and mode reports, unprintable characters."""

    raw: bytes


Token = StopToken | Key | Paste | TerminalReply | Raw
