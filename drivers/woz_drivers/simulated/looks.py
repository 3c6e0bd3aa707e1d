"""What the simulated robot looks like on a console: a trunk with a head, and a face of lights."""

from __future__ import annotations

from woz_drivers.simulated.settings import SimulatedSettings
from woz_tui.motion.body_shape import FaceShape
from woz_tui.motion.emotions import NEUTRAL
from woz_tui.motion.face_drawing import FaceState, draw
from woz_tui.protocol.messages import FaceShown, Json

_FACE = FaceShape()
#: From the base up: the setting that names the joint, its axis, and metres above the one
#: before. Positive angles bend and look down.
_LINKS = (
    ("hip_joint", "y", 0.10),
    ("hip_roll_joint", "x", 0.0),
    ("yaw_joint", "z", 0.22),
    ("pitch_joint", "y", 0.05),
)
#: Before and above the last joint, in metres.
_EYES = (0.07, 0.07)


def outline(settings: SimulatedSettings) -> dict[str, Json]:
    """Links and face, as a console draws them; empty where another driver has the body."""
    if settings.voice_only:
        return {}
    joints: list[Json] = []
    below = 0.0
    for role, axis, height in _LINKS:
        below += height
        name = getattr(settings, role)
        joint = settings.joints.get(name)
        if joint is not None:
            limits: dict[str, Json] = {"min": joint.low, "max": joint.high, "home": joint.home}
            joints.append({"name": name, "axis": axis, "offset": [0.0, 0.0, below], **limits})
            below = 0.0
    eyes: Json = [_EYES[0], 0.0, below + _EYES[1]]
    face: Json = {"width": _FACE.width, "height": _FACE.height}
    return {"kind": "body", "joints": joints, "eyes": eyes, "view": "x", "face": face}


def face(emotion: str = NEUTRAL, intensity: float = 0.0, mouth: float = 0.0) -> FaceShown:
    """The face with this emotion; one that nobody knows looks neutral. `mouth`: how wide that is
    open, 0 to 1.
    """
    frame = draw(FaceState(emotion=emotion, intensity=intensity, mouth=mouth), _FACE)
    return FaceShown(width=frame.width, rows=frame.hex, emotion=emotion, intensity=intensity)
