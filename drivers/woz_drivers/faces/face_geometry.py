"""Where a face is turned, where it looks, how wide it is: arithmetic on its points.

Angles are in degrees, as seen in the picture: yaw to the right, pitch down, roll clockwise. Yaw and
pitch are those of the head set upright again, so that a tilted head that looks into the camera has
about none; what the points of every face lean by themselves is taken away by calibration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from woz_drivers.faces.face_networks import Floats, FoundFace, PictureSampler

#: Points of the mesh: the sides of the face before the ears (left one in the picture first), the
#: top of the forehead, the chin.
_SIDES, _TOP, _CHIN = (234, 454), 10, 152
#: Outer and inner corner of the eye that is left in the picture, inner and outer of the other one.
_CORNERS = ((33, 133), (362, 263))
#: The tip of the nose, the corners of the mouth (left one in the picture first).
_NOSE, _MOUTH = 1, (61, 291)
#: An eye is so many times as wide between its corners as the eyeball's radius (30 mm by 12 mm).
_EYE_BY_RADIUS = 2.5
#: Pixels a side of a crop.
CROP_SIDE = 112
#: Where the eyes (left one in the picture first), the tip of the nose and the corners of the mouth
#: are in a crop, in pixels: those of ArcFace (Deng et al., 2019), with which SFace was trained.
CROP_PLACES = ((38.29, 51.70), (73.53, 51.50), (56.03, 71.74), (41.55, 92.37), (70.73, 92.20))
#: A box of the detection is so many times as wide as that, measured on faces from the front.
_BOX_BY_FACE = 1.12


@dataclass(frozen=True, slots=True)
class FacePose:
    """Angles of the head, and how far the eyes are turned in it to the side (up and down the lids
    hide it); None: not looked at closely.
    `width`: between the sides of the face, in pixels, as if seen from the front.
    """

    width: float
    yaw: float | None = None
    pitch: float | None = None
    roll: float | None = None
    eyes_yaw: float = 0.0


def pose_of(face: FoundFace) -> FacePose:
    """What the points say."""
    if face.mesh is None:
        width = float(face.box.box[2] - face.box.box[0])
        return FacePose(width / _BOX_BY_FACE, roll=float(np.degrees(face.box.tilt)))
    side = face.mesh[_SIDES[1]] - face.mesh[_SIDES[0]]
    tilt = float(np.arctan2(side[1], side[0]))
    ahead, width = _ahead(_upright(face.mesh, tilt))
    yaw = float(np.degrees(np.arctan2(ahead[0], -ahead[2])))
    pitch = float(np.degrees(np.arcsin(np.clip(ahead[1], -1.0, 1.0))))
    roll = float(np.degrees(tilt))
    eyes_yaw = 0.0 if face.irises is None else _eyes_yaw(face.mesh, face.irises)
    return FacePose(width, yaw, pitch, roll, eyes_yaw)


def points_of(mesh: Floats) -> list[tuple[float, float]]:
    """The middles of both eyes (left one in the picture first), the tip of the nose and the corners
    of the mouth, in pixels.
    """
    eyes = [(mesh[first, :2] + mesh[last, :2]) / 2 for first, last in _CORNERS]
    return [(float(x), float(y)) for x, y in (*eyes, mesh[_NOSE, :2], *mesh[list(_MOUTH), :2])]


def _upright(mesh: Floats, tilt: float) -> Floats:
    """The points turned back by `tilt` radians in the picture's plane."""
    cos, sin = np.cos(tilt), np.sin(tilt)
    turned = np.array(mesh)
    turned[:, 0] = cos * mesh[:, 0] + sin * mesh[:, 1]
    turned[:, 1] = cos * mesh[:, 1] - sin * mesh[:, 0]
    return turned


def _ahead(mesh: Floats) -> tuple[Floats, float]:
    """Where an upright head points (x right, y down, z away; length 1), and the face's width."""
    side = mesh[_SIDES[1]] - mesh[_SIDES[0]]
    width = float(np.linalg.norm(side))
    # Right and down give away from the camera; ahead is towards it.
    ahead = np.cross(mesh[_CHIN] - mesh[_TOP], side)
    return (ahead / max(float(np.linalg.norm(ahead)), 1e-6)).astype(np.float32), width


def _eyes_yaw(mesh: Floats, irises: Floats) -> float:
    """How far both eyes are turned in the head, by where the irises are between the corners."""
    turned = []
    for corners, iris in zip(_CORNERS, irises, strict=True):
        first, last = mesh[corners[0], :2], mesh[corners[1], :2]
        across = last - first
        width = max(float(np.hypot(*across)), 1e-6)
        offset = float((iris - (first + last) / 2) @ across) / width**2
        turned.append(np.arcsin(np.clip(offset * _EYE_BY_RADIUS, -1.0, 1.0)))
    return float(np.degrees(np.mean(turned)))


def crop_of(sampler: PictureSampler, points: Sequence[tuple[float, float]]) -> bytes:
    """A face as the recogniser wants it: turned, scaled and moved so that its five points lie as
    near as can be to `CROP_PLACES`; each pixel is the mean of four.
    """
    wanted, found = (np.array([complex(x, y) for x, y in one]) for one in (CROP_PLACES, points))
    middle, place = wanted.mean(), found.mean()
    # Least squares: a complex factor turns and scales.
    factor = np.vdot(wanted - middle, found - place) / np.vdot(wanted - middle, wanted - middle)
    steps = (np.arange(2 * CROP_SIDE) + 0.5) / 2 - 0.5
    at = factor * (steps[None, :] + 1j * steps[:, None] - middle) + place
    colours = sampler.at(at.real.astype(np.float32), at.imag.astype(np.float32))
    pixels: Floats = colours.reshape(CROP_SIDE, 2, CROP_SIDE, 2, 3).mean(axis=(1, 3))
    return np.rint(pixels * 255).astype(np.uint8).tobytes()
