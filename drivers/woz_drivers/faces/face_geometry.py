"""Where a face is turned, where it looks, how wide it is: arithmetic on its points.

Angles are in degrees, as seen in the picture: yaw to the right, pitch down, roll clockwise. Yaw and
pitch are those of the head set upright again, so that a tilted head that looks into the camera has
about none; what the points of every face lean by themselves is taken away by calibration.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from woz_drivers.faces.face_networks import Floats, FoundBox, FoundFace

#: Points of the mesh: the sides of the face before the ears (left one in the picture first), the
#: top of the forehead, the chin.
_SIDES, _TOP, _CHIN = (234, 454), 10, 152
#: Outer and inner corner of the eye that is left in the picture, inner and outer of the other one.
_CORNERS = ((33, 133), (362, 263))
#: An eye is so many times as wide between its corners as the eyeball's radius (30 mm by 12 mm).
_EYE_BY_RADIUS = 2.5
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
        return FacePose(_box_width(face.box) / _BOX_BY_FACE, roll=float(np.degrees(face.box.tilt)))
    side = face.mesh[_SIDES[1]] - face.mesh[_SIDES[0]]
    tilt = float(np.arctan2(side[1], side[0]))
    ahead, width = _ahead(_upright(face.mesh, tilt))
    yaw = float(np.degrees(np.arctan2(ahead[0], -ahead[2])))
    pitch = float(np.degrees(np.arcsin(np.clip(ahead[1], -1.0, 1.0))))
    roll = float(np.degrees(tilt))
    eyes_yaw = 0.0 if face.irises is None else _eyes_yaw(face.mesh, face.irises)
    return FacePose(width, yaw, pitch, roll, eyes_yaw)


def _box_width(box: FoundBox) -> float:
    return float(box.box[2] - box.box[0])


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
