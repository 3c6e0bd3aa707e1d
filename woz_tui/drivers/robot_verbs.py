"""The verbs that robots have in common, so that one experiment runs on many of them.

A driver takes one with `common_verb("gaze")` and says what is different on its robot.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal

from woz_tui.drivers.contract import Argument, Verb
from woz_tui.drivers.fields import Range
from woz_tui.protocol.action_messages import Evidence

#: How lights of the eyes change: not, by lids that close, by coming and going.
EYE_ANIMATIONS = ("steady", "blink", "intermittent")

#: What `utter` sounds like.
NOTES, GIBBERISH = "notes", "gibberish"

_ANGLE, _STEP = Range(-180, 180, "degrees"), Range(-90, 90, "degrees")
_METRES, _TURN = Range(-5, 5, "m"), Range(-360, 360, "degrees")
_UNIT, _BOTH, _SEED = Range(0, 1), Range(-1, 1), Range(0, 2**31 - 1)
_SECONDS = Argument("seconds", "seconds", "0: as fast as it can", default=0.0)
_YAW, _PITCH = "left is positive", "down is positive"

_VERBS = (
    Verb(
        "say",
        "speak a sentence",
        (Argument("text", "text", "what to say", required=True),),
        lane="voice",
        limit_s=180.0,
        markup=(),
    ),
    Verb(
        "sound",
        "play a sound file",
        (Argument("file", "file", "relative to the experiment's folder", required=True),),
        lane="sound",
        limit_s=600.0,
    ),
    Verb(
        "utter",
        "make a sound without words that goes with an emotion",
        (
            Argument("emotion", "choice", "which one; empty: that of the robot's face"),
            Argument("seconds", "number", "how long", default=1.2, range=Range(0.2, 10, "s")),
            Argument("intensity", "number", "0 neutral, 1 full", default=1.0, range=_UNIT),
            Argument("valence", "number", "bad to good, in place of an emotion", range=_BOTH),
            Argument("arousal", "number", "calm to excited, beside it", range=_BOTH),
            Argument("seed", "whole", "the same one gives the same sound", range=_SEED),
            Argument(
                "voice",
                "choice",
                "notes, or syllables without a meaning",
                default=NOTES,
                choices=(NOTES, GIBBERISH),
            ),
        ),
        lane="voice",
        by_mood=True,
    ),
    Verb(
        "volume",
        "set how loud the robot is",
        (Argument("level", "number", "0 mute, 1 full", required=True, range=Range(0, 1)),),
        lane="control",
    ),
    Verb(
        "play",
        "play a move",
        (
            Argument("move", "choice", "which one", required=True),
            Argument("speed", "number", "2 is twice as fast", default=1.0, range=Range(0.1, 4)),
            Argument("amplitude", "number", "size", default=1.0, range=Range(0, 2)),
        ),
        lane="body",
        limit_s=120.0,
    ),
    Verb(
        "pose",
        "take a pose",
        (Argument("joints", "joints", "degrees by joint", required=True), _SECONDS),
        lane="body",
        limit_s=70.0,
    ),
    Verb(
        "poses",
        "pass through poses, one after the other",
        (Argument("poses", "poses", "poses, each with `seconds`", required=True),),
        lane="body",
        limit_s=300.0,
    ),
    Verb("home", "take the home pose", (_SECONDS,), lane="body", limit_s=70.0),
    Verb(
        "gaze",
        "look in a direction",
        (
            Argument("yaw", "number", _YAW, range=_ANGLE),
            Argument("pitch", "number", _PITCH, range=_ANGLE),
        ),
        lane="head",
        stream=True,
    ),
    Verb(
        "nudge",
        "turn the head a step from where it looks",
        (
            Argument("yaw", "number", _YAW, default=0.0, range=_STEP),
            Argument("pitch", "number", _PITCH, default=0.0, range=_STEP),
        ),
        lane="head",
        limit_s=5.0,
        brief=True,
    ),
    Verb(
        "torque",
        "switch the motors on or off",
        (Argument("on", "flag", required=True),),
        lane="control",
    ),
    Verb(
        "emotion",
        "show an emotion",
        (
            Argument("emotion", "choice", "which one", required=True),
            Argument("intensity", "number", "0 neutral, 1 full", default=1.0, range=Range(0, 1)),
        ),
        lane="face",
    ),
    Verb(
        "eyes",
        "colour the eyes",
        (
            Argument("color", "text", "a name or #rrggbb; off", required=True),
            Argument(
                "animation",
                "choice",
                "steady, blinking lids, or a pulsing light",
                default="steady",
                choices=EYE_ANIMATIONS,
            ),
        ),
        lane="face",
    ),
    Verb(
        "screen",
        "show a file on the screen",
        (Argument("file", "file", "picture, video or page", required=True),),
        lane="screen",
    ),
    Verb(
        "drive",
        "drive and turn from where it stands",
        (
            Argument("x", "number", "metres forward", default=0.0, range=_METRES),
            Argument("y", "number", "metres to the left", default=0.0, range=_METRES),
            Argument("turn", "number", "degrees to the left", default=0.0, range=_TURN),
        ),
        lane="base",
        drives=True,
        limit_s=120.0,
    ),
    Verb(
        "mode",
        "change the robot's mode",
        (Argument("mode", "choice", "which one", required=True),),
        lane="control",
    ),
    Verb(
        "face_consent",
        "the person has said whether their face may be learnt",
        (
            Argument("name", "text", "a code or a pseudonym", required=True),
            Argument("given", "flag", "no: it is withdrawn, what is kept is deleted", default=True),
        ),
        lane="eye",  # so that a withdrawal also deletes what is being learnt when it comes
        limit_s=10.0,
    ),
    Verb(
        "learn_face",
        "recognise the present visitor by this name from now on, if they consented",
        (Argument("name", "text", "a code or a pseudonym", required=True),),
        lane="eye",
        limit_s=10.0,
    ),
    Verb(
        "listen_room",
        "learn the threshold of speech from the room's noise, while nobody speaks",
        (Argument("seconds", "seconds", "how long", default=10.0, range=Range(0.1, 120)),),
        lane="listen",
        limit_s=150.0,
    ),
)

#: The common verbs by name. `choices` of moves, emotions and modes are each robot's own.
COMMON_VERBS: Mapping[str, Verb] = {verb.name: verb for verb in _VERBS}


def main_argument(name: str) -> str:
    """The main argument of a common verb: `say: "Hello"` gives it directly."""
    return COMMON_VERBS[name].arguments[0].name


def known_by(evidence: Evidence | Literal[""], verbs: Iterable[Verb], *names: str) -> list[Verb]:
    """The verbs, with this `Verb.evidence`: those called `names`, or all of them."""
    return [
        replace(verb, evidence=evidence) if not names or verb.name in names else verb
        for verb in verbs
    ]


def common_verb(
    name: str, summary: str = "", *own: Argument, choices: Sequence[str] = (), **changed: Any
) -> Verb:
    """The common verb `name` as one robot has it.

    Arguments in `own` replace those of the same name, or come behind them. `choices` are those of
    the main argument, `changed` other fields of the verb, such as `lane` and `limit_s`.
    """
    verb = COMMON_VERBS[name]
    arguments = {argument.name: argument for argument in verb.arguments}
    if choices:
        main = verb.arguments[0]
        arguments[main.name] = replace(main, choices=tuple(choices))
    arguments |= {argument.name: argument for argument in own}
    return replace(
        verb, summary=summary or verb.summary, arguments=tuple(arguments.values()), **changed
    )
