"""What the simulated robot offers: the common verbs, and one that breaks it."""

from __future__ import annotations

from woz_drivers import room
from woz_drivers.simulated.faults import MEANING
from woz_drivers.simulated.moves import known, roles
from woz_drivers.simulated.senses import SENSORS
from woz_drivers.simulated.settings import Settings
from woz_tui.core.driver import SPEECH, SPEECH_TEXT, Argument, Verb
from woz_tui.core.fields import Range

#: How coloured eyes move.
ANIMATIONS = ("steady", "blink", "intermittent")

_DEGREES = Range(-180, 180, "degrees")
_STEP = Range(-90, 90, "degrees")
_METRES = Range(-5, 5, "m")


def offered(settings: Settings) -> tuple[Verb, ...]:
    """The verbs of a robot with these joints, moves and modes."""
    senses = (room.verb(), _learn_face()) if settings.visitor else ()
    if settings.voice_only:
        return (*_voice(), *senses)
    rest = (*_body(settings), *_face(settings), _drive(), *_control(settings))
    return (*_voice(), *rest, *senses)


def sensors(settings: Settings) -> tuple[str, ...]:
    """Names of the readings: joints, base, and the visitor's traces if there is one."""
    joints = [f"{kind}.{name}" for name in settings.joints for kind in ("joint", "setpoint")]
    seen = (*SENSORS, room.THRESHOLD, SPEECH, SPEECH_TEXT) if settings.visitor else ()
    if settings.voice_only:
        return seen
    return (*joints, "base.x", "base.y", "base.heading", *seen)


def lanes(settings: Settings) -> tuple[str, ...]:
    """The lanes of all verbs, in order."""
    return tuple(dict.fromkeys(verb.lane for verb in offered(settings)))


def _voice() -> tuple[Verb, ...]:
    return (
        Verb(
            "say",
            "speak a sentence; tags for pauses and rate count",
            (Argument("text", "text", "what to say", required=True),),
            lane="voice",
            limit_s=180.0,
        ),
        Verb(
            "sound",
            "play a sound file",
            (Argument("file", "file", "a WAV file", required=True),),
            lane="sound",
            limit_s=600.0,
        ),
        Verb(
            "volume",
            "set how loud it speaks",
            (Argument("level", "number", "0 mute, 1 full", required=True, range=Range(0, 1)),),
            lane="control",
        ),
    )


def _learn_face() -> Verb:
    return Verb(
        "learn_face",
        "recognise the present visitor by this name from now on",
        (Argument("name", "text", "a code or a pseudonym", required=True),),
        lane="eye",
        limit_s=10.0,
    )


def _body(settings: Settings) -> tuple[Verb, ...]:
    moves = [
        Verb(
            "play",
            "play a gesture by name",
            (
                Argument("move", "choice", required=True, choices=tuple(sorted(known(settings)))),
                Argument("speed", "number", "2 is twice as fast", default=1.0, range=Range(0.1, 4)),
                Argument("amplitude", "number", "size", default=1.0, range=Range(0, 2)),
            ),
            lane="body",
            limit_s=120.0,
        )
    ]
    if settings.joints:
        moves += _joints()
    have = roles(settings)
    if "yaw" in have or "pitch" in have:
        moves += _head()
    if "hip" in have or "roll" in have:
        moves.append(_hip())
    return tuple(moves)


def _joints() -> tuple[Verb, ...]:
    seconds = Argument("seconds", "seconds", "0: as fast as it can", default=0.0)
    return (
        Verb(
            "pose",
            "take a pose",
            (Argument("joints", "joints", "degrees by joint", required=True), seconds),
            lane="body",
            limit_s=60.0,
        ),
        Verb(
            "poses",
            "pass through poses, one after the other",
            (Argument("poses", "poses", "poses, each with `seconds`", required=True),),
            lane="body",
            limit_s=300.0,
        ),
        Verb("home", "take the home pose", (seconds,), lane="body", limit_s=60.0),
        Verb(
            "torque",
            "let the motors hold, or go limp",
            (Argument("on", "flag", required=True),),
            lane="control",
        ),
    )


def _head() -> tuple[Verb, ...]:
    return (
        Verb(
            "gaze",
            "look in a direction",
            (
                Argument("yaw", "number", "left is positive", range=_DEGREES),
                Argument("pitch", "number", "down is positive", range=_DEGREES),
            ),
            lane="head",
            stream=True,
        ),
        Verb(
            "nudge",
            "turn the head a step from where it looks",
            (
                Argument("yaw", "number", "left is positive", default=0.0, range=_STEP),
                Argument("pitch", "number", "down is positive", default=0.0, range=_STEP),
            ),
            lane="head",
            limit_s=5.0,
        ),
    )


def _hip() -> Verb:
    return Verb(
        "hip",
        "bend the hips a step from where they are",
        (
            Argument("pitch", "number", "forward is positive", default=0.0, range=_STEP),
            Argument("roll", "number", "left is positive", default=0.0, range=_STEP),
        ),
        lane="hip",
        limit_s=5.0,
    )


def _face(settings: Settings) -> tuple[Verb, ...]:
    return (
        Verb(
            "emotion",
            "show an emotion",
            (
                Argument("emotion", "choice", required=True, choices=settings.emotions),
                Argument(
                    "intensity", "number", "0 neutral, 1 full", default=1.0, range=Range(0, 1)
                ),
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
                    "steady, blinking lids, or a light that comes and goes",
                    default="steady",
                    choices=ANIMATIONS,
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
    )


def _drive() -> Verb:
    return Verb(
        "drive",
        "drive and turn from where it stands",
        (
            Argument("x", "number", "metres forward", default=0.0, range=_METRES),
            Argument("y", "number", "metres to the left", default=0.0, range=_METRES),
            Argument("turn", "number", "degrees to the left", default=0.0, range=Range(-360, 360)),
        ),
        lane="base",
        drives=True,
        limit_s=120.0,
    )


def _control(settings: Settings) -> tuple[Verb, ...]:
    return (
        Verb(
            "mode",
            "change the robot's mode",
            (Argument("mode", "choice", required=True, choices=settings.modes),),
            lane="control",
        ),
        Verb(
            "fault",
            "break something on purpose, to rehearse a break-down",
            (
                Argument(
                    "kind",
                    "choice",
                    "; ".join(f"{kind}: {what}" for kind, what in MEANING.items()),
                    required=True,
                    choices=tuple(MEANING),
                ),
                Argument("seconds", "seconds", "how long", default=5.0),
                Argument("part", "text", "a lane or a sensor; empty: everything", default=""),
            ),
            lane="fault",
        ),
    )


def breakable(settings: Settings, kind: str) -> tuple[str, ...]:
    """What a fault of this kind may name as its part; some hit the whole robot only."""
    if kind in ("nan", "stuck", "silent"):
        return sensors(settings)
    if kind == "overheat":
        return tuple(settings.joints)
    if kind in ("slow", "deaf"):
        return ()
    return tuple(lane for lane in lanes(settings) if lane != "fault")
