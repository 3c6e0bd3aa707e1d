"""Gives each action its key. In a browser the last of two actions wins a key; here, the first.

Everybody first gets the key that the file asks for, in the order of the file, as long as it is
free. Whoever is left gets the first free one of: the letters and digits of its title, then a to z,
0 to 9, A to Z, F1 to F12. Never one that begins another action's keys, or that they begin.
"""

from __future__ import annotations

import string
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from woz_tui.config.file_position import FilePosition
from woz_tui.config.keys.chords import FUNCTION_KEYS, KeyNameError, normal_key
from woz_tui.config.keys.keymap import FileKeys
from woz_tui.config.problems import quoted, together, with_remedy
from woz_tui.config.yaml_cursor import Cursor, expectation
from woz_tui.config.yaml_nodes import ListNode, Node, ScalarNode, described
from woz_tui.protocol.sentence import Sentence, said_by

_LETTERS = frozenset(string.ascii_lowercase + string.digits)
#: Every keyboard has them.
RESERVES = (
    *string.ascii_lowercase,
    *string.digits,
    *string.ascii_uppercase,
    *FUNCTION_KEYS,
)


@dataclass(slots=True)
class KeyRequest:
    """An action's title, and its `key_comb`. `key` is what it gets, as our own files write it;
    `why`: why not what it wished for.
    """

    title: str
    comb: Cursor
    key: str = ""
    why: str = ""

    @property
    def place(self) -> FilePosition:
        """Where the wish stands."""
        return self.comb.place


def grant(wishes: Iterable[KeyRequest], layout: str) -> None:
    """Give every wish its key, and a warning to each that does not get the one it wished for."""
    ordered = sorted(wishes, key=lambda wish: (wish.place.line, wish.place.column))
    keys = FileKeys(layout)
    left = [wish for wish in ordered if not _gets_own_key(wish, keys, layout)]
    for wish in left:
        plain = unicodedata.normalize("NFKD", wish.title).lower()
        liked = (*(sign for sign in plain if sign in _LETTERS), *RESERVES)
        free = (key for key in liked if not keys.forbidden(key) and not keys.taken(key))
        wish.key = next(free, "")
        if wish.key:
            keys.take(wish.key, wish.title, wish.place)
        title = quoted(wish.title)
        then = (
            Sentence(
                "woz4u.plays_instead", "{key} plays {title} instead", key=wish.key, title=title
            )
            if wish.key
            else Sentence(
                "woz4u.no_key_left",
                "no key is left for {title}; find it by typing, with :",
                title=title,
            )
        )
        wish.comb.warning(with_remedy(wish.why, then))


def _gets_own_key(wish: KeyRequest, keys: FileKeys, layout: str) -> bool:
    """Whether the wish has got its key, or wishes for none."""
    try:
        written = comb(wish.comb.node)
        if not written:
            return True
        key = normal_key(written, layout)
    except KeyNameError as error:
        wish.why = said_by(error)
        return False
    wish.why = keys.forbidden(key) or keys.taken(key)
    if wish.why:
        return False
    keys.take(key, wish.title, wish.place)
    wish.key = written
    return True


def layout_of(cursor: Cursor | None, known: Sequence[str]) -> str:
    """The keyboard of a section `keyboard`, which is checked where it is decoded."""
    if cursor is not None and isinstance(cursor.node, ScalarNode):
        return cursor.node.text if cursor.node.text in known else "us"
    return "us"


# -- what a key_comb asks for ----------------------------------------------------------------------


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

    `["ctrl", "shift", 1]` is a chord; modifiers may stand anywhere in it. Two keys are a sequence
    (`["c", "r"]`), each with the modifiers in front of it. The names are Mousetrap's, the library
    that the program binds keys with, and browsers'.

    Raises `KeyNameError` for what cannot be pressed on a terminal at all. Whether the key's name is
    known is for `chords.normal_key` to say.
    """
    held: list[str] = []
    presses: list[tuple[list[str], str]] = []
    for token in _tokens(node):
        if token in _DESKTOP:
            raise KeyNameError(
                Sentence(
                    "woz4u.desktop_key",
                    "{token} never reaches a terminal, the desktop keeps it",
                    token=token,
                )
            )
        if token in _MODIFIERS:
            held.append(_MODIFIERS[token])
        else:
            presses.append((held, token))
            held = []
    if presses and held:
        presses[-1][0].extend(held)
    elif held:
        raise KeyNameError(
            Sentence(
                "woz4u.modifiers_alone", "{names} alone are not a key", names=together(held[:3])
            )
        )
    if len(presses) > 2:
        raise KeyNameError(
            Sentence(
                "woz4u.too_many_keys",
                "{number} keys one after the other are too many; at most two are possible",
                number=len(presses),
            )
        )
    return " ".join(
        "+".join([*(name for name in _ORDER if name in held), key]) for held, key in presses
    )


def _tokens(node: Node) -> Iterator[str]:
    """Every key and modifier, in their order, names in lower case."""
    if isinstance(node, ListNode):
        for entry in node.nodes:
            if not isinstance(entry, ScalarNode):
                raise KeyNameError(expectation(Sentence("check.a_key", "a key"), described(entry)))
            yield from _tokens(entry)
    elif isinstance(node, ScalarNode):
        if not node.is_null:
            yield from _tokens_of_text(node.text)
    else:
        raise KeyNameError(
            expectation(
                Sentence("woz4u.key_list", "a list of keys such as [ctrl, 1]"), described(node)
            )
        )


def _tokens_of_text(text: str) -> Iterator[str]:
    """Mousetrap's own spelling, too: `ctrl+1`, `g i`."""
    if text == " ":
        yield "space"
        return
    for part in text.split():
        pieces = ["+"] if part == "+" else part.replace("++", "+plus").split("+")
        for piece in filter(None, pieces):
            yield _token_of(piece)


def _token_of(piece: str) -> str:
    if len(piece) == 1:
        return "plus" if piece == "+" else piece
    if len(piece) > 20:
        raise KeyNameError(
            Sentence("check.no_key", "{key} is not a key{near}", key=quoted(piece), near="")
        )
    if piece.isdecimal() and int(piece) < 10:  # YAML takes 01 for a number, too
        return str(int(piece))
    return piece.lower()
