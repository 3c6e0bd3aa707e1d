"""The lines of the programs that find faces (a JSON object for each picture) and recognise them."""

from __future__ import annotations

from typing import Annotated

import msgspec

from woz_tui.system.foreign_json import decode_foreign

_Angle = Annotated[float, msgspec.Meta(ge=-180.0, le=180.0)]
_Pixels = Annotated[float, msgspec.Meta(ge=-1e5, le=1e5)]


class SeenFace(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A face in a picture, turned as the settings say.

    `left` ... `bottom`: its box in pixels. `width`: of the face itself between its sides, in
    pixels. Angles in degrees: yaw to the right of the picture, pitch down, roll clockwise, of the
    head; `eyes_yaw` of the eyes in it, where they are seen. Without yaw and pitch nobody knows
    where it looks.
    `points`: column and row of both eyes (left one in the picture first), the tip of the nose and
    both corners of the mouth. Without them nobody knows whose it is.
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
    eyes_yaw: _Angle | None = None
    points: Annotated[list[tuple[_Pixels, _Pixels]], msgspec.Meta(max_length=5)] = []


class FacesLine(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """All faces of a picture, and how many milliseconds it took."""

    faces: list[SeenFace]
    ms: float = 0.0


class RecogniserAnswer(msgspec.Struct, frozen=True):
    """What the program that recognises faces answers: see `face_recogniser`."""

    name: str = ""
    likeness: float = 0.0
    names: list[str] = []
    refused: str = ""
    remedy: str = ""


#: Longer lines are no answers, in bytes.
LONGEST = 65_536
_DECODER = msgspec.json.Decoder(FacesLine)


def decoded_line(line: bytes) -> FacesLine:
    """Raises `ValueError` for anything else."""
    return decode_foreign(line, _DECODER)
