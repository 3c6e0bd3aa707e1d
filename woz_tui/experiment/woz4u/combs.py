"""`key_comb`: what it asks for, as a key of ours.

`["ctrl", "shift", 1]` is a chord; modifiers may stand anywhere in it. Two keys are a sequence
(`["c", "r"]`), each with the modifiers in front of it. The names are Mousetrap's, the library that
the program binds keys with, and browsers'.
"""

from __future__ import annotations

from collections.abc import Iterator

from woz_tui.experiment.chords import KeyNameError
from woz_tui.experiment.nodes import Items, Node, Scalar, described
from woz_tui.experiment.report import quoted

_MODIFIERS = {
    **dict.fromkeys(("ctrl", "control", "mod", "ctl", "strg"), "ctrl"),
    **dict.fromkeys(("alt", "option", "opt"), "alt"),
    "shift": "shift",
}
#: Held down, these belong to the desktop; our own `meta` is another one, that of old terminals.
_DESKTOP = ("meta", "command", "cmd", "super", "win", "windows", "os", "hyper", "fn", "altgr")
_ORDER = ("ctrl", "alt", "shift")


def comb(node: Node) -> str:
    """The key as our own files write it: `ctrl+shift+1`, `c r`; empty if there is none.

    Raises `KeyNameError` for what cannot be pressed on a terminal at all. Whether the key's name is
    known is for `chords.normal` to say.
    """
    held: list[str] = []
    presses: list[tuple[list[str], str]] = []
    for token in _tokens(node):
        if token in _DESKTOP:
            raise KeyNameError(f"{token} never reaches a terminal, the desktop keeps it")
        if token in _MODIFIERS:
            held.append(_MODIFIERS[token])
        else:
            presses.append((held, token))
            held = []
    if presses and held:
        presses[-1][0].extend(held)
    elif held:
        raise KeyNameError(f"{' and '.join(held[:3])} alone are no key")
    if len(presses) > 2:
        raise KeyNameError(f"{len(presses)} keys one after the other are too many, two is the most")
    return " ".join(_chord(*press) for press in presses)


def _chord(held: list[str], key: str) -> str:
    return "+".join([*(name for name in _ORDER if name in held), key])


def _tokens(node: Node) -> Iterator[str]:
    """Every key and modifier, in their order, names in lower case."""
    if isinstance(node, Items):
        for entry in node.nodes:
            if not isinstance(entry, Scalar):
                raise KeyNameError(f"expected a key, not {described(entry)}")
            yield from _tokens(entry)
    elif isinstance(node, Scalar):
        if not node.null:
            yield from _split(node.text)
    else:
        raise KeyNameError(f"expected a list of keys such as [ctrl, 1], not {described(node)}")


def _split(text: str) -> Iterator[str]:
    """Mousetrap's own spelling, too: `ctrl+1`, `g i`."""
    if text == " ":
        yield "space"
        return
    for part in text.split():
        pieces = ["+"] if part == "+" else part.replace("++", "+plus").split("+")
        for piece in filter(None, pieces):
            yield _named(piece)


def _named(piece: str) -> str:
    if len(piece) == 1:
        return "plus" if piece == "+" else piece
    if len(piece) > 20:
        raise KeyNameError(f"{quoted(piece)} is not a key")
    if piece.isdecimal() and int(piece) < 10:  # YAML takes 01 for a number, too
        return str(int(piece))
    return piece.lower()
