"""Colours of the eyes: as text, as NAOqi's parts from 0 to 1, and as it reads them back."""

from __future__ import annotations

from dataclasses import dataclass

from woz_drivers.pepper.memory import items, number

#: Two readings of one colour may differ so much in a part: LEDs have 256 steps, some fewer.
CLOSE = 3 / 255


@dataclass(frozen=True, slots=True)
class Color:
    """Red, green and blue from 0 to 1."""

    red: float
    green: float
    blue: float

    @classmethod
    def of(cls, text: str) -> Color:
        """From `#rrggbb`."""
        red, green, blue = bytes.fromhex(text.removeprefix("#"))
        return cls(red / 255, green / 255, blue / 255)

    @classmethod
    def read_back(cls, intensities: object) -> Color | None:
        """From what `ALLeds.getIntensity` says of a light: blue, green, red. None: unreadable."""
        told = [number(part) for part in items(intensities)]
        parts = [min(max(part, 0.0), 1.0) for part in told if part is not None]
        if len(parts) != 3 or len(told) != 3:
            return None
        blue, green, red = parts
        return cls(red, green, blue)

    @property
    def text(self) -> str:
        """As `#rrggbb`."""
        return "#" + "".join(f"{round(part * 255):02x}" for part in self.parts)

    @property
    def parts(self) -> tuple[float, float, float]:
        """Red, green, blue."""
        return self.red, self.green, self.blue

    @property
    def number(self) -> int:
        """As 0xRRGGBB."""
        return int(self.text[1:], 16)

    @property
    def brightness(self) -> float:
        """That of its brightest part."""
        return max(self.parts)

    @property
    def grey(self) -> bool:
        """Whether it is white of some brightness."""
        return self.red == self.green == self.blue

    def dimmed(self, level: float) -> Color:
        """The same colour at a share of its brightness."""
        return Color(self.red * level, self.green * level, self.blue * level)

    def close_to(self, other: Color) -> bool:
        """Whether nobody could tell them apart."""
        pairs = zip(self.parts, other.parts, strict=True)
        return all(abs(one - two) <= CLOSE for one, two in pairs)


BLACK, WHITE = Color(0, 0, 0), Color(1, 1, 1)
