"""Draws what robots show of the engagement model: `python -m tools.signal_pictures [folder]`.

Six calm pictures for a screen of 800 x 480 and a soft beep. States differ in shape and movement,
not in colour alone, so that nobody needs to tell red from green; nothing flashes more often than
twice a second.
"""

from __future__ import annotations

import math
import struct
import sys
import wave
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from PIL import Image, ImageDraw

from tools import ROOT

FOLDER = ROOT / "woz_tui" / "drivers" / "media"
SIZE = (800, 480)
#: Everything is drawn in a square in the middle, so many times larger than it is shown.
SQUARE, FINE = 440, 4
#: Colours are kept apart by lightness too: the red is the darkest, the green the lightest.
GROUND, GREY, WHITE = (16, 20, 26), (118, 128, 140), (226, 231, 236)
RED, GREEN, BLUE = (222, 76, 58), (92, 206, 160), (94, 160, 238)
#: Shades between two colours in the palette.
SHADES = 15
TURN = 2 * math.pi

Colour = tuple[int, int, int]
#: A picture at one moment of its loop: the pen, and the share of the loop that has passed.
Drawing = Callable[["Pen", float], None]


class Pen:
    """Shapes in the square, in points from its middle; right and down are positive."""

    def __init__(self) -> None:
        self.image = Image.new("RGB", (SQUARE * FINE, SQUARE * FINE), GROUND)
        self._draw = ImageDraw.Draw(self.image)

    def _box(self, x: float, y: float, wide: float, high: float) -> tuple[float, ...]:
        middle = SQUARE / 2
        edges = (x - wide + middle, y - high + middle, x + wide + middle, y + high + middle)
        return tuple(edge * FINE for edge in edges)

    def disc(self, x: float, y: float, radius: float, colour: Colour) -> None:
        """A filled circle."""
        self._draw.ellipse(self._box(x, y, radius, radius), colour)

    def pill(self, x: float, y: float, wide: float, high: float, colour: Colour) -> None:
        """A bar with round ends; `wide` and `high` are half of its size."""
        self._draw.rounded_rectangle(
            self._box(x, y, wide, high), min(wide, high) * FINE, fill=colour
        )

    def arc(
        self, x: float, y: float, radius: float, ends: tuple[float, float], colour: Colour
    ) -> None:
        """A line with round ends; angles in degrees, clockwise from the right."""
        thick = 14.0
        box = self._box(x, y, radius + thick / 2, radius + thick / 2)
        self._draw.arc(box, *ends, fill=colour, width=round(thick * FINE))
        for end in ends:
            angle = math.radians(end)
            self.disc(x + radius * math.cos(angle), y + radius * math.sin(angle), thick / 2, colour)

    def shape(self, corners: list[tuple[float, float]], colour: Colour) -> None:
        """A filled polygon."""
        middle = SQUARE / 2
        self._draw.polygon([((x + middle) * FINE, (y + middle) * FINE) for x, y in corners], colour)


def mixed(colour: Colour, share: float) -> Colour:
    """`share` 0 is the ground, 1 the colour."""
    red, green, blue = (
        round(below + (above - below) * share) for below, above in zip(GROUND, colour, strict=True)
    )
    return red, green, blue


def wave_of(moment: float) -> float:
    """0 at the loop's ends, 1 in its middle, softly."""
    return (1 - math.cos(TURN * moment)) / 2


# -- the pictures ---------------------------------------------------------------------------------


def ring(pen: Pen, moment: float, colour: Colour) -> None:
    """Twelve dots; a brighter place goes round them."""
    for number in range(12):
        behind = (moment - number / 12) % 1.0
        angle = TURN * (number / 12 - 0.25)
        light = 0.25 + 0.75 * (1 - behind) ** 2
        x, y = 168 * math.cos(angle), 168 * math.sin(angle)
        pen.disc(x, y, 13 + 5 * (1 - behind) ** 2, mixed(colour, light))


def waiting(pen: Pen, moment: float) -> None:
    """Nobody is there."""
    ring(pen, moment, GREY)


def detected(pen: Pen, moment: float) -> None:
    """Somebody is there: a figure in the ring."""
    ring(pen, moment, RED)
    pen.disc(0, -42, 36, RED)
    pen.pill(0, 62, 66, 52, RED)
    pen.shape([(-70, 64), (70, 64), (70, 130), (-70, 130)], GROUND)
    pen.pill(0, 62, 66, 6, RED)


def capsule(pen: Pen, colour: Colour) -> None:
    """A microphone on its stand."""
    pen.pill(0, -66, 50, 96, colour)
    pen.arc(0, -36, 86, (0, 180), colour)
    pen.pill(0, 88, 7, 44, colour)
    pen.pill(0, 128, 52, 7, colour)


def microphone(pen: Pen, moment: float) -> None:
    """Please speak: the lamp on the microphone comes and goes."""
    capsule(pen, WHITE)
    pen.disc(0, -106, 25, GROUND)
    pen.disc(0, -106, 19, mixed(GREEN, 0.18 + 0.82 * wave_of(moment)))


def recording(pen: Pen, moment: float) -> None:
    """I am listening: waves run towards the microphone."""
    capsule(pen, WHITE)
    pen.disc(0, -106, 25, GROUND)
    pen.disc(0, -106, 19, RED)
    for number, radius in enumerate((208, 172, 136)):
        light = mixed(RED, 0.18 + 0.82 * wave_of(moment - number / 4))
        pen.arc(0, -66, radius, (-24, 24), light)
        pen.arc(0, -66, radius, (156, 204), light)


def thinking(pen: Pen, moment: float) -> None:
    """Three spheres that rise one after the other."""
    for number in range(3):
        lift = wave_of(min(max(moment * 1.8 - number * 0.24, 0.0), 1.0))
        x, y = (number - 1) * 140.0, 12 - 72 * lift
        pen.pill(x, 112, 36 - 12 * lift, 5, mixed(WHITE, 0.22 - 0.12 * lift))
        pen.disc(x, y, 58, mixed(WHITE, 0.6 + 0.1 * lift))
        pen.disc(x - 9, y - 9, 45, mixed(WHITE, 0.75 + 0.1 * lift))
        pen.disc(x - 21, y - 21, 14, WHITE)


def talking(pen: Pen, moment: float) -> None:
    """A loudspeaker with waves that run away from it."""
    pen.pill(-134, 0, 30, 44, BLUE)
    pen.shape([(-134, -44), (-104, -44), (-24, -116), (-24, 116), (-104, 44), (-134, 44)], BLUE)
    pen.pill(-30, 0, 10, 120, BLUE)
    for number, radius in enumerate((66, 118, 170)):
        light = 0.18 + 0.82 * wave_of(moment - number / 5)
        pen.arc(-6, 0, radius, (-44, 44), mixed(BLUE, light))


@dataclass(frozen=True)
class Picture:
    """A loop: how it is drawn, its colours, its frames and how long each is shown (ms)."""

    drawing: Drawing
    colours: tuple[Colour, ...]
    frames: int
    each_ms: int


PICTURES = {
    "waiting": Picture(waiting, (GREY,), 12, 200),
    "detected": Picture(detected, (RED,), 12, 140),
    "microphone": Picture(microphone, (WHITE, GREEN), 8, 170),
    "recording": Picture(recording, (WHITE, RED), 8, 110),
    "thinking": Picture(thinking, (WHITE,), 12, 150),
    "talking": Picture(talking, (BLUE,), 8, 110),
}


def palette(colours: tuple[Colour, ...]) -> Image.Image:
    """All shades from the ground to each colour."""
    shades = [mixed(colour, step / SHADES) for colour in colours for step in range(SHADES + 1)]
    image = Image.new("P", (1, 1))
    image.putpalette([part for shade in shades for part in shade])
    return image


def frames(picture: Picture) -> Iterator[Image.Image]:
    """The loop's images with one palette."""
    shades = palette(picture.colours)
    left, top = (SIZE[0] - SQUARE) // 2, (SIZE[1] - SQUARE) // 2
    for number in range(picture.frames):
        pen = Pen()
        picture.drawing(pen, number / picture.frames)
        whole = Image.new("RGB", SIZE, GROUND)
        whole.paste(pen.image.reduce(FINE), (left, top))
        yield whole.quantize(palette=shades, dither=Image.Dither.NONE)


def draw(name: str, folder: Path) -> None:
    """Write one picture."""
    picture = PICTURES[name]
    first, *others = frames(picture)
    first.save(
        folder / f"{name}.gif",
        save_all=True,
        append_images=others,
        duration=picture.each_ms,
        loop=0,
        optimize=True,
        disposal=1,
    )


# -- the beep -------------------------------------------------------------------------------------

HERTZ = 16_000
#: Pitch in Hz and length in seconds: a fifth upwards.
TONES = ((587.33, 0.10), (880.0, 0.16))
LOUDNESS = 0.22


def beep() -> bytes:
    """Two soft tones as samples of 16 bits."""
    samples: list[float] = []
    for pitch, seconds in TONES:
        count = round(seconds * HERTZ)
        for at in range(count):
            rise = min(1.0, at / (0.012 * HERTZ))
            fall = ((count - at) / count) ** 1.5
            samples.append(LOUDNESS * rise * fall * math.sin(TURN * pitch * at / HERTZ))
    return b"".join(struct.pack("<h", round(32_767 * sample)) for sample in samples)


def write_beep(folder: Path) -> None:
    """Write the beep as a WAV file."""
    with wave.open(str(folder / "beep.wav"), "wb") as sound:
        sound.setnchannels(1)
        sound.setsampwidth(2)
        sound.setframerate(HERTZ)
        sound.writeframes(beep())


def main() -> None:
    """Draw everything."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    for name in PICTURES:
        draw(name, folder)
    write_beep(folder)


if __name__ == "__main__":
    main()
