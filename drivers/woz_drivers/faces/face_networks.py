"""Faces in a picture, by three small neural networks and numpy around them.

MediaPipe's networks as TFLite files, used as their model cards say (BlazeFace full range, Face
Mesh, Iris): the first finds faces in the whole picture, the second 468 points in each face, the
third the iris in each eye. Papers: Bazarevsky et al., "BlazeFace" (2019); Kartynnik et al.,
"Real-time Facial Surface Geometry from Monocular Video" (2019); Ablavatski et al., "Real-time
Pupil Tracking from Monocular Video" (2020).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from woz_drivers.camera.raw_pictures import PictureLayout

#: Numbers of networks and coordinates.
Floats = npt.NDArray[np.float32]
#: Column and row in a picture.
Place = tuple[float, float]
#: A network: its input in, its outputs out, in the order of the file.
Network = Callable[[Floats], Sequence[Floats]]

#: Pixels a side that each network wants.
DETECTION_SIDE, MESH_SIDE, IRIS_SIDE = 192, 192, 64
#: The detection has one anchor in each cell of this many by this many.
_GRID = 48
#: Boxes below this score are no faces; points of the mesh count from the other one on.
_FACE, _MESH = 0.4, 0.5
#: The score of a box in which the mesh finds no face: it may be one that is half hidden.
_DOUBTFUL = 0.45
#: In smaller faces the irises are a pixel or two: nothing can be seen of them. In pixels.
_IRISES_FROM = 60.0
#: Faces smaller than this part of the picture's longer side are looked at where they were.
_SMALL = 0.1
#: They are looked for there in so many pictures.
_REMEMBERED = 8
#: Boxes that share more of their area than this are of one face.
_SAME = 0.3
#: The mesh wants a square so many times as large as the box; the iris, as the eye is wide.
_FACE_MARGIN, _EYE_MARGIN = 1.5, 2.3
#: Points of the mesh: corners of the eye that is left in the picture, outer first, and of the other
#: one, inner first.
_EYES = ((33, 133), (362, 263))


@dataclass(frozen=True, slots=True)
class FoundBox:
    """A face as the detection finds it, in pixels: its box, and eyes, nose, mouth and ears
    (6 x 2; the left ones in the picture come first).
    """

    score: float
    box: Floats  # left, top, right, bottom
    points: Floats

    @property
    def size(self) -> float:
        """The longer side of the box."""
        left, top, right, bottom = self.box
        return float(max(right - left, bottom - top))

    @property
    def middle(self) -> Place:
        """The middle of the box."""
        left, top, right, bottom = map(float, self.box)
        return (left + right) / 2, (top + bottom) / 2

    def covers(self, place: Place) -> bool:
        """Whether a place is inside of the box."""
        left, top, right, bottom = map(float, self.box)
        return left <= place[0] <= right and top <= place[1] <= bottom

    @property
    def tilt(self) -> float:
        """How far the line through the eyes is turned clockwise, in radians."""
        across = self.points[1] - self.points[0]
        return float(np.arctan2(across[1], across[0]))


@dataclass(frozen=True, slots=True)
class FoundFace:
    """A face with its 468 points (x, y, z in pixels of the picture, z away from the camera) and the
    middles of both irises (2 x 2), as far as they were looked for and found.
    """

    box: FoundBox
    mesh: Floats | None = None
    irises: Floats | None = None


@dataclass(frozen=True, slots=True)
class Pixels:
    """Rows and columns of a raw picture, and where they are inside of it; None: everywhere."""

    rows: npt.NDArray[np.intp]
    columns: npt.NDArray[np.intp]
    inside: npt.NDArray[np.bool_] | None


class PictureSampler:
    """One raw picture, of which any pixels can be had as red, green and blue from 0 to 1.

    Whole pictures are never converted: the networks want far fewer pixels than a camera has.
    Places are those in the picture after it has been mirrored or flipped.
    """

    def __init__(
        self, layout: PictureLayout, *, mirrored: bool = False, flipped: bool = False
    ) -> None:
        self.width, self.height = layout.width, layout.height
        self._layout = layout
        self._mirrored, self._flipped = mirrored, flipped
        self._planes: tuple[npt.NDArray[np.uint8], ...] = ()

    def load(self, data: bytes) -> None:
        """Take the next picture."""
        self._planes = self._layout.planes(data)

    def at(self, x: Floats, y: Floats) -> Floats:
        """The pixels nearest to these places, with a last axis of three; black outside."""
        return self.of(self.pixels(x, y))

    def pixels(self, x: Floats, y: Floats) -> Pixels:
        """The pixels nearest to these places."""
        columns, rows = np.rint(x).astype(np.intp), np.rint(y).astype(np.intp)
        inside = (columns >= 0) & (columns < self.width) & (rows >= 0) & (rows < self.height)
        np.clip(columns, 0, self.width - 1, out=columns)
        np.clip(rows, 0, self.height - 1, out=rows)
        if self._mirrored:
            columns = self.width - 1 - columns
        if self._flipped:
            rows = self.height - 1 - rows
        return Pixels(rows, columns, None if inside.all() else inside[..., None])

    def of(self, pixels: Pixels) -> Floats:
        """Their colours, with a last axis of three."""
        colours = self._layout.colours_at(self._planes, pixels.rows, pixels.columns)
        if pixels.inside is not None:
            colours *= pixels.inside
        return colours

    def square(self, centre: Place, size: float, tilt: float, side: int) -> Pixels:
        """A square of `size` pixels about `centre`, turned clockwise by `tilt`, as `side` x `side`
        pixels.
        """
        steps = (np.arange(side, dtype=np.float32) + 0.5) / side * size - size / 2
        cos, sin = math.cos(tilt), math.sin(tilt)
        x = centre[0] + cos * steps[None, :] - sin * steps[:, None]
        y = centre[1] + sin * steps[None, :] + cos * steps[:, None]
        return self.pixels(x.astype(np.float32), y.astype(np.float32))


def turned_back(points: Floats, centre: Place, size: float, tilt: float, side: int) -> Floats:
    """Places in such a square (n x 2 or n x 3) as places in the picture."""
    scaled = np.array(points, np.float32)
    scaled[:, :2] -= side / 2
    scaled *= size / side
    cos, sin = math.cos(tilt), math.sin(tilt)
    x = centre[0] + cos * scaled[:, 0] - sin * scaled[:, 1]
    y = centre[1] + sin * scaled[:, 0] + cos * scaled[:, 1]
    scaled[:, 0], scaled[:, 1] = x, y
    return scaled


# -- the detection -------------------------------------------------------------------------------


def decoded(regressors: Floats, logits: Floats, scale: float, middle: Place) -> list[FoundBox]:
    """What the detection says: all boxes above the threshold, best first.

    Args:
        regressors: 2304 x 16: middle, width and height of the box, then 6 points, all relative to
            the anchor, in pixels of the network.
        logits: 2304.
        scale: Pixels of the picture a pixel of the network.
        middle: Where the network's middle is in the picture.
    """
    scores = 1.0 / (1.0 + np.exp(-np.clip(logits, -80.0, 80.0)))
    [found] = np.nonzero(scores >= _FACE)
    found = found[np.argsort(-scores[found], kind="stable")]
    cell = DETECTION_SIDE / _GRID
    anchors = np.stack((found % _GRID + 0.5, found // _GRID + 0.5), axis=-1) * cell
    boxes = []
    for anchor, row, score in zip(anchors, regressors[found], scores[found], strict=True):
        half = row[2:4] / 2
        places = np.concatenate(([row[:2] - half, row[:2] + half], row[4:].reshape(6, 2))) + anchor
        places = ((places - DETECTION_SIDE / 2) * scale + middle).astype(np.float32)
        boxes.append(FoundBox(float(score), places[:2].reshape(4), places[2:]))
    return boxes


def merged(boxes: Sequence[FoundBox]) -> list[FoundBox]:
    """One box for each face: the mean, by score, of those that overlap the best one."""
    left, faces = list(boxes), []
    while left:
        best = left[0]
        same = [one for one in left if one is best or overlap(best.box, one.box) > _SAME]
        left = [one for one in left if not any(one is other for other in same)]
        weights = np.array([one.score for one in same], np.float32)
        weights /= weights.sum()
        box = np.tensordot(weights, np.stack([one.box for one in same]), 1)
        points = np.tensordot(weights, np.stack([one.points for one in same]), 1)
        faces.append(FoundBox(best.score, box, points))
    return faces


def overlap(one: Floats, other: Floats) -> float:
    """What two boxes share, as a part of what they cover together."""
    low = np.maximum(one[:2], other[:2])
    high = np.minimum(one[2:], other[2:])
    shared = float(np.prod(np.maximum(high - low, 0.0)))
    covered = float(np.prod(one[2:] - one[:2]) + np.prod(other[2:] - other[:2])) - shared
    return shared / covered if covered > 0 else 0.0


# -- all three -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class View:
    """An upright square of a picture in which faces are looked for."""

    middle: Place
    size: float
    pixels: Pixels


class FaceNetworks:
    """Finds faces in raw pictures of one layout.

    With `far` it looks at a part of each picture a second time, twice as large: in turns at all
    parts, and at every second picture where a small face was. A face that is found there alone is
    found in every second picture.
    """

    def __init__(
        self,
        sampler: PictureSampler,
        detection: Network,
        mesh: Network,
        iris: Network,
        *,
        far: bool = False,
    ) -> None:
        self._sampler = sampler
        self._size = float(max(sampler.width, sampler.height))
        middle = ((sampler.width - 1) / 2, (sampler.height - 1) / 2)
        self._whole = self._view(middle, self._size)
        self._parts = [*self._overlapping_parts()] if far else []
        self._turn = 0
        #: Middles of small faces, and in which turn each was found.
        self._small: dict[Place, int] = {}
        self._detection, self._mesh, self._iris = detection, mesh, iris

    def find(self, data: bytes, closely: int) -> list[FoundFace]:
        """All faces of a picture, largest first; the first `closely` with mesh and irises."""
        self._sampler.load(data)
        boxes = sorted(self._boxes(), key=lambda box: -box.size)
        near = [self._look_closely(box) for box in boxes[:closely]]
        return [*near, *(FoundFace(box) for box in boxes[closely:])]

    def _boxes(self) -> list[FoundBox]:
        boxes = self._seen(self._whole)
        if self._parts:
            part = self._next_part()
            boxes += [box for box in self._seen(part) if self._is_whole(box, part)]
            boxes.sort(key=lambda box: -box.score)
        faces = merged(boxes)
        for box in faces:
            # Where it was before is where it is now.
            self._small = {
                place: turn for place, turn in self._small.items() if not box.covers(place)
            }
            if box.size < _SMALL * self._size:
                self._small[box.middle] = self._turn
        self._small = {
            place: turn for place, turn in self._small.items() if self._turn - turn <= _REMEMBERED
        }
        return faces

    def _seen(self, view: View) -> list[FoundBox]:
        pixels = self._sampler.of(view.pixels)
        pixels *= 2
        pixels -= 1
        regressors, logits = self._detection(pixels[None])
        scale = view.size / DETECTION_SIDE
        return decoded(regressors[0], logits.reshape(-1), scale, view.middle)

    def _view(self, middle: Place, size: float) -> View:
        return View(middle, size, self._sampler.square(middle, size, 0.0, DETECTION_SIDE))

    def _overlapping_parts(self) -> Iterator[View]:
        """Squares half as large as the picture, each half over the next one."""
        side = self._size / 2
        for y in _middles(self._sampler.height, side):
            for x in _middles(self._sampler.width, side):
                yield self._view((x, y), side)

    def _next_part(self) -> View:
        self._turn += 1
        turn, at_small = divmod(self._turn, 2)
        if at_small and self._small:
            return self._view([*self._small][turn % len(self._small)], self._size / 2)
        return self._parts[(turn if self._small else self._turn) % len(self._parts)]

    def _is_whole(self, box: FoundBox, part: View) -> bool:
        """Whether a box does not reach over the edge of a part, but for edges of the picture."""
        low = np.array(part.middle) - part.size / 2
        high = np.minimum(low + part.size, (self._sampler.width, self._sampler.height))
        low = np.maximum(low, 0)
        return bool(
            np.all((box.box[:2] >= low) | (low == 0))
            and np.all(
                (box.box[2:] <= high) | (high >= (self._sampler.width, self._sampler.height))
            )
        )

    def _look_closely(self, box: FoundBox) -> FoundFace:
        sampler = self._sampler
        middle = box.middle
        size, tilt = _FACE_MARGIN * box.size, box.tilt
        points, score = self._mesh(sampler.of(sampler.square(middle, size, tilt, MESH_SIDE))[None])
        if float(score.reshape(())) < np.log(_MESH / (1 - _MESH)):
            return FoundFace(replace(box, score=min(box.score, _DOUBTFUL)))
        mesh = turned_back(points.reshape(-1, 3), middle, size, tilt, MESH_SIDE)
        if box.size < _IRISES_FROM:
            return FoundFace(box, mesh)
        irises = [self._iris_of(mesh, eye, mirrored=eye is _EYES[0]) for eye in _EYES]
        return FoundFace(box, mesh, np.stack(irises))

    def _iris_of(self, mesh: Floats, eye: tuple[int, int], *, mirrored: bool) -> Floats:
        """The middle of an iris. The network knows eyes of one side: the other is mirrored."""
        first, last = mesh[eye[0], :2], mesh[eye[1], :2]
        across = last - first
        middle = (float(first[0] + last[0]) / 2, float(first[1] + last[1]) / 2)
        size = _EYE_MARGIN * float(np.hypot(*across))
        tilt = float(np.arctan2(across[1], across[0]))
        pixels = self._sampler.of(self._sampler.square(middle, size, tilt, IRIS_SIDE))
        _, iris = self._iris((pixels[:, ::-1] if mirrored else pixels)[None])
        place = iris.reshape(-1, 3)[:1, :2].copy()
        if mirrored:
            place[:, 0] = IRIS_SIDE - place[:, 0]
        found: Floats = turned_back(place, middle, size, tilt, IRIS_SIDE)[0]
        return found


def _middles(pixels: int, side: float) -> list[float]:
    """Of squares in a row of so many pixels, each half over the next one."""
    if pixels <= side:
        return [(pixels - 1) / 2]
    count = math.ceil((pixels - side) / (side / 2)) + 1
    return [float(one) for one in np.linspace((side - 1) / 2, pixels - (side + 1) / 2, count)]


def interpreted(path: str) -> Network:
    """A TFLite file as a network, on one thread. Imported here: it is an extra."""
    from ai_edge_litert.interpreter import Interpreter  # noqa: PLC0415

    interpreter: Any = Interpreter(path, num_threads=1)
    interpreter.allocate_tensors()
    [entry] = interpreter.get_input_details()
    outputs = [one["index"] for one in interpreter.get_output_details()]

    def run(pixels: Floats) -> Sequence[Floats]:
        interpreter.set_tensor(entry["index"], np.ascontiguousarray(pixels, np.float32))
        interpreter.invoke()
        return [interpreter.get_tensor(index) for index in outputs]

    return run
