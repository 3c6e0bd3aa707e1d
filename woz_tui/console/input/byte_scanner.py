"""Turns a terminal's bytes into tokens, one byte at a time: no terminal, no clock, no thread.

The stop comes first. A lone ESC and an ESC before any byte that cannot follow it in an escape
sequence is a stop; so is ctrl+C, and a sequence that breaks off (a person who types `ESC [` in
one breath). Alt chords of plain terminals (ESC and a character) therefore do not exist, nor does
`ESC ESC [ A`, which some terminals send for alt+up: it is a stop and an arrow. Where something in
between makes one chord of an ESC and the key behind it, that chord is a stop.

A paste is data: ESC and ctrl+C inside it are no stop while it flows (terminals take them out of
what they paste anyway). A paste that has come to a standstill without its end protects nothing:
ESC or ctrl+C at the start of the next read stops, and after two seconds it counts as over.

However the bytes are cut into reads, the tokens are the same, but for what `expire` does.
"""

from __future__ import annotations

from collections.abc import Collection
from enum import Enum, auto

from woz_tui.console.input.escape_sequences import (
    Key,
    Paste,
    Raw,
    StopToken,
    TerminalReply,
    Token,
    application_sequence,
    control_sequence,
)

#: How long an ESC at the end of a read may be the beginning of a sequence, in seconds.
LONE_ESC_S = 0.010
#: The same for `ESC [` and `ESC O`, which arrive in one piece unless a packet ends there.
INTRODUCER_S = 0.050
#: The same for a sequence that has begun to carry parameters.
UNFINISHED_S = 1.0
#: A paste in which nothing came for so long stands still; later it counts as over.
PASTE_STILL_S = 0.2
PASTE_OVER_S = 2.0
#: A longer paste is cut off: nobody wants a book in an utterance, and each painting of a field
#: takes longer the more stands in it. In bytes.
PASTE_LIMIT = 8 * 1024
#: No terminal sends longer sequences.
SEQUENCE_LIMIT = 2048

#: How the answer to the question for pictures begins (`camera.kitty.QUESTION`), how it ends, and
#: how long it may be.
GRAPHICS, _ANSWER_END, _GRAPHICS_LIMIT = b"\x1b_Gi=31;", b"\x1b\\", 256

#: The same for its background (`background_colour.QUESTION`); the answer may end with a bell.
BACKGROUND, _BACKGROUND_LIMIT = b"\x1b]11;", 64
#: Held so far, no person has pressed escape and typed the rest: a piece of a late answer.
_BACKGROUND_SURE = b"\x1b]11;rgb"

_ESC, _CTRL_C, _BELL = 0x1B, 0x03, 0x07
_PASTE_BEGIN, _PASTE_END = b"\x1b[200~", b"\x1b[201~"
_CONTROLS = {
    0x00: "ctrl+@",
    0x08: "backspace",
    0x09: "tab",
    0x0D: "enter",
    0x1C: "ctrl+\\",
    0x1D: "ctrl+]",
    0x1E: "ctrl+^",
    0x1F: "ctrl+_",
    0x20: "space",
    0x7F: "backspace",
}


def _key_of(byte: int) -> Key | None:
    """The key that a byte is by itself, where no sequence has begun."""
    raw = bytes((byte,))
    if byte in (_ESC, _CTRL_C) or byte >= 0x80:
        return None
    control = f"ctrl+{chr(byte + 0x60)}" if byte < 0x20 else chr(byte)
    return Key(_CONTROLS.get(byte, control), raw, raw)


_KEYS = tuple(map(_key_of, range(0x100)))


class _In(Enum):
    GROUND = auto()
    ESCAPE = auto()
    CONTROL = auto()
    APPLICATION = auto()
    MOUSE = auto()
    CHARACTER = auto()
    PASTE = auto()
    GRAPHICS = auto()
    BACKGROUND = auto()


class Scanner:
    """Feed it reads, and call `expire` when nothing more came within `waiting` seconds.

    Args:
        folded: Chords that are an escape and a key, put together on their way here
            (`woz_tui.config.keys.terminals.merged_chords`).
    """

    def __init__(self, folded: Collection[str] = ()) -> None:
        self._folded = folded
        #: The terminal was asked for pictures: until it answers, `ESC _` may begin the answer, and
        #: a stop with a `_` right behind it takes a moment. At all other times it is a stop.
        self.expects_graphics = False
        #: The same for its background, and `ESC ]`.
        self.expects_background = False
        self._state = _In.GROUND
        self._held = bytearray()
        self._pasted = bytearray()
        self._still = False
        self._doubtful = False
        self._tokens: list[Token] = []

    @property
    def waiting(self) -> float | None:
        """Seconds of silence after which `expire` has something to do; None: never."""
        if self._state in (_In.GROUND, _In.CHARACTER):
            return None
        if self._state is _In.PASTE:
            if self._doubtful:
                return LONE_ESC_S
            return PASTE_OVER_S if self._still else PASTE_STILL_S
        if self._state is _In.ESCAPE:
            return LONE_ESC_S
        return INTRODUCER_S if len(self._held) == 2 else UNFINISHED_S

    def feed(self, data: bytes) -> list[Token]:
        """The tokens that are complete with `data`, in order."""
        if (self._still or self._doubtful) and data:
            data = self._wake_paste(data)
        for byte in data:
            key = _KEYS[byte] if self._state is _In.GROUND else None
            if key is not None:  # nearly all of them, where a flood of keys is in front of a stop
                self._tokens.append(key)
            else:
                self._scan(byte)
        return self._give()

    def expire(self) -> list[Token]:
        """Nothing came for `waiting` seconds: what hangs in the air is decided now."""
        if self._state is _In.PASTE:
            if self._doubtful:
                self._settle_doubt()
            elif self._still:
                self._end_paste()
            else:
                self._still = True
        elif self._state not in (_In.GROUND, _In.CHARACTER):
            self._give_up()
        return self._give()

    def close(self) -> list[Token]:
        """No more bytes will ever come: everything that was held back."""
        if self._state is _In.PASTE:
            self._end_paste()
        while self._state not in (_In.GROUND, _In.CHARACTER):
            self._give_up()
        self._drop_character()
        return self._give()

    def _give(self) -> list[Token]:
        tokens, self._tokens = self._tokens, []
        return tokens

    def _scan(self, byte: int) -> None:
        match self._state:
            case _In.GROUND:
                self._ground(byte)
            case _In.ESCAPE:
                self._escape(byte)
            case _In.CONTROL:
                self._control(byte)
            case _In.APPLICATION:
                self._application(byte)
            case _In.MOUSE:
                self._mouse(byte)
            case _In.CHARACTER:
                self._character(byte)
            case _In.PASTE:
                self._paste(byte)
            case _In.GRAPHICS:
                self._answer(byte, GRAPHICS, _GRAPHICS_LIMIT)
            case _In.BACKGROUND:
                self._answer(byte, BACKGROUND, _BACKGROUND_LIMIT)

    # -- single bytes and characters ---------------------------------------------------------

    def _ground(self, byte: int) -> None:
        if (key := _KEYS[byte]) is not None:
            self._tokens.append(key)
        elif byte == _ESC:
            self._begin(_In.ESCAPE, byte)
        elif byte == _CTRL_C:
            self._tokens.append(StopToken("ctrl+c", b"\x03"))
        elif 0xC2 <= byte <= 0xF4:
            self._begin(_In.CHARACTER, byte)
        else:
            self._tokens.append(Raw(bytes((byte,))))

    def _character(self, byte: int) -> None:
        """UTF-8: a byte that does not continue the character is looked at afresh."""
        if not 0x80 <= byte <= 0xBF:
            self._drop_character()
            self._ground(byte)
            return
        self._held.append(byte)
        lead = self._held[0]
        if len(self._held) < 2 + (lead >= 0xE0) + (lead >= 0xF0):
            return
        raw = self._release()
        try:
            text = raw.decode()
        except UnicodeDecodeError:
            text = ""
        self._tokens.append(Key(text, raw, raw) if text.isprintable() and text else Raw(raw))

    def _drop_character(self) -> None:
        if self._state is _In.CHARACTER:
            self._tokens.append(Raw(self._release()))

    # -- escape sequences --------------------------------------------------------------------

    def _escape(self, byte: int) -> None:
        if byte in b"[O":
            self._held.append(byte)
            self._state = _In.CONTROL if byte == 0x5B else _In.APPLICATION
        elif byte == 0x5F and self.expects_graphics:
            self._held.append(byte)
            self._state = _In.GRAPHICS
        elif byte == 0x5D and self.expects_background:
            self._held.append(byte)
            self._state = _In.BACKGROUND
        else:
            self._tokens.append(StopToken("escape", self._release()))
            self._ground(byte)

    def _control(self, byte: int) -> None:
        self._held.append(byte)
        held = self._held
        if byte == 0x5B and len(held) == 3:
            return  # the Linux console's F1 to F5: CSI [ A
        if held == b"\x1b[M":
            self._state = _In.MOUSE
        elif 0x40 <= byte <= 0x7E or (byte == 0x24 and held[2:-1].isdigit()):
            self._complete(control_sequence(bytes(held)))
        elif not 0x20 <= byte <= 0x3F or len(held) > SEQUENCE_LIMIT:
            self._break_off()

    def _application(self, byte: int) -> None:
        self._held.append(byte)
        if byte in b"0123456789;":
            if len(self._held) > SEQUENCE_LIMIT:
                self._break_off()
        elif 0x20 <= byte <= 0x7E:
            self._complete(application_sequence(bytes(self._held)))
        else:
            self._break_off()

    def _mouse(self, byte: int) -> None:
        """The old mouse report: three more bytes, none of them a control character."""
        self._held.append(byte)
        if byte < 0x20:
            self._break_off()
        elif len(self._held) == 6:
            self._tokens.append(Raw(self._release()))

    def _answer(self, byte: int, begins: bytes, limit: int) -> None:
        """Nothing but the very answer, letter by letter: all else was a stop, and keys."""
        self._held.append(byte)
        held = self._held
        bell = byte == _BELL and begins == BACKGROUND
        if len(held) <= len(begins):
            if not begins.startswith(held):
                self._break_off()
        elif bell or held.endswith(_ANSWER_END):
            told = bytes(held[len(begins) :]).rstrip(b"\x07\x1b\\")
            if begins == BACKGROUND:
                self._tokens.append(TerminalReply("background", _colour(told), self._release()))
            else:
                self._tokens.append(
                    TerminalReply("graphics", (int(told == b"OK"),), self._release())
                )
        elif len(held) > limit or held[-2] == _ESC or not (byte >= 0x20 or byte == _ESC):
            self._break_off()

    def _complete(self, token: Token | None) -> None:
        if token is None:
            self._break_off()
        elif token.raw == _PASTE_BEGIN:
            self._release()
            self._state = _In.PASTE
        else:
            self._release()
            fold = isinstance(token, Key) and token.chord in self._folded
            self._tokens.append(StopToken("escape", token.raw) if fold else token)

    def _give_up(self) -> None:
        """The rest does not come: a piece of the terminal's answer is nobody's stop."""
        if self._state is _In.BACKGROUND and self._held.startswith(_BACKGROUND_SURE):
            self._tokens.append(TerminalReply("unknown", (), self._release()))
        else:
            self._break_off()

    def _break_off(self) -> None:
        """No sequence after all: ESC was the stop, and the bytes behind it count as they are."""
        rest = self._release()[1:]
        self._tokens.append(StopToken("escape", b"\x1b"))
        for byte in rest:
            self._scan(byte)

    def _begin(self, state: _In, byte: int) -> None:
        self._state = state
        self._held.append(byte)

    def _release(self) -> bytes:
        raw = bytes(self._held)
        self._held.clear()
        self._state = _In.GROUND
        return raw

    # -- pastes ------------------------------------------------------------------------------

    def _paste(self, byte: int) -> None:
        self._pasted.append(byte)
        if byte == 0x7E and self._pasted.endswith(_PASTE_END):
            self._end_paste()
        elif len(self._pasted) > 16 * PASTE_LIMIT:
            del self._pasted[PASTE_LIMIT : -len(_PASTE_END)]

    def _end_paste(self) -> None:
        data = bytes(self._pasted)
        raw = _PASTE_BEGIN + data
        self._pasted.clear()
        self._still = False
        self._state = _In.GROUND
        text = data.removesuffix(_PASTE_END)[:PASTE_LIMIT].decode("utf-8", "replace")
        self._tokens.append(Paste(text, raw))

    def _wake_paste(self, data: bytes) -> bytes:
        """First read after a standstill: a stop at its start is a person's, not the paste's.

        An ESC all by itself may still begin the end mark; it stays in doubt for a moment.
        """
        if self._doubtful and data[0] != 0x5B:
            self._settle_doubt()
        self._still = self._doubtful = False
        if data[0] == _CTRL_C:
            self._tokens.append(StopToken("ctrl+c", data[:1]))
            return data[1:]
        if data[0] == _ESC and not _PASTE_END.startswith(data[: len(_PASTE_END)]):
            self._tokens.append(StopToken("escape", data[:1]))
            return data[1:]
        self._doubtful = data == b"\x1b"
        return data

    def _settle_doubt(self) -> None:
        """The doubtful ESC did not begin the end mark: it was the stop."""
        self._doubtful = False
        self._still = True
        self._pasted.pop()
        self._tokens.append(StopToken("escape", b"\x1b"))


def _colour(said: bytes) -> tuple[int, ...]:
    """Red, green and blue in per mille out of `rgb:ffff/0/80`; nothing where it says no colour."""
    parts = said.removeprefix(b"rgb:").split(b"/")
    try:
        return tuple(round(1000 * int(part, 16) / (16 ** len(part) - 1)) for part in parts)
    except (ValueError, ZeroDivisionError):
        return ()
