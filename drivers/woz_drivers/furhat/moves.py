"""What a Furhat's face and head can do by name: its own gestures, moves of ours, emotions.

The robot's gestures and face parameters are those of the Realtime API. Angles of the neck in face
parameters are degrees; the rest of a face goes from 0 to 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from woz_tui.drivers.fields import Range

#: The robot's own gestures.
GESTURES = (
    *("Smile", "BigSmile", "Wink", "Thoughtful", "Surprise", "Oh", "BrowFrown", "BrowRaise"),
    *("Blink", "CloseEyes", "OpenEyes", "Nod", "Shake", "Roll", "GazeAway"),
    *("ExpressDisgust", "ExpressSad", "ExpressAnger", "ExpressFear"),
)
#: Names that experiments have for them.
COMMON_GESTURES: Mapping[str, str] = {
    "nod": "Nod",
    "shake": "Shake",
    "smile": "Smile",
    "laugh": "BigSmile",
    "greet": "BrowRaise",
    "wave": "BrowRaise",
    "think": "Thoughtful",
    "startle": "Surprise",
    "wink": "Wink",
    "blink": "Blink",
    "frown": "BrowFrown",
    "look-away": "GazeAway",
    "roll": "Roll",
}
_SIDES = ("LEFT", "RIGHT")
_PAIRS = (
    *("BROW_DOWN", "BROW_OUTER_UP", "EYE_BLINK", "EYE_LOOK_DOWN", "EYE_LOOK_IN", "EYE_LOOK_OUT"),
    *("EYE_LOOK_UP", "EYE_SQUINT", "EYE_WIDE", "MOUTH_DIMPLE", "MOUTH_FROWN", "MOUTH_LOWER_DOWN"),
    *("MOUTH_PRESS", "MOUTH_SMILE", "MOUTH_STRETCH", "MOUTH_UPPER_UP", "NOSE_SNEER"),
    "CHEEK_SQUINT",
)
_SINGLE = (
    *("BROW_INNER_UP", "JAW_FORWARD", "JAW_LEFT", "JAW_OPEN", "JAW_RIGHT", "MOUTH_CLOSE"),
    *("MOUTH_FUNNEL", "MOUTH_LEFT", "MOUTH_PUCKER", "MOUTH_RIGHT", "MOUTH_ROLL_LOWER"),
    *("MOUTH_ROLL_UPPER", "MOUTH_SHRUG_LOWER", "MOUTH_SHRUG_UPPER", "CHEEK_PUFF", "TONGUE_OUT"),
)
_ANGLES = ("NECK_PAN", "NECK_TILT", "NECK_ROLL", "GAZE_PAN", "GAZE_TILT")
#: Face parameters with what they may be.
FACE_PARAMETERS: Mapping[str, Range] = {
    **{f"{name}_{side}": Range(0, 1) for name in _PAIRS for side in _SIDES},
    **{name: Range(0, 1) for name in _SINGLE},
    **{name: Range(-30, 30) for name in _ANGLES},
}


def _both(**shares: float) -> dict[str, float]:
    """The same on both sides of the face."""
    return {f"{name}_{side}": share for name, share in shares.items() for side in _SIDES}


#: Emotions as face parameters at full intensity.
EMOTIONS: Mapping[str, Mapping[str, float]] = {
    "neutral": {},
    "happy": _both(MOUTH_SMILE=0.8, CHEEK_SQUINT=0.5, EYE_SQUINT=0.2),
    "friendly": _both(MOUTH_SMILE=0.4, BROW_OUTER_UP=0.2),
    "amazed": {
        **_both(EYE_WIDE=0.8, BROW_OUTER_UP=0.9),
        **{"BROW_INNER_UP": 0.9, "JAW_OPEN": 0.35},
    },
    "sad": {**_both(MOUTH_FROWN=0.7, EYE_LOOK_DOWN=0.2), "BROW_INNER_UP": 0.9},
    "angry": _both(BROW_DOWN=1.0, NOSE_SNEER=0.4, EYE_SQUINT=0.4, MOUTH_PRESS=0.5),
    "sleepy": {**_both(EYE_BLINK=0.55, BROW_OUTER_UP=0.1), "JAW_OPEN": 0.05},
    "afraid": {**_both(EYE_WIDE=0.9, MOUTH_STRETCH=0.6), "BROW_INNER_UP": 1.0},
    "disgusted": _both(NOSE_SNEER=0.9, MOUTH_UPPER_UP=0.5, BROW_DOWN=0.4),
}


@dataclass(frozen=True, slots=True)
class FaceFrame:
    """A piece of a gesture: reached `seconds` after the piece before. Degrees of the head count
    from where it looked before the gesture, left and down positive.
    """

    seconds: float
    face: Mapping[str, float] = field(default_factory=dict)
    yaw: float = 0.0
    pitch: float = 0.0


#: Moves that other robots do with arms and hips, done by a head.
HEAD_MOVES: Mapping[str, tuple[FaceFrame, ...]] = {
    "bow": (FaceFrame(0.6, pitch=22), FaceFrame(0.6, pitch=22), FaceFrame(0.6)),
    "look-around": (
        FaceFrame(0.9, yaw=35, pitch=-5),
        FaceFrame(1.2, yaw=5, pitch=6),
        FaceFrame(1.2, yaw=-35, pitch=-5),
        FaceFrame(0.9),
    ),
    "point-left": (FaceFrame(0.6, yaw=40), FaceFrame(0.8, yaw=40), FaceFrame(0.6)),
    "point-right": (FaceFrame(0.6, yaw=-40), FaceFrame(0.8, yaw=-40), FaceFrame(0.6)),
    "point-middle": (FaceFrame(0.5, pitch=15), FaceFrame(0.8, pitch=15), FaceFrame(0.5)),
    "dance": (
        *(
            FaceFrame(0.5, {**_both(MOUTH_SMILE=0.7), "NECK_ROLL": roll}, yaw=yaw)
            for roll, yaw in ((12, 12), (-12, -12), (12, 12), (-12, -12))
        ),
        FaceFrame(0.5),
    ),
}


def offered_moves(own: Iterable[str]) -> tuple[str, ...]:
    """What `play` takes: the robot's names, the common ones, and those of the robot file."""
    return tuple(sorted({*GESTURES, *COMMON_GESTURES, *HEAD_MOVES, *own}))
