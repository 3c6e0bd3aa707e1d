"""What a terminal can send, and what arrives when a key is pressed there.

A plain terminal sends characters and control codes as it did in 1978: ctrl+i is a tab, ctrl+1 is
a `1`, ctrl+3 is escape. Terminals with the kitty keyboard protocol tell most chords apart. tmux
and screen look like plain terminals even inside one that speaks it.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass, replace

from woz_tui.config.keys.chords import ARROWS, FUNCTION_KEYS, PEDALS, Chord, parse_chord
from woz_tui.config.keys.keyboard_layouts import KeyboardLayout, layout_of
from woz_tui.protocol.sentence import Sentence


@dataclass(frozen=True, slots=True)
class Terminal:
    """The wizard's terminal, as far as keys go."""

    name: str
    #: It speaks the kitty keyboard protocol and nothing in between swallows it.
    kitty: bool = False
    #: `tmux`, `screen` or nothing.
    multiplexer: str = ""
    #: The text console of Linux, without a desktop.
    linux: bool = False


PLAIN = Terminal("plain")
KITTY = Terminal("kitty", kitty=True)
TMUX = Terminal("tmux", multiplexer="tmux")
SCREEN = Terminal("screen", multiplexer="screen")
LINUX = Terminal("linux", linux=True)

#: Terminals by the names that commands take.
TERMINALS: Mapping[str, Terminal] = {
    terminal.name: terminal for terminal in (PLAIN, KITTY, TMUX, SCREEN, LINUX)
}

#: Values of TERM whose terminals always speak the kitty protocol.
_KITTY_TERMS = ("xterm-kitty", "foot", "foot-extra", "xterm-ghostty")


def detect_terminal(environment: Mapping[str, str]) -> Terminal:
    """The terminal by its environment. A terminal asked directly knows better (kitty protocol)."""
    term = environment.get("TERM", "")
    if environment.get("TMUX") or term.startswith("tmux"):
        return TMUX
    if environment.get("STY") or term.startswith("screen"):
        return SCREEN
    if term == "linux":
        return LINUX
    return KITTY if term in _KITTY_TERMS else PLAIN


def merged_chords(terminal: Terminal) -> frozenset[str]:
    """Chords that may be an escape with a key right behind it, and so must count as the stop."""
    return _FOLDED if terminal.multiplexer else frozenset()


class KeyOutcome(enum.Enum):
    """What becomes of a key press."""

    ARRIVES = "arrives"
    #: Its bytes are those of another key.
    SAME = "same"
    #: Its bytes mean stop.
    STOP = "stop"
    NEVER = "never"


@dataclass(frozen=True, slots=True)
class KeyDelivery:
    """What a terminal sends for a key.

    `data` are the bytes. `arrives` names the key that a program takes them for: the chord itself,
    another one, `escape`, or nothing. `why` says what is the matter, if anything is.
    """

    verdict: KeyOutcome
    data: bytes = b""
    arrives: str = ""
    why: str = ""


#: Control codes and the keys that programs take them for.
CONTROL_CODES: Mapping[int, str] = {
    0: "ctrl+@",
    **{code: f"ctrl+{chr(code + 0x60)}" for code in range(1, 27)},
    8: "backspace",
    9: "tab",
    13: "enter",
    27: "escape",
    28: "ctrl+\\",
    29: "ctrl+]",
    30: "ctrl+^",
    31: "ctrl+_",
    127: "backspace",
}

#: Keys that no keyboard has by themselves: who sends their bytes takes nobody's key away.
UNUSED_CODES = frozenset(
    name
    for name in CONTROL_CODES.values()
    if name not in ("backspace", "tab", "enter", "escape", "ctrl+c")
)

#: The stop keys. Nothing else may ever send their bytes.
STOPS = ("escape", "ctrl+c")

#: What tmux makes of escape with another key right behind it (home, end): one chord, which nobody
#: can tell from alt and that key. Measured with tmux 3.3a and 3.5a; they hand all other keys on
#: with their ESC in front, but that 3.5a drops it before shift+tab.
_FOLDED = frozenset({"alt+home", "alt+end"})

_ESCAPE = b"\x1b"
_SIMPLE = {"tab": b"\t", "enter": b"\r", "backspace": b"\x7f", "escape": _ESCAPE, "space": b" "}
_KITTY_CODES = {"tab": 9, "enter": 13, "escape": 27, "space": 32, "backspace": 127}
#: Named keys: the letter or number of their CSI sequence (xterm's control sequences, "PC-Style
#: Function Keys").
_LETTERS = {"up": "A", "down": "B", "right": "C", "left": "D", "end": "F", "home": "H"}
_LETTERS |= {"f1": "P", "f2": "Q", "f3": "R", "f4": "S"}
_NUMBERS = {"insert": 2, "delete": 3, "pageup": 5, "pagedown": 6}
_NUMBERS |= {"f5": 15, "f6": 17, "f7": 18, "f8": 19, "f9": 20, "f10": 21, "f11": 23, "f12": 24}
#: As xterm's table of VT220 keys goes on; kitty's protocol has numbers of its own.
_PEDALS = dict(zip(PEDALS, (25, 26, 28, 29, 31, 32, 33, 34, 42, 43, 44, 45), strict=True))
_KITTY_F13 = 57376
#: The Linux console's own five, and shift+F1 to F8 (console_codes(4) and its default keymap).
_LINUX_FUNCTION = {f"f{number}": b"\x1b[[" + bytes([64 + number]) for number in range(1, 6)}
_LINUX_SHIFTED = (25, 26, 28, 29, 31, 32, 33, 34)

_ALT = Sentence("terminal.alt", "alt sends escape first, which is the stop (or another character)")


def deliver(chord: str, terminal: Terminal, layout: str = "us") -> KeyDelivery:
    """What happens when `chord` (in normal form) is pressed on this terminal and keyboard.

    Two keys one after the other arrive if both do.
    """
    keyboard = layout_of(layout)
    reaches = [_deliver_chord(parse_chord(part), terminal, keyboard) for part in chord.split(" ")]
    if len(reaches) == 1:
        return reaches[0]
    for verdict in (KeyOutcome.STOP, KeyOutcome.NEVER):
        for found in reaches:
            if found.verdict is verdict:
                return found
    verdicts = {found.verdict for found in reaches}
    whys = [found.why for found in reaches if found.why]
    return KeyDelivery(
        KeyOutcome.SAME if KeyOutcome.SAME in verdicts else KeyOutcome.ARRIVES,
        b"".join(found.data for found in reaches),
        " ".join(found.arrives for found in reaches),
        whys[0] if len(whys) == 1 else "; ".join(whys),  # one stays a sentence
    )


def is_stop(chord: str, layout: str = "us") -> bool:
    """Whether the chord, or a part of it, means stop or sends its bytes on some terminal."""
    for part in chord.split(" "):
        press = parse_chord(part)
        if press.base == "escape" or str(press) in _FOLDED:
            return True
        found = _deliver_chord(replace(press, alt=False), PLAIN, layout_of(layout))
        if found.arrives in STOPS:
            return True
    return False


def describe_bytes(data: bytes) -> str:
    """Bytes as a person reads them: `ESC [ A`, `^A`, `é`."""
    names = {0x1B: "ESC", 0x7F: "DEL", 0x20: "space", 0x0D: "CR", 0x09: "TAB", 0x00: "NUL"}
    text = data.decode("utf-8", "replace")
    return " ".join(
        names.get(ord(sign)) or (f"^{chr(ord(sign) + 64)}" if ord(sign) < 32 else sign)
        for sign in text
    )


def _deliver_chord(chord: Chord, terminal: Terminal, layout: KeyboardLayout) -> KeyDelivery:
    prefix = {"tmux": "ctrl+b", "screen": "ctrl+a"}.get(terminal.multiplexer)
    if prefix is not None and chord.ctrl and not chord.alt and f"ctrl+{chord.base}" == prefix:
        return KeyDelivery(
            KeyOutcome.NEVER,
            why=Sentence(
                "terminal.prefix",
                "{program} uses {key} itself",
                program=terminal.multiplexer,
                key=prefix,
            ),
        )
    if not chord.named:
        return _character(chord, terminal, layout)
    if chord.base in _SIMPLE:
        return _simple(chord, terminal)
    return _function(chord, terminal)


def _character(chord: Chord, terminal: Terminal, layout: KeyboardLayout) -> KeyDelivery:
    if not layout.gives(chord.base):
        return KeyDelivery(
            KeyOutcome.NEVER,
            why=Sentence(
                "terminal.not_on_layout",
                "no key of the {layout} keyboard gives {character}",
                layout=layout.name,
                character=chord.base,
            ),
        )
    if not (chord.ctrl or chord.alt):
        accent = Sentence("terminal.accent", "an accent key: press it, then space")
        why = accent if chord.base in layout.dead else ""
        return KeyDelivery(KeyOutcome.ARRIVES, chord.base.encode(), chord.base, why)
    if terminal.kitty:
        return _kitty(chord, ord(chord.base))
    character = layout.with_shift(chord.base) if chord.shift else chord.base
    if chord.alt:
        return KeyDelivery(KeyOutcome.NEVER, _ESCAPE + character.encode(), why=_ALT)
    return _control(chord, character)


def _control(chord: Chord, character: str) -> KeyDelivery:
    """Ctrl on a plain terminal, by the rule of Xlib's XLookupString, which all others copied."""
    code = ord(character)
    if 0x40 <= code < 0x7F or character == " ":
        byte = code & 0x1F
    elif character == "2":
        byte = 0x00
    elif "3" <= character <= "7":
        byte = code - ord("3") + 0x1B
    elif character == "8":
        byte = 0x7F
    elif character == "/":
        byte = 0x1F
    else:
        return _same(chord, character.encode(), "space" if character == " " else character)
    return _same(chord, bytes([byte]), CONTROL_CODES[byte])


def _same(chord: Chord, data: bytes, arrives: str) -> KeyDelivery:
    if arrives in STOPS:
        why = Sentence(
            "terminal.same_as_stop", "sends the same bytes as {key}, the stop", key=arrives
        )
        return KeyDelivery(KeyOutcome.STOP, data, arrives, why)
    if arrives == str(chord):
        return KeyDelivery(KeyOutcome.ARRIVES, data, arrives)
    why = Sentence("terminal.same", "sends the same bytes as {key}", key=arrives)
    return KeyDelivery(KeyOutcome.SAME, data, arrives, why)


def _simple(chord: Chord, terminal: Terminal) -> KeyDelivery:
    """Tab, enter, backspace, escape and space."""
    data = _SIMPLE[chord.base]
    if chord.base == "escape":
        why = Sentence("terminal.escape", "escape is the stop, whatever is held down with it")
        return KeyDelivery(KeyOutcome.STOP, data, "escape", why)
    if chord == Chord(chord.base):
        return KeyDelivery(KeyOutcome.ARRIVES, data, chord.base)
    if chord.base == "tab" and (chord.alt or not chord.ctrl):
        if chord.alt:
            return KeyDelivery(
                KeyOutcome.NEVER,
                why=Sentence("terminal.alt_tab", "the desktop uses alt+tab itself"),
            )
        return KeyDelivery(KeyOutcome.ARRIVES, b"\x1b[Z", "shift+tab")
    if terminal.kitty:
        return _kitty(chord, _KITTY_CODES[chord.base])
    if chord.alt:
        return KeyDelivery(KeyOutcome.NEVER, _ESCAPE + data, why=_ALT)
    if chord.base == "space" and chord.ctrl:
        return _same(chord, b"\0", CONTROL_CODES[0])
    return _same(chord, data, chord.base)


def _function(chord: Chord, terminal: Terminal) -> KeyDelivery:
    """Arrows, F-keys and the six above the arrows."""
    kept = _reason_kept(chord, terminal)
    if kept:
        return KeyDelivery(KeyOutcome.NEVER, why=kept)
    if chord.base in PEDALS:
        return _pedal(chord, terminal)
    if str(chord) in merged_chords(terminal):
        why = Sentence(
            "terminal.merged",
            "{terminal} sends the same for escape, the stop, and {key} behind it",
            terminal=terminal.name,
            key=chord.base,
        )
        return KeyDelivery(KeyOutcome.STOP, _sequence(chord), "escape", why)
    if terminal.linux:
        return _linux(chord)
    return KeyDelivery(KeyOutcome.ARRIVES, _sequence(chord), str(chord))


def _pedal(chord: Chord, terminal: Terminal) -> KeyDelivery:
    """F13 to F24: every terminal knows them by themselves, or not at all."""
    if terminal.kitty:
        return _kitty(chord, _KITTY_F13 + PEDALS.index(chord.base))
    if terminal.multiplexer:
        why = Sentence(
            "terminal.pedal",
            "{terminal} hands {key} on as another key, or not at all",
            terminal=terminal.name,
            key=chord.base,
        )
        return KeyDelivery(KeyOutcome.NEVER, why=why)
    number = int(chord.base[1:])
    if chord != Chord(chord.base) or (terminal.linux and number > 20):
        return KeyDelivery(
            KeyOutcome.NEVER,
            why=Sentence("terminal.few_send", "few terminals send anything for it"),
        )
    shifted = Sentence(
        "terminal.as_shifted",
        "some terminals send it as {key}; try it",
        key=f"shift+f{number - 12}",
    )
    doubt = "" if terminal.linux else shifted
    return KeyDelivery(
        KeyOutcome.ARRIVES, f"\x1b[{_PEDALS[chord.base]}~".encode(), str(chord), doubt
    )


def _reason_kept(chord: Chord, terminal: Terminal) -> str:
    if terminal.linux and chord.alt and chord.base in (*ARROWS, *FUNCTION_KEYS):
        return Sentence(
            "terminal.linux_alt", "the Linux console uses alt with arrows and F-keys itself"
        )
    if chord == Chord("f4", alt=True):
        return Sentence("terminal.alt_f4", "alt+f4 closes the window")
    if chord.shift and not (chord.ctrl or chord.alt):
        if chord.base in ("pageup", "pagedown"):
            return Sentence(
                "terminal.scrolls", "the terminal scrolls with {key}", key=f"shift+{chord.base}"
            )
        if chord.base == "insert":
            return Sentence("terminal.pastes", "the terminal pastes with shift+insert")
    return ""


def _sequence(chord: Chord) -> bytes:
    modifiers = 1 + chord.shift + 2 * chord.alt + 4 * chord.ctrl
    if chord.base in _LETTERS:
        letter = _LETTERS[chord.base]
        if modifiers > 1:
            return f"\x1b[1;{modifiers}{letter}".encode()
        return f"\x1b{'O' if chord.base in FUNCTION_KEYS else '['}{letter}".encode()
    suffix = f";{modifiers}" if modifiers > 1 else ""
    return f"\x1b[{_NUMBERS[chord.base]}{suffix}~".encode()


def _linux(chord: Chord) -> KeyDelivery:
    """The Linux console knows shift only on F1 to F8, and no ctrl on keys with names."""
    bare = Chord(chord.base)
    data = _LINUX_FUNCTION.get(chord.base) or _sequence(bare)
    if chord == bare:
        return KeyDelivery(KeyOutcome.ARRIVES, data, str(chord))
    if chord.base in FUNCTION_KEYS:
        number = int(chord.base[1:])
        if chord == Chord(chord.base, shift=True) and number <= len(_LINUX_SHIFTED):
            code = f"\x1b[{_LINUX_SHIFTED[number - 1]}~".encode()
            return KeyDelivery(KeyOutcome.ARRIVES, code, f"f{number + 12}")
        return KeyDelivery(
            KeyOutcome.NEVER,
            why=Sentence("terminal.linux_none", "the Linux console sends nothing for it"),
        )
    return _same(chord, data, chord.base)


def _kitty(chord: Chord, code: int) -> KeyDelivery:
    modifiers = 1 + chord.shift + 2 * chord.alt + 4 * chord.ctrl
    data = f"\x1b[{code};{modifiers}u".encode()
    if chord.base == "c" and chord.ctrl:
        why = Sentence("terminal.ctrl_c", "ctrl+c is the stop, whatever is held down with it")
        return KeyDelivery(KeyOutcome.STOP, data, "ctrl+c", why)
    return KeyDelivery(KeyOutcome.ARRIVES, data, str(chord))
