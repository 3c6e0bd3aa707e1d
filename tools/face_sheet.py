"""Draws every face as a sheet: `python -m tools.face_sheet` writes `docs/images/faces.svg`.

Rows are emotions, columns are how strong they are, where the eyes look and how far they are open;
below are stills of the breakdown.
"""

from __future__ import annotations

from collections.abc import Iterator

from tools import IMAGES
from woz_tui.motion.body_shape import FaceShape
from woz_tui.motion.body_verbs import EMOTIONS
from woz_tui.motion.face_drawing import FaceState, draw
from woz_tui.motion.light_frames import LightFrame

SHEET = IMAGES / "faces.svg"
SHAPE = FaceShape()

#: What differs between the columns: their heading, intensity, gaze x and y, lid.
COLUMNS: tuple[tuple[str, float, float, float, float], ...] = (
    ("25 %", 0.25, 0, 0, 1),
    ("50 %", 0.5, 0, 0, 1),
    ("75 %", 0.75, 0, 0, 1),
    ("100 %", 1, 0, 0, 1),
    ("to its right, up", 1, -1, 1, 1),
    ("to its left, down", 1, 1, -1, 1),
    ("half closed", 1, 0, 0, 0.5),
    ("closed", 1, 0, 0, 0),
)
#: Moments of the breakdown, in seconds.
STILLS = (0.1, 0.9, 1.1, 3.0, 3.6, 4.6, 7.0, 10.2)

#: Sizes in lights; a light is `SCALE` pixels.
GAP, MARGIN, TITLE, LABEL, SCALE = 3, 2, 4, 13, 4


def sheet() -> str:
    """The whole picture as SVG."""
    rows = [*(e for e in EMOTIONS if e != "crash"), "crash"]
    width = LABEL + len(COLUMNS) * (SHAPE.width + GAP)
    height = TITLE + (len(rows)) * (SHAPE.height + GAP)
    body = "\n".join([*_headings(), *_rows(rows)])
    return f"""<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" \
width="{width * SCALE}" height="{height * SCALE}">
<style>
text {{ font: 2.4px sans-serif; fill: #c9d1d9 }}
.board {{ fill: #0d1117 }}
.dark, .lit {{ stroke-width: 0.74; stroke-linecap: round; fill: none }}
.dark {{ stroke: #1f262e }}
.lit {{ stroke: #ff5a3c }}
</style>
<defs><path id="dark" class="dark" d="{_dots(LightFrame(SHAPE.width, _full()))}"/></defs>
<rect width="100%" height="100%" fill="#161b22"/>
{body}
</svg>
"""


def _full() -> tuple[int, ...]:
    return ((1 << SHAPE.width) - 1,) * SHAPE.height


def _headings() -> Iterator[str]:
    for number, (heading, *_) in enumerate(COLUMNS):
        yield f'<text x="{_left(number)}" y="{TITLE - 1}">{heading}</text>'


def _rows(emotions: list[str]) -> Iterator[str]:
    for number, emotion in enumerate(emotions):
        top = TITLE + number * (SHAPE.height + GAP)
        yield f'<text x="{MARGIN}" y="{top + SHAPE.height / 2 + 1}">{emotion}</text>'
        for column, state in enumerate(_states(emotion)):
            yield _face(draw(state, SHAPE), _left(column), top)


def _states(emotion: str) -> list[FaceState]:
    if emotion == "crash":
        return [FaceState(crash=seconds) for seconds in STILLS]
    return [FaceState(x, y, emotion, much, lid) for _, much, x, y, lid in COLUMNS]


def _left(column: int) -> int:
    return LABEL + column * (SHAPE.width + GAP)


def _face(frame: LightFrame, left: int, top: int) -> str:
    return (
        f'<g transform="translate({left} {top})">'
        f'<rect class="board" x="-0.5" y="-0.5" width="{frame.width + 1}"'
        f' height="{frame.height + 1}" rx="1"/>'
        f'<use href="#dark"/><path class="lit" d="{_dots(frame)}"/></g>'
    )


def _dots(frame: LightFrame) -> str:
    """Each light as a line of no length with round ends."""
    return "".join(
        f"M{column + 0.5:g} {row + 0.5:g}h0"
        for row in range(frame.height)
        for column in range(frame.width)
        if frame.lit(column, row)
    )


if __name__ == "__main__":
    SHEET.write_text(sheet(), encoding="utf-8")
