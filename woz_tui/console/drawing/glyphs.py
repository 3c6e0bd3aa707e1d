"""The few signs the console draws with, and their stand-ins where a terminal has none."""

from __future__ import annotations

import codecs
from collections.abc import Mapping
from dataclasses import dataclass, fields


@dataclass(frozen=True, slots=True)
class Glyphs:
    """One sign for each meaning, each one cell wide; the pause has two."""

    running: str = "▶"
    pause: str = "┃┃"
    queued: str = "◷"
    held: str = "◷"
    done: str = "✓"
    sent: str = "→"
    waits: str = "◷"
    left_out: str = "○"
    failed: str = "✗"
    refused: str = "⊘"
    stopped: str = "■"
    replaced: str = "■"
    locked: str = "◇"
    unreachable: str = "○"
    info: str = "·"
    warning: str = "▲"
    error: str = "✗"
    note: str = "✎"
    marker: str = "◆"
    driver: str = "◌"
    stop: str = "■"
    yes: str = "●"
    no: str = "○"
    stale: str = "~"
    here: str = "▸"
    next: str = "→"
    rule: str = "─"
    track: str = "┈"
    tick: str = "│"
    bar: str = "━"
    empty: str = "░"
    spot: str = "●"
    target: str = "◇"
    position: str = "◆"
    ellipsis: str = "…"
    dash: str = "-"
    middle: str = "·"
    degrees: str = "°"
    up: str = "↑"
    down: str = "↓"
    left: str = "←"
    right: str = "→"
    opening: str = "“"
    closing: str = "”"
    forced: str = "✎"
    heard: str = "»"

    def plain(self, text: str) -> str:
        """`text` as this terminal can show it."""
        return text

    @property
    def ascii(self) -> bool:
        """Whether only ASCII may be drawn."""
        return False


@dataclass(frozen=True, slots=True)
class AsciiGlyphs(Glyphs):
    """For `TERM=linux`, whose font has few signs, and for encodings other than UTF-8."""

    def plain(self, text: str) -> str:
        """Our own signs replaced; letters with accents stay, the terminal may know them."""
        return text.translate(_PLAIN)

    @property
    def ascii(self) -> bool:
        """Only ASCII may be drawn."""
        return True


_PLAIN = str.maketrans({"“": '"', "”": '"', "…": "~", "→": ">", "·": "-", "°": "d", "●": "*"})

UNICODE = Glyphs()
#: Each sign's stand-in, and another one where a sign has several meanings.
_STAND_INS = str.maketrans("▶┃◷✓✗⊘■◇○·▲✎◆◌●▸→─┈│━░…°“”»", '>|:+X-#xo.!n*o*>>-.|#.~d"">')
_OTHERS = {"sent": "^", "spot": "O", "target": "o", "position": "O", "middle": "-", "forced": "="}
_ARROWS = {"up": "up", "down": "dn", "left": "lf", "right": "rt"}
ASCII = AsciiGlyphs(
    **{field.name: str(field.default).translate(_STAND_INS) for field in fields(Glyphs)}
    | _OTHERS
    | _ARROWS
)


@dataclass(frozen=True, slots=True)
class PaintFrame:
    """Room, moment and signs for one painting: cells, microseconds of session time, glyphs."""

    width: int
    height: int
    now: int
    glyphs: Glyphs = UNICODE


def glyphs_for(environ: Mapping[str, str], encoding: str) -> Glyphs:
    """The signs for a terminal: ASCII on the Linux console and without UTF-8."""
    if environ.get("WOZ_ASCII") or environ.get("TERM", "") in ("linux", "vt100", "vt220"):
        return ASCII
    try:
        utf8 = codecs.lookup(encoding).name == "utf-8"
    except LookupError:
        utf8 = False
    return UNICODE if utf8 else ASCII
