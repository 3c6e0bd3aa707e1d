"""Finding the green thing: its pixels, the largest patch of them, its middle.

The rule is Oosterkamp's: green must exceed red and blue by a factor. It needs no learning and
costs a few microseconds; a green ball, glove or lamp is made for it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from woz_drivers.camera.raw_pictures import Picture, thinning_step

Mask = npt.NDArray[np.bool_]
Counts = npt.NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class ColourRule:
    """Which pixels count, and when there are enough of them.

    A pixel counts if its green is more than `factor` times its red and its blue, and at least
    `brightness` (0..255). `smallest` pixels make a thing. `largest`: only the largest patch of
    pixels that touch (at corners, too); else all of them wherever they are.
    """

    factor: float = 1.3
    brightness: int = 0
    smallest: int = 1
    largest: bool = False


@dataclass(frozen=True, slots=True)
class Blob:
    """What was found: the mean column and row of its pixels, from 0 at the upper left, and how
    many they are.
    """

    x: float
    y: float
    size: int


class BlobFinder:
    """Looks for one thing in pictures, by one rule."""

    def __init__(self, rule: ColourRule) -> None:
        self._rule = rule
        # What green has to exceed, by red or blue: whole numbers, so that 131 is more than
        # 1.3 times 100 and 130 is not, whatever 1.3 is in binary.
        exact = np.round(rule.factor * np.arange(256), 6)
        self._above: npt.NDArray[np.uint8] = np.minimum(np.floor(exact), 255).astype(np.uint8)

    def counting(self, picture: Picture) -> Mask:
        """Which pixels count: shape (rows, columns)."""
        red, green, blue = picture[:, :, 0], picture[:, :, 1], picture[:, :, 2]
        mask: Mask = green > self._above[np.maximum(red, blue)]
        if self._rule.brightness > 0:
            mask &= green >= self._rule.brightness
        return mask

    def find(self, picture: Picture) -> Blob | None:
        """The thing, in the picture's own pixels, or None."""
        rows, columns = picture.shape[:2]
        step = thinning_step(columns, rows)
        mask = self.counting(picture[::step, ::step])
        middle = _largest(mask) if self._rule.largest else _all(mask)
        if middle is None or middle.size * step**2 < self._rule.smallest:
            return None
        if step == 1:
            return middle
        shift = (step - 1) / 2
        return Blob(middle.x * step + shift, middle.y * step + shift, middle.size * step**2)


def _all(mask: Mask) -> Blob | None:
    rows, columns = np.nonzero(mask)
    if not rows.size:
        return None
    return Blob(float(columns.mean()), float(rows.mean()), int(rows.size))


def _largest(mask: Mask) -> Blob | None:
    """Of patches of the same size the upper one."""
    rows, starts, ends = _runs(mask)
    if not rows.size:
        return None
    patch = np.array(_patches(rows.tolist(), starts.tolist(), ends.tolist()))
    lengths = ends - starts
    sizes = np.bincount(patch, lengths)
    best = patch == np.argmax(sizes)
    size = int(lengths[best].sum())
    x = float((lengths[best] * (starts[best] + ends[best] - 1)).sum()) / 2 / size
    y = float((lengths[best] * rows[best]).sum()) / size
    return Blob(x, y, size)


def _runs(mask: Mask) -> tuple[Counts, Counts, Counts]:
    """Rows of pixels that count: in which row, from which column, up to which one."""
    height, width = mask.shape
    framed = np.zeros((height, width + 2), np.bool_)
    framed[:, 1:-1] = mask
    rows, columns = np.nonzero(framed[:, 1:] != framed[:, :-1])
    return rows[::2], columns[::2], columns[1::2]


def _patches(rows: list[int], starts: list[int], ends: list[int]) -> list[int]:
    """For each run the number of the first run of its patch."""
    parent = list(range(len(rows)))

    def root(one: int) -> int:
        while parent[one] != one:
            parent[one] = parent[parent[one]]
            one = parent[one]
        return one

    above = 0
    for run, row in enumerate(rows):
        while rows[above] < row - 1 or (rows[above] == row - 1 and ends[above] < starts[run]):
            above += 1
        other = above
        while other < run and rows[other] == row - 1 and starts[other] <= ends[run]:
            first, second = sorted((root(other), root(run)))
            parent[second] = first
            other += 1
    return [root(run) for run in range(len(rows))]
