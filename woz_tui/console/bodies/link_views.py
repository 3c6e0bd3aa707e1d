"""The links of a body from the side and from above, as dots.

Kinematics only, as the robot's own program computes them. Both views of a body have one scale,
which follows from what the body can reach and never changes, so a moving robot moves and nothing
else does. From the side, front is at the right; from above, front is up.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from woz_tui.console.drawing.dot_canvas import ACROSS, DOWN, Dot, DotCanvas, DotLayer
from woz_tui.console.state.driver_outlines import BodyOutline

if TYPE_CHECKING:
    from woz_tui.motion.body_shape import Vector

#: From the lowest to the highest: the ground, where the eyes look, where the body shall be, where
#: it is.
LAYERS: Mapping[str, DotLayer] = {
    "ground": DotLayer("faint", "-"),
    "gaze": DotLayer("run", "."),
    "wanted": DotLayer("muted", ":", yields=True),
    "links": DotLayer("strong", "#"),
    "joints": DotLayer("strong", "O"),
}
STALE_LAYERS: Mapping[str, DotLayer] = {
    name: layer._replace(look="stale" if name in ("links", "joints") else "faint")
    for name, layer in LAYERS.items()
}
#: Marks around a joint, and around the middle between the eyes.
JOINT = ((0, 0), (-1, 0), (1, 0), (0, -1), (0, 1))
EYES = ((-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1))
#: Of the line of sight one dot in so many is drawn, and so many dots of it altogether.
SPARSE, GAZE = 3, 16
#: Poses that are tried to find out what a body reaches, and the steps between them in degrees.
MOST_POSES, STEPS = 1000, (30.0, 45.0, 60.0, 90.0, 180.0, 7200.0)
#: What is kept free around the farthest reach, as a share of it.
MARGIN = 0.08

PlanePoint = tuple[float, float]


SIDE, ABOVE = "side", "above"


def _flat(view: str, point: Vector) -> PlanePoint:
    """A place as seen in a view: to the right and up."""
    front, left, up = point
    return (front, up) if view == SIDE else (-left, front)


@dataclass(frozen=True, slots=True)
class Extent:
    """From where to where something goes, in metres: to the right and up."""

    left: float
    right: float
    bottom: float
    top: float


@functools.lru_cache(maxsize=32)
def _reach(outline: BodyOutline) -> Mapping[str, Extent]:
    """What the body can reach, as seen in each view; the base and the ground are within it."""
    points = [point for pose in _poses(outline) for point in outline.chain.points(pose)]
    points.append((0.0, 0.0, 0.0))
    found = {}
    for view in (SIDE, ABOVE):
        across, up = zip(*(_flat(view, point) for point in points), strict=True)
        margin = MARGIN * max(max(across) - min(across), max(up) - min(up), 0.01)
        found[view] = Extent(
            min(across) - margin, max(across) + margin, min(up) - margin / 2, max(up) + margin
        )
    return found


def _poses(outline: BodyOutline) -> list[dict[str, float]]:
    """The body's poses on a grid between its limits, as fine as can be tried in a moment."""
    for step in STEPS:
        grid = []
        for low, high in outline.limits.values():
            steps = max(1, math.ceil((high - low) / step))
            grid.append([low + (high - low) * number / steps for number in range(steps + 1)])
        if math.prod(map(len, grid)) <= MOST_POSES:
            return [
                dict(zip(outline.limits, angles, strict=True))
                for angles in itertools.product(*grid)
            ]
    return [dict(outline.home)]


@dataclass(frozen=True, slots=True)
class Projection:
    """How one view puts places in metres onto a sheet's dots."""

    view: str
    scale: float
    left: float
    top: float

    def dot(self, point: Vector) -> Dot:
        """The dot nearest to a place."""
        across, up = _flat(self.view, point)
        return round((across - self.left) * self.scale), round((self.top - up) * self.scale)


def projections(
    outline: BodyOutline, sizes: Mapping[str, tuple[int, int]]
) -> dict[str, Projection]:
    """The views on sheets of these sizes (cells), all in one scale: what is reached fits."""
    reach = {view: _reach(outline)[view] for view in sizes}
    scale = min(
        min(
            (columns * ACROSS - 1) / (reach[view].right - reach[view].left),
            (lines * DOWN - 1) / (reach[view].top - reach[view].bottom),
        )
        for view, (columns, lines) in sizes.items()
    )
    found = {}
    for view, (columns, lines) in sizes.items():
        span = reach[view]
        spare = ((columns * ACROSS - 1) / scale - (span.right - span.left)) / 2
        above = (lines * DOWN - 1) / scale - (span.top - span.bottom)
        if view == ABOVE:
            above /= 2  # in the middle; from the side it stands at the bottom
        found[view] = Projection(view, scale, span.left - spare, span.top + above)
    return found


@dataclass(frozen=True, slots=True)
class Pose:
    """Where the joints are and where they shall be, in degrees. None: no data."""

    reached: Mapping[str, float] | None
    wanted: Mapping[str, float] | None
    stale: bool = False


def draw_view(
    outline: BodyOutline, pose: Pose, sight: Projection, size: tuple[int, int]
) -> DotCanvas:
    """One view of a body."""
    sheet = DotCanvas(*size, STALE_LAYERS if pose.stale else LAYERS)
    x, y = sight.dot((0.0, 0.0, 0.0))
    if sight.view == SIDE:  # the floor; from above a cross where the base stands
        sheet.line((0, y), (sheet.width * ACROSS - 1, y), "ground", every=2)
    else:
        sheet.line((x - 3, y), (x + 3, y), "ground")
        sheet.line((x, y - 3), (x, y + 3), "ground")
    here = pose.reached if pose.reached is not None else pose.wanted
    if here is None:
        return sheet
    if pose.reached is not None and pose.wanted is not None:
        _links(sheet, sight, outline, pose.wanted, "wanted")
    origin, direction = outline.chain.ray(here)
    far = GAZE / sight.scale  # some way along the line of sight
    end = tuple(at + far * along for at, along in zip(origin, direction, strict=True))
    sheet.line(sight.dot(origin), sight.dot((end[0], end[1], end[2])), "gaze", every=SPARSE)
    _links(sheet, sight, outline, here, "links")
    *joints, eyes = outline.chain.points(here)
    for joint in joints[1:]:
        sheet.stamp(sight.dot(joint), JOINT, "joints")
    sheet.stamp(sight.dot(eyes), EYES, "joints")
    return sheet


def _links(
    sheet: DotCanvas,
    sight: Projection,
    outline: BodyOutline,
    angles: Mapping[str, float],
    layer: str,
) -> None:
    dots = [sight.dot(point) for point in outline.chain.points(angles)]
    for start, end in itertools.pairwise(dots):
        sheet.line(start, end, layer)
