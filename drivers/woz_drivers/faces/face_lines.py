"""The lines that a program writes which finds faces: one JSON object for each picture."""

from __future__ import annotations

from typing import Annotated

import msgspec

_Angle = Annotated[float, msgspec.Meta(ge=-180.0, le=180.0)]


class SeenFace(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A face in a picture, turned as the settings say.

    `left` ... `bottom`: its box in pixels. `width`: of the face itself between its sides, in
    pixels. Angles in degrees: yaw to the right of the picture, pitch down, roll clockwise, of the
    head; `eyes_yaw` of the eyes in it. Without yaw and pitch nobody knows where it looks.
    """

    left: float
    top: float
    right: float
    bottom: float
    width: Annotated[float, msgspec.Meta(gt=0.0)]
    score: Annotated[float, msgspec.Meta(ge=0.0, le=1.0)] = 1.0
    yaw: _Angle | None = None
    pitch: _Angle | None = None
    roll: _Angle | None = None
    eyes_yaw: _Angle = 0.0


class FacesLine(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """All faces of a picture, and how many milliseconds it took."""

    faces: list[SeenFace]
    ms: float = 0.0


#: Longer lines are no answers, in bytes.
LONGEST = 65_536
_DECODER = msgspec.json.Decoder(FacesLine)


def decoded_line(line: bytes) -> FacesLine:
    """Raises `ValueError` for anything else."""
    return _DECODER.decode(line)
