"""A picture in few colours of its own, by median cut."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

#: Shape (rows, columns, 3): red, green, blue, 0 to 255.
Pixels = npt.NDArray[np.uint8]
Indices = npt.NDArray[np.intp]

#: Colours of a picture: more of them cost bytes, fewer are seen in faces.
COLOURS = 64


def quantised(pixels: Pixels, colours: int) -> tuple[npt.NDArray[np.float64], Indices]:
    """At most `colours` colours, shape (colours, 3), and for each pixel which of them it gets.

    Median cut (Heckbert 1982) over colours of five bits a channel: the box of colours whose pixels
    are most and farthest apart is halved again and again, where half of its pixels are.
    """
    five = (pixels >> 3).astype(np.intp)
    codes = (five[..., 0] << 10) | (five[..., 1] << 5) | five[..., 2]
    counts = np.bincount(codes.ravel(), minlength=1 << 15)
    present = np.flatnonzero(counts)
    channels = np.stack((present >> 10, present >> 5 & 31, present & 31), axis=1)
    boxes = _boxes(channels, counts[present], colours)
    palette = np.empty((len(boxes), 3))
    lookup = np.zeros(1 << 15, np.intp)
    for number, box in enumerate(boxes):
        weights = counts[present[box]]
        mean = (channels[box] * weights[:, None]).sum(axis=0) / weights.sum()
        palette[number] = mean * (255 / 31)
        lookup[present[box]] = number
    return palette, lookup[codes]


def _boxes(channels: Indices, counts: Indices, most: int) -> list[Indices]:
    """Indices of the colours in each box."""
    boxes = [np.arange(len(channels))]
    spreads = [_spread(channels, counts, boxes[0])]
    while len(boxes) < most:
        worst = int(np.argmax(spreads))
        if spreads[worst] <= 0:  # nothing but boxes of one colour
            break
        for half in _halves(channels, counts, boxes.pop(worst)):
            boxes.append(half)
        spreads.pop(worst)
        spreads += [_spread(channels, counts, box) for box in boxes[-2:]]
    return boxes


def _spread(channels: Indices, counts: Indices, box: Indices) -> float:
    """How much is to be gained by halving a box: its pixels times its longest side."""
    longest = int(np.ptp(channels[box], axis=0).max())
    return float(counts[box].sum()) * longest if longest else 0.0


def _halves(channels: Indices, counts: Indices, box: Indices) -> tuple[Indices, Indices]:
    axis = int(np.argmax(np.ptp(channels[box], axis=0)))
    ordered = box[np.argsort(channels[box, axis], kind="stable")]
    pixels = np.cumsum(counts[ordered])
    middle = int(np.searchsorted(pixels, pixels[-1] / 2)) + 1
    middle = min(max(middle, 1), len(ordered) - 1)
    return ordered[:middle], ordered[middle:]
