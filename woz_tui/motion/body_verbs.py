"""The verbs and controls of a body, and the mode rule that each follows.

The bus, a script for `woz render` and the engine share these: an input is a verb and its arguments.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from woz_tui.drivers.contract import Argument, Verb
from woz_tui.drivers.fields import Range
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
_ANGLE = Range(-180, 180, "deg")
#: No movement takes longer than a day.
_DAY = Range(0, 86_400, "s")
_SECONDS = Argument("seconds", "seconds", "in how long; empty: as fast as it may", range=_DAY)
_EASING = Argument("easing", "choice", "how it gets there", choices=GAZE_EASINGS)


def body_verbs(shape: BodyShape, moves: Iterable[str]) -> tuple[Verb, ...]:
    """The verbs of a body with these moves."""
    joints = Argument("joints", "joints", "degrees by joint", required=True)
    body = (
        Verb(
            "play",
            "play a move",
            (
                Argument("move", "choice", "which one", required=True, choices=tuple(moves)),
                Argument("speed", "number", "1: as written", default=1.0, range=Range(0.1, 5)),
                Argument("amplitude", "number", "1: as written", default=1.0, range=Range(0, 3)),
            ),
            lane="body",
            limit_s=120.0,
        ),
        Verb("pose", "take a pose", (joints, _SECONDS, _EASING), lane="body"),
        Verb(
            "poses",
            "take poses one after the other",
            (Argument("poses", "poses", "joints and seconds", required=True), _EASING),
            lane="body",
            limit_s=120.0,
        ),
        Verb(
            "home",
            "take the home pose",
            (Argument("seconds", "seconds", "in how long", default=1.0, range=_DAY), _EASING),
            lane="body",
        ),
        Verb(
            "gaze",
            "look at a direction, or at a point in space",
            (
                Argument("yaw", "number", "to its left", range=_ANGLE),
                Argument("pitch", "number", "downwards", range=Range(-90, 90, "deg")),
                Argument("x", "number", "forward from the base", range=Range(-100, 100, "m")),
                Argument("y", "number", "to its left", range=Range(-100, 100, "m")),
                Argument("z", "number", "above the base", range=Range(-100, 100, "m")),
                _SECONDS,
                _EASING,
            ),
            lane="body",
            stream=True,
        ),
        Verb(
            "nudge",
            "look a bit further",
            (
                Argument("yaw", "number", "to its left", default=0.0, range=_ANGLE),
                Argument("pitch", "number", "downwards", default=0.0, range=_ANGLE),
            ),
            lane="body",
            stream=True,
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
                    choices=(*shape.joints, *CONTROLS),
                ),
                Argument("value", "number", "to this place", range=_UNIT),
                Argument("by", "number", "or by so much", range=_BOTH),
            ),
            lane="control",
            brief=True,
        ),
        Verb(
            "mode",
            "change the mode; normal ends whatever goes on",
            (
                Argument(
                    "mode",
                    "choice",
                    required=True,
                    choices=tuple(mode.value for mode in Mode),
                ),
            ),
            lane="mode",
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
        ),
        Verb(
            "breathing",
            "breathe or hold its breath",
            (Argument("on", "flag", required=True),),
            lane="way",
            brief=True,
        ),
    )
    return body if shape.face is None else (*body, *_FACE_VERBS)


_FACE_VERBS = (
    Verb(
        "emotion",
        "show an emotion",
        (
            Argument("emotion", "choice", required=True, choices=EMOTIONS),
            Argument("intensity", "number", "empty: as it was", range=_UNIT),
        ),
        lane="face",
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
    ),
)
