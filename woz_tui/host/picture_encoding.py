"""Camera pictures as PNG files, compressed pixels or DEC sixel sequences, in the size asked for.

Needs numpy, so it is loaded when the first picture is asked for.
"""

from __future__ import annotations

import base64
import re
import struct
import zlib

import numpy as np
import numpy.typing as npt

from woz_tui.protocol.camera_pictures import Picture, PictureFormat

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
    boxes = _median_cut(channels, counts[present], colours)
    palette = np.empty((len(boxes), 3))
    lookup = np.zeros(1 << 15, np.intp)
    for number, box in enumerate(boxes):
        weights = counts[present[box]]
        mean = (channels[box] * weights[:, None]).sum(axis=0) / weights.sum()
        palette[number] = mean * (255 / 31)
        lookup[present[box]] = number
    return palette, lookup[codes]


def _median_cut(channels: Indices, counts: Indices, most: int) -> list[Indices]:
    """Indices of the colours in each box."""
    boxes = [np.arange(len(channels))]
    spreads = [_spread(channels, counts, boxes[0])]
    while len(boxes) < most:
        worst = int(np.argmax(spreads))
        if spreads[worst] <= 0:  # nothing but boxes of one colour
            break
        spreads.pop(worst)
        box = boxes.pop(worst)
        axis = int(np.argmax(np.ptp(channels[box], axis=0)))
        ordered = box[np.argsort(channels[box, axis], kind="stable")]
        pixels = np.cumsum(counts[ordered])
        middle = int(np.searchsorted(pixels, pixels[-1] / 2)) + 1
        middle = min(max(middle, 1), len(ordered) - 1)
        for half in (ordered[:middle], ordered[middle:]):
            boxes.append(half)
            spreads.append(_spread(channels, counts, half))
    return boxes


def _spread(channels: Indices, counts: Indices, box: Indices) -> float:
    """How much is to be gained by halving a box: its pixels times its longest side."""
    longest = int(np.ptp(channels[box], axis=0).max())
    return float(counts[box].sum()) * longest if longest else 0.0


_BAND = 6
#: Four or more of one character are shorter when counted.
_RUN = re.compile(rb"(.)\1{3,}", re.DOTALL)
_BEGIN, _END = "\x1bP0;1;0q", "\x1b\\"


def sixels(pixels: Pixels, colours: int = COLOURS) -> str:
    """The sequence that draws `pixels`, shape (rows, columns, 3), at the cursor.

    The colours are the picture's own: the most common ones, merged until there are `colours`.
    Six rows of pixels at a time are a band. In a band each colour that occurs in it draws all its
    pixels from left to right, one character for six pixels one above the other (`?` and the six
    bits); `$` goes back to the left, `-` on to the next band, `!9x` repeats `x` nine times.
    Source: DEC STD 070, Video Systems Reference Manual, chapter 9.
    """
    height, width = pixels.shape[:2]
    palette, drawn = quantised(pixels, colours)
    percent = np.rint(palette * (100 / 255)).astype(int)
    registers = (f"#{n};2;{r};{g};{b}" for n, (r, g, b) in enumerate(percent.tolist()))
    bands = (_band_sixels(drawn[top : top + _BAND]) for top in range(0, height, _BAND))
    return f'{_BEGIN}"1;1;{width};{height}{"".join(registers)}{"-".join(bands)}{_END}'


def _band_sixels(drawn: Indices) -> str:
    """At most six rows, shape (rows, columns): every colour that occurs, one line each."""
    present, places = np.unique(drawn, return_inverse=True)
    width = drawn.shape[1]
    bits = np.zeros((len(present), width), np.uint8)
    columns = np.arange(width)
    for row, line in enumerate(places.reshape(drawn.shape)):
        bits[line, columns] |= 1 << row
    signs = bits + np.uint8(63)
    lines = (
        f"#{colour}{_with_repeats_counted(line.tobytes())}"
        for colour, line in zip(present, signs, strict=True)
    )
    return "$".join(lines)


def _with_repeats_counted(signs: bytes) -> str:
    """A line's characters with repeats counted, without those at its end that draw nothing."""
    short = _RUN.sub(lambda run: b"!%d%b" % (len(run[0]), run[1]), signs.rstrip(b"?"))
    return short.decode("ascii")


#: Quick is better than small: on a picture the best level saves a twentieth and takes ten times as
#: long.
_LEVEL = 3


def fitting(width: int, height: int, most_width: int, most_height: int) -> tuple[int, int]:
    """The largest size with the proportions of `width` x `height` that fits, at least 1 x 1."""
    across = most_width * height <= most_height * width
    if across:
        return most_width, min(most_height, max(1, round(most_width * height / width)))
    return min(most_width, max(1, round(most_height * width / height))), most_height


def scaled(pixels: Pixels, width: int, height: int) -> Pixels:
    """`pixels` in a smaller size, each new pixel the mean of those it covers; a larger size repeats
    pixels.
    """
    rows, columns = pixels.shape[:2]
    if width > columns or height > rows:
        across = np.arange(width) * columns // width
        larger: Pixels = pixels[np.arange(height) * rows // height][:, across]
        return larger
    tops = np.arange(height) * rows // height
    lefts = np.arange(width) * columns // width
    # Columns first: what is left of the rows then is in one piece.
    sums = np.add.reduceat(np.add.reduceat(pixels, tops, 0, np.uint32), lefts, 1, np.uint32)
    high = np.diff(tops, append=rows).astype(np.uint32)
    wide = np.diff(lefts, append=columns).astype(np.uint32)
    counts = high[:, None, None] * wide[None, :, None]
    means: Pixels = ((sums + counts // 2) // counts).astype(np.uint8)
    return means


def encoded(
    picture: Picture, most_width: int, most_height: int, wanted: PictureFormat
) -> tuple[int, int, str]:
    """Width, height and data of `picture` as a `PictureShown` has them.

    A sixel picture fills the room, which costs few bytes more. The others are never larger than the
    camera's picture: whoever draws them can repeat pixels. Raises `ValueError` if the picture is
    not as large as it says.
    """
    size = picture.width * picture.height * 3
    if picture.width < 1 or picture.height < 1 or len(picture.rgb) != size:
        shape = f"{picture.width} x {picture.height}"
        raise ValueError(f"a picture of {shape} pixels has {len(picture.rgb)} bytes")
    pixels = np.frombuffer(picture.rgb, np.uint8).reshape(picture.height, picture.width, 3)
    width, height = fitting(picture.width, picture.height, most_width, most_height)
    if wanted == "sixel":
        return width, height, sixels(scaled(pixels, width, height))
    width, height = min(width, picture.width), min(height, picture.height)
    smaller = scaled(pixels, width, height)
    data = png(smaller) if wanted == "png" else zlib.compress(smaller.tobytes(), _LEVEL)
    return width, height, base64.b64encode(data).decode()


def png(pixels: Pixels, colours: int = COLOURS) -> bytes:
    """A PNG file in a palette of its own: a third of the bytes that all colours would need.

    Source: PNG specification, third edition, chapters 5, 9 and 11.
    """
    height, width = pixels.shape[:2]
    palette, drawn_in = quantised(pixels, colours)
    rows = np.zeros((height, width + 1), np.uint8)  # the first byte of a row: it is not filtered
    rows[:, 1:] = drawn_in
    head = struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)
    parts = (
        (b"IHDR", head),
        (b"PLTE", np.rint(palette).astype(np.uint8).tobytes()),
        (b"IDAT", zlib.compress(rows.tobytes(), _LEVEL)),
        (b"IEND", b""),
    )
    file = b"\x89PNG\r\n\x1a\n"
    for kind, data in parts:
        check = struct.pack(">I", zlib.crc32(kind + data))
        file += struct.pack(">I", len(data)) + kind + data + check
    return file
