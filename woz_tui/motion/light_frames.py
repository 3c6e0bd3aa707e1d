"""A picture on a matrix of lights, on or off: what the LED face gets and the console draws."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class LightFrame:
    """`rows` from the top, each a number whose highest of `width` bits is the leftmost light."""

    width: int
    rows: tuple[int, ...]

    @property
    def height(self) -> int:
        """How many rows there are."""
        return len(self.rows)

    def lit(self, column: int, row: int) -> bool:
        """Whether a light is on; `column` and `row` count from 0 at the upper left."""
        return bool(self.rows[row] >> (self.width - 1 - column) & 1)

    def distance(self, other: LightFrame) -> int:
        """How many lights differ (Hamming); both frames have one size."""
        return sum((a ^ b).bit_count() for a, b in zip(self.rows, other.rows, strict=True))

    @property
    def hex(self) -> str:
        """The rows in hexadecimal, all of one length, with blanks between them."""
        digits = (self.width + 3) // 4
        return " ".join(f"{row:0{digits}x}" for row in self.rows)

    def packed(self) -> bytes:
        """For a wire: rows from the top in whole bytes, leftmost light first, padded right."""
        size = (self.width + 7) // 8
        shift = size * 8 - self.width
        return b"".join((row << shift).to_bytes(size, "big") for row in self.rows)

    @classmethod
    def of_hex(cls, width: int, text: str) -> LightFrame:
        """What `hex` wrote. `ValueError` if it is no such text."""
        rows = tuple(int(row, 16) for row in text.split())
        if any(row < 0 or row >> width for row in rows):
            raise ValueError(f"a row is wider than {width} lights")
        return cls(width, rows)


def blank(width: int, height: int) -> LightFrame:
    """All lights out."""
    return LightFrame(width, (0,) * height)
