"""Pictures for lights: mounted as the settings say, and patterns for whoever mounts them."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from woz_drivers.led_face.settings import LedFaceSettings
from woz_tui.motion.body_shape import FaceShape
from woz_tui.motion.face_drawing import FaceState, draw
from woz_tui.motion.light_frames import LightFrame, blank


def as_mounted(frame: LightFrame, settings: LedFaceSettings) -> LightFrame:
    """The frame that a matrix must show which is mounted like this, for `frame` to be seen."""
    grid = [[frame.lit(x, y) for x in range(frame.width)] for y in range(frame.height)]
    if settings.mirror:
        grid = [row[::-1] for row in grid]
    for _ in range(int(settings.rotate) // 90):  # a matrix turned clockwise shows it turned back
        grid = [list(row) for row in zip(*grid, strict=True)][::-1]
    return _frame(len(grid[0]), len(grid), lambda x, y: grid[y][x])


def sleeping_face(settings: LedFaceSettings) -> LightFrame:
    """A face with closed eyes."""
    shape = FaceShape(settings.width, settings.height)
    return draw(FaceState(emotion="sleepy", intensity=1.0), shape)


def _frame(width: int, height: int, lit: Callable[[int, int], bool]) -> LightFrame:
    rows = (sum(1 << (width - 1 - x) for x in range(width) if lit(x, y)) for y in range(height))
    return LightFrame(width, tuple(rows))


def _arrow(width: int, height: int) -> LightFrame:
    """An arrow that points up, and a square in the upper left corner: nothing else looks so."""
    middle, head = width // 2, min(width, height) // 2
    return _frame(
        width,
        height,
        lambda x, y: (x == middle and y > 0) or abs(x - middle) == y < head or (x < 2 and y < 2),
    )


#: Pattern -> its picture on a matrix of some width and height.
PATTERNS: Mapping[str, Callable[[int, int], LightFrame]] = {
    "all": lambda width, height: _frame(width, height, lambda x, y: True),
    "none": blank,
    "chessboard": lambda width, height: _frame(width, height, lambda x, y: (x + y) % 2 == 0),
    "rows": lambda width, height: _frame(width, height, lambda x, y: y % 2 == 0),
    "columns": lambda width, height: _frame(width, height, lambda x, y: x % 2 == 0),
    "border": lambda width, height: _frame(
        width, height, lambda x, y: x in (0, width - 1) or y in (0, height - 1)
    ),
    "arrow": _arrow,
}
