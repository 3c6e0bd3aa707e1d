"""Orders of conditions for the participants of a study: pure, and the same for the same seed.

`rows` are what participants are spread over. A Latin square has n of them or 2n, a fixed order one
(or one for each condition, if everybody gets one only). Shuffled blocks have no end: row k is the
place of the k-th participant in all blocks, one behind the other.
"""

from __future__ import annotations

import math
import random
import string
from collections.abc import Sequence, Sized
from typing import TypeVar

from woz_tui.features.study.design import Design

T = TypeVar("T")

Order = tuple[str, ...]


def williams(conditions: Sequence[str]) -> tuple[Order, ...]:
    """Williams' squares: every condition once in each row, equally often at each place, and
    equally often directly behind each other one. n rows for an even number, 2n for an odd one.

    E. J. Williams, Experimental designs balanced for the estimation of residual effects of
    treatments. Australian Journal of Scientific Research A 2 (1949), 149-168.
    """
    count = len(conditions)
    zigzag = [(at + 1) // 2 if at % 2 else (count - at // 2) % count for at in range(count)]
    rows = [[(first + step) % count for step in zigzag] for first in range(count)]
    if count % 2:
        rows += [row[::-1] for row in rows]
    return tuple(dict.fromkeys(tuple(conditions[index] for index in row) for row in rows))


def rows(design: Design, conditions: Sequence[str]) -> tuple[Order, ...]:
    """All rows of a design that has an end; of `blocks`, those of the first block."""
    if not conditions:
        return ((),)
    if design.order == "blocks":
        return tuple(
            order_at(design, conditions, row) for row in range(block_size(design, conditions))
        )
    if not design.within:
        return tuple((condition,) for condition in conditions)
    return williams(conditions) if design.order == "latin-square" else (tuple(conditions),)


def order_at(design: Design, conditions: Sequence[str], row: int) -> Order:
    """What the participant in this row gets; rows behind the last begin anew, but blocks go on."""
    if design.order == "blocks" and conditions:
        size = block_size(design, conditions)
        return _block(design, conditions, row // size)[row % size]
    known = rows(design, conditions)
    return known[row % len(known)]


def block_size(design: Design, conditions: Sized) -> int:
    """Participants of one block."""
    return design.block or max(len(conditions), 1)


def _block(design: Design, conditions: Sequence[str], number: int) -> list[Order]:
    """One block, shuffled with a generator of its own, so that it needs none before it."""
    source = random.Random(f"{design.seed}/{number}")
    times = block_size(design, conditions) // len(conditions)
    if not design.within:
        return [(condition,) for condition in shuffled([*conditions] * times, source)]
    return [order for _ in range(times) for order in _square(conditions, source)]


def _square(conditions: Sequence[str], source: random.Random) -> list[Order]:
    """A random Latin square: each condition once in each row and once at each place."""
    names = shuffled(conditions, source)
    places = shuffled(range(len(names)), source)
    starts = shuffled(range(len(names)), source)
    return [tuple(names[(start + place) % len(names)] for place in places) for start in starts]


def shuffled(items: Sequence[T], source: random.Random) -> list[T]:
    """Fisher and Yates' shuffle by `random()` alone, whose numbers are the same in every Python."""
    found = [*items]
    for last in range(len(found) - 1, 0, -1):
        other = math.floor(source.random() * (last + 1))
        found[last], found[other] = found[other], found[last]
    return found


def letters(conditions: Sequence[str], seed: int) -> dict[str, str]:
    """A letter for each condition, in an order that does not tell which is which."""
    alphabet = [*string.ascii_uppercase[: len(conditions)]]
    alphabet += [f"C{index + 1}" for index in range(len(alphabet), len(conditions))]
    source = random.Random(f"{seed}/blind")
    return dict(zip(conditions, shuffled(alphabet, source), strict=True))


def planned(design: Design, conditions: Sequence[str]) -> int:
    """Trials of one participant."""
    return design.trials * (max(len(conditions), 1) if design.within else 1)
