"""Two sequences of names put beside each other, so that as much as possible is in both."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence

#: Sequences with more pairs of places than this are aligned piece by piece, which may miss
#: something but ends in a second or two.
EXACT = 4_000_000


def align(
    a: Sequence[str], b: Sequence[str], limit: int = EXACT
) -> tuple[list[tuple[int, int]], bool]:
    """The longest common subsequence, as pairs of places that rise in both.

    The second value says whether it surely is the longest one: sequences with more than `limit`
    pairs of places between the beginning and the end that they share are aligned piece by piece.
    """
    head = 0
    while head < min(len(a), len(b)) and a[head] == b[head]:
        head += 1
    tail = 0
    while tail < min(len(a), len(b)) - head and a[-1 - tail] == b[-1 - tail]:
        tail += 1
    middle_a, middle_b = a[head : len(a) - tail], b[head : len(b) - tail]
    pieces = max(1, -(-len(middle_a) * len(middle_b) // max(1, limit)))
    found = _in_pieces(middle_a, middle_b, pieces)
    return [
        *((place, place) for place in range(head)),
        *((i + head, j + head) for i, j in found),
        *((len(a) - tail + place, len(b) - tail + place) for place in range(tail)),
    ], pieces == 1


def _longest(a: Sequence[str], b: Sequence[str]) -> list[tuple[int, int]]:
    """By a table: how many are common from each pair of places on."""
    rows = [[0] * (len(b) + 1)]
    for name in reversed(a):
        below, row = rows[-1], [0] * (len(b) + 1)
        for j in range(len(b) - 1, -1, -1):
            row[j] = below[j + 1] + 1 if name == b[j] else max(below[j], row[j + 1])
        rows.append(row)
    rows.reverse()
    pairs, i, j = [], 0, 0
    while i < len(a) and j < len(b):
        if a[i] == b[j]:
            pairs.append((i, j))
            i, j = i + 1, j + 1
        elif rows[i + 1][j] >= rows[i][j + 1]:
            i += 1
        else:
            j += 1
    return pairs


def _in_pieces(a: Sequence[str], b: Sequence[str], pieces: int) -> list[tuple[int, int]]:
    """Both cut into so many pieces, and each aligned with its counterpart."""
    found = []
    for piece in range(pieces):
        i, i_end = (len(a) * n // pieces for n in (piece, piece + 1))
        j, j_end = (len(b) * n // pieces for n in (piece, piece + 1))
        found += [(i + x, j + y) for x, y in _longest(a[i:i_end], b[j:j_end])]
    return found


def rising(numbers: Sequence[int]) -> list[int]:
    """Places of a longest rising part of `numbers`, all of which are different."""
    tops: list[int] = []
    ends: list[int] = []
    before: list[int] = []
    for place, number in enumerate(numbers):
        length = bisect_left(tops, number)
        before.append(ends[length - 1] if length else -1)
        tops[length : length + 1] = [number]
        ends[length : length + 1] = [place]
    found: list[int] = []
    place = ends[-1] if ends else -1
    while place >= 0:
        found.append(place)
        place = before[place]
    return found[::-1]
