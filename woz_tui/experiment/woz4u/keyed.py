"""Who gets which key. In a browser the last of two actions silently wins a key; here, the first.

Everybody first gets the key that the file asks for, in the order of the file, as long as it is
free. Whoever is left gets the first free one of: the letters and digits of its title, then a to z,
0 to 9, A to Z, F1 to F12. Never one that begins another action's keys, or that they begin.
"""

from __future__ import annotations

import string
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from woz_tui.experiment.builtins import BUILTIN
from woz_tui.experiment.chords import FUNCTION_KEYS, KeyNameError, normal
from woz_tui.experiment.nodes import Scalar
from woz_tui.experiment.report import quoted
from woz_tui.experiment.shape import Place
from woz_tui.experiment.spot import Spot
from woz_tui.experiment.terminals import STOPS, is_stop
from woz_tui.experiment.woz4u.combs import comb

_LETTERS = frozenset(string.ascii_lowercase + string.digits)
#: Every keyboard has them.
RESERVES = (
    *string.ascii_lowercase,
    *string.digits,
    *string.ascii_uppercase,
    *FUNCTION_KEYS,
)


@dataclass(slots=True)
class Wish:
    """An action's title, and its `key_comb`. `key` is what it gets, as our own files write it;
    `why`: why not what it wished for.
    """

    title: str
    comb: Spot
    key: str = ""
    why: str = ""

    @property
    def place(self) -> Place:
        """Where the wish stands."""
        return self.comb.place


def grant(wishes: Iterable[Wish], layout: str) -> None:
    """Give every wish its key, and a warning to each that does not get the one it wished for."""
    ordered = sorted(wishes, key=lambda wish: (wish.place.line, wish.place.column))
    board = _Board(layout)
    left = [wish for wish in ordered if not board.granted(wish)]
    for wish in left:
        wish.key = board.reserve(wish)
        instead = f"{wish.key} plays {quoted(wish.title)} instead"
        nothing = f"no key is left for {quoted(wish.title)}; find it by typing, with :"
        wish.comb.warning(f"{wish.why}; {instead if wish.key else nothing}")


class _Board:
    """The keys that are taken, in their normal form."""

    def __init__(self, layout: str) -> None:
        self._layout = layout
        self._builtin = {item.chord: item.description for item in BUILTIN if not item.yields}
        self._played: dict[str, Wish] = {}
        self._begun: dict[str, Wish] = {}

    def granted(self, wish: Wish) -> bool:
        """Whether the wish has got its key, or wishes for none."""
        try:
            written = comb(wish.comb.node)
            if not written:
                return True
            key = normal(written, self._layout)
        except KeyNameError as error:
            wish.why = str(error)
            return False
        wish.why = self._taken(key)
        if wish.why:
            return False
        self._take(wish, key)
        wish.key = written
        return True

    def reserve(self, wish: Wish) -> str:
        """A key for a wish that could not be granted; empty if none is left."""
        for key in _liked(wish.title):
            if not self._taken(key):
                self._take(wish, key)
                return key
        return ""

    def _take(self, wish: Wish, key: str) -> None:
        self._played[key] = wish
        first, _, second = key.partition(" ")
        if second:
            self._begun.setdefault(first, wish)

    def _taken(self, key: str) -> str:
        """Why a key cannot be had; empty if it can."""
        first, _, second = key.partition(" ")
        if is_stop(key, self._layout):
            where = "" if {first, second} & set(STOPS) else " on some terminals"
            return f"{key} means stop{where}"
        if first in self._builtin:
            return f"{first} is the console's own key ({self._builtin[first]})"
        if (other := self._played.get(key)) is not None:
            return f"{key} already plays {_shown(other)}"
        if second and (other := self._played.get(first)) is not None:
            return f"{key} can never be finished, as {first} plays {_shown(other)}"
        if not second and (other := self._begun.get(key)) is not None:
            return f"{key} begins the keys of {_shown(other)}"
        return ""


def _shown(wish: Wish) -> str:
    return f"{quoted(wish.title)} (line {wish.place.line})"


def _liked(title: str) -> Iterator[str]:
    """Reserve keys, the title's letters and digits first."""
    plain = unicodedata.normalize("NFKD", title).lower()
    yield from dict.fromkeys([*(sign for sign in plain if sign in _LETTERS), *RESERVES])


def layout_of(spot: Spot | None, known: Sequence[str]) -> str:
    """The keyboard of a section `keyboard`, which is checked where it is decoded."""
    if spot is not None and isinstance(spot.node, Scalar):
        return spot.node.text if spot.node.text in known else "us"
    return "us"
