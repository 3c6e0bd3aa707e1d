"""Makes gong, whale and the two pictures of the museum: `python -m tools.museum_media [folder]`.

The sounds are for `experiments/demo.yaml` and the moves, the pictures for the WoZ4U example. The
font is the one that Pillow brings along (Aileron, CC0).
"""

from __future__ import annotations

import math
import struct
import sys
import wave
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from tools import EXPERIMENTS

#: Samples a second, of two bytes each.
RATE = 8000
LOUD = 0.8 * 32767
GONG_S, WHALE_S = 1.2, 2.0
#: A gong's partials: pitch as a multiple of the lowest, share of the loudness, seconds to a third.
GONG_HZ = 196.0
GONG = ((1.0, 0.4, 0.5), (1.52, 0.25, 0.4), (2.41, 0.2, 0.3), (3.93, 0.1, 0.2), (5.12, 0.05, 0.1))
#: A whale's two calls: beginning and end as shares of the sound, and their pitches in hertz.
WHALE = ((0.0, 0.55, 180.0, 420.0), (0.6, 1.0, 380.0, 140.0))

SIZE = (1280, 800)
GROUND, INK, SAND = (250, 246, 235), (30, 49, 70), (221, 211, 190)
RED, SEA = (198, 83, 52), (90, 130, 150)
#: The plan's inner walls, with gaps for the doors, as boxes of left, top, right and bottom.
WALLS = (
    *((553, 120, 567, 219), (553, 301, 567, 420)),
    *((80, 413, 259, 427), (341, 413, 599, 427), (681, 413, 939, 427), (1021, 413, 1200, 427)),
    *((393, 420, 407, 559), (393, 641, 407, 720), (793, 420, 807, 559), (793, 641, 807, 720)),
)
ROOMS = (
    *((320, 272, "Paintings"), (880, 272, "Ships")),
    *((240, 572, "Shop"), (600, 572, "Entrance"), (1000, 572, "Sculptures")),
)


def gong() -> list[float]:
    """Partials that are no multiples of each other, the higher the shorter."""
    return [
        min(1.0, time / 0.005)
        * sum(
            share * math.exp(-time / lasts) * math.sin(2 * math.pi * GONG_HZ * times * time)
            for times, share, lasts in GONG
        )
        for time in (index / RATE for index in range(round(GONG_S * RATE)))
    ]


def whale() -> list[float]:
    """Two calls that glide, up and then down, with a slow tremble."""
    samples, turns = [], 0.0
    for index in range(round(WHALE_S * RATE)):
        now = index / (WHALE_S * RATE)
        value = 0.0
        for begin, end, first, last in WHALE:
            if begin <= now < end:
                share = (now - begin) / (end - begin)
                tremble = 1.0 + 0.02 * math.sin(2 * math.pi * 5.0 * now * WHALE_S)
                turns += (first + (last - first) * share) * tremble / RATE
                angle = 2 * math.pi * turns
                value = 0.7 * math.sin(angle) + 0.2 * math.sin(2 * angle)
                value *= math.sin(math.pi * share) ** 0.5
        samples.append(value)
    return samples


def plan() -> Image.Image:
    """The museum's rooms, and where the robot stands."""
    image, draw = _sheet()
    _write(draw, (640, 62), "Floor plan", 60)
    draw.rectangle((80, 120, 1200, 720), outline=INK, width=8)
    draw.rectangle((408, 428, 792, 713), SAND)
    for box in WALLS:
        draw.rectangle(box, INK)
    for x, y, name in ROOMS:
        _write(draw, (x, y), name, 48)
    draw.ellipse((575, 640, 625, 690), RED)
    return image


def welcome() -> Image.Image:
    """A sailing ship."""
    image, draw = _sheet()
    _write(draw, (640, 110), "Welcome", 112)
    draw.rectangle((0, 560, *SIZE), SEA)
    draw.polygon([(500, 560), (700, 560), (670, 620), (530, 620)], INK)
    draw.rectangle((603, 200, 610, 560), INK)
    draw.polygon([(600, 220), (600, 540), (420, 540)], RED)
    draw.polygon([(612, 260), (612, 540), (740, 540)], SAND)
    return image


def _sheet() -> tuple[Image.Image, ImageDraw.ImageDraw]:
    image = Image.new("RGB", SIZE, GROUND)
    return image, ImageDraw.Draw(image)


def _write(draw: ImageDraw.ImageDraw, middle: tuple[int, int], text: str, size: int) -> None:
    draw.text(middle, text, INK, ImageFont.load_default(size), anchor="mm")


def write_sound(path: Path, samples: list[float]) -> None:
    """A WAV file of one channel, as loud as the others."""
    loudest = max(map(abs, samples))
    words = [round(LOUD * value / loudest) for value in samples]
    with wave.open(str(path), "wb") as sound:
        sound.setnchannels(1)
        sound.setsampwidth(2)
        sound.setframerate(RATE)
        sound.writeframes(struct.pack(f"<{len(words)}h", *words))


def main() -> None:
    """Write all four into `media` and `woz4u/pictures`."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else EXPERIMENTS
    for name, samples in (("gong", gong()), ("whale", whale())):
        write_sound(folder / "media" / f"{name}.wav", samples)
    for name, picture in (("plan", plan()), ("welcome", welcome())):
        few = picture.quantize(16)
        few.save(folder / "woz4u" / "pictures" / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
