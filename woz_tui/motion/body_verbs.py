"""The verbs and controls of a body, and the mode rule that each follows.

The bus, a script for `woz render` and the engine share these: an input is a verb and its arguments.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from woz_tui.drivers.contract import Argument, Verb
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.motion.body_shape import GAZE_EASINGS, BodyShape
from woz_tui.motion.control_scales import TRAITS
from woz_tui.motion.modes import InputKind, Mode
from woz_tui.motion.personality import RANGES, SUMMARIES

#: Emotions that a face knows; the first has no intensity. The first six are Oosterkamp's.
EMOTIONS = ("neutral", "sleepy", "angry", "sad", "happy", "amazed", "friendly", "crash")
#: Verbs whose end nobody waits for, beside all streams: the next emotion must not wait for the film
#: of a crash to end.
BRIEF = frozenset({"emotion"})
#: Verb -> its row of the table. `mode: normal` is the stop, whatever this says of `mode`.
KINDS: Mapping[str, InputKind] = {
    "play": InputKind.ANIMATION,
    "play_move": InputKind.ANIMATION,
    "pose": InputKind.POSE,
    "poses": InputKind.POSE,
    "home": InputKind.POSE,
    "gaze": InputKind.POSE,
    "nudge": InputKind.POSE,
    "joints": InputKind.JOINTS,
    "emotion": InputKind.EMOTION,
    "affect": InputKind.EMOTION,
    "look": InputKind.EYES,
    "brightness": InputKind.FACE,
    "blink": InputKind.FACE,
    "blinking": InputKind.FACE,
    "breathing": InputKind.PERSONALITY,
    "personality": InputKind.PERSONALITY,
    "mode": InputKind.MODE,
}

#: Controls that every body has, and the row of each; a joint's own control, called as the joint, is
#: among the joint controls.
CONTROL_KINDS: Mapping[str, InputKind] = {
    "zoom": InputKind.JOINTS,
    "eye-x": InputKind.EYES,
    "eye-y": InputKind.EYES,
    "intensity": InputKind.EMOTION,
    "valence": InputKind.EMOTION,
    "arousal": InputKind.EMOTION,
    "brightness": InputKind.FACE,
    **dict.fromkeys(TRAITS, InputKind.PERSONALITY),
}

CONTROLS = tuple(CONTROL_KINDS)

_UNIT = Range(0, 1)
_BOTH = Range(-1, 1)
_ANGLE, _METRES = Range(-180, 180, "degrees"), Range(-100, 100, "m")
#: No movement takes longer than a day.
_DAY = Range(0, 86_400, "s")
_PACE = Argument("speed", "number", "1: as written", default=1.0, range=Range(0.1, 5))
_SIZE = Argument("amplitude", "number", "1: as written", default=1.0, range=Range(0, 3))
_SECONDS = Argument("seconds", "seconds", "in how long; empty: as fast as it may", range=_DAY)
_EASING = Argument("easing", "choice", "how it gets there", choices=GAZE_EASINGS)


def body_verbs(shape: BodyShape, moves: Iterable[str]) -> tuple[Verb, ...]:
    """The verbs of a body with these moves."""
    joints = Argument("joints", "joints", "degrees by joint", required=True)
    body = (
        common_verb(
            "play",
            "",
            _PACE,
            _SIZE,
            choices=tuple(moves),
        ),
        Verb(
            "play_move",
            "play a move that is given whole, as the text of a move file",
            (
                Argument("move", "text", "name, frames and layers", required=True),
                _PACE,
                _SIZE,
            ),
            lane="body",
            limit_s=120.0,
        ),
        common_verb("pose", "", _SECONDS, _EASING, limit_s=30.0, arrives=True),
        common_verb("poses", "", _EASING, limit_s=120.0, arrives=True),
        common_verb(
            "home",
            "",
            replace(_SECONDS, summary="in how long", default=1.0),
            _EASING,
            arrives=True,
        ),
        common_verb(
            "gaze",
            "look in a direction, or at a point in space",
            Argument("pitch", "number", "down is positive", range=Range(-90, 90, "degrees")),
            Argument("x", "number", "forward from the base", range=_METRES),
            Argument("y", "number", "to its left", range=_METRES),
            Argument("z", "number", "above the base", range=_METRES),
            _SECONDS,
            _EASING,
            lane="body",
            arrives=True,
        ),
        common_verb(
            "nudge",
            "",
            Argument("yaw", "number", "left is positive", default=0.0, range=_ANGLE),
            Argument("pitch", "number", "down is positive", default=0.0, range=_ANGLE),
            lane="body",
            stream=True,
            brief=False,
            limit_s=30.0,
        ),
        Verb("joints", "joints directly, as fast as they may", (joints,), lane="body", stream=True),
        Verb(
            "control",
            "turn a knob: a joint's own control, or one of the body's",
            (
                Argument(
                    "control",
                    "choice",
                    "which one",
                    required=True,
                    choices=(*shape.joints, *CONTROLS, *shape.controls),
                ),
                Argument("value", "number", "to this place", range=_UNIT),
                Argument("by", "number", "or by so much", range=_BOTH),
            ),
            lane="control",
            brief=True,
        ),
        common_verb(
            "mode",
            "change the mode; normal ends whatever goes on",
            choices=tuple(mode.value for mode in Mode),
            lane="mode",
            evidence="",
        ),
        Verb(
            "personality",
            "be another character, or change a trait",
            (
                Argument(
                    "name",
                    "choice",
                    "one of the robot file's",
                    default="",
                    choices=("", *shape.personalities),
                ),
                *(
                    Argument(name, "number", text, range=RANGES[name])
                    for name, text in SUMMARIES.items()
                ),
            ),
            lane="way",
            brief=True,
            evidence="",
        ),
        Verb(
            "breathing",
            "breathe or hold its breath",
            (Argument("on", "flag", required=True),),
            lane="way",
            brief=True,
            evidence="",
        ),
    )
    return body if shape.face is None else (*body, *_FACE_VERBS)


_FACE_VERBS = (
    common_verb(
        "emotion",
        "",
        Argument("intensity", "number", "empty: as it was", range=_UNIT),
        choices=EMOTIONS,
    ),
    Verb(
        "affect",
        "show what a mood looks like (Russell's circle)",
        (
            Argument("valence", "number", "bad to good", required=True, range=_BOTH),
            Argument("arousal", "number", "calm to excited", required=True, range=_BOTH),
        ),
        lane="face",
        stream=True,
    ),
    Verb(
        "look",
        "where the eyes look on the face",
        (
            Argument("x", "number", "right to left", default=0.0, range=_BOTH),
            Argument("y", "number", "down to up", default=0.0, range=_BOTH),
        ),
        lane="face",
        stream=True,
    ),
    Verb(
        "brightness",
        "of the lights",
        (Argument("level", "number", required=True, range=_UNIT),),
        lane="face",
        brief=True,
    ),
    Verb("blink", "blink once", lane="face"),
    Verb(
        "blinking",
        "blink by itself or not",
        (Argument("on", "flag", required=True),),
        lane="face",
        brief=True,
        evidence="",
    ),
)
