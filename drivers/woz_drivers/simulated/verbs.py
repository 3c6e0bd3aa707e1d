"""The verbs of the simulated robot: the common ones, and one that breaks it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from woz_drivers import room_threshold
from woz_drivers.simulated.faults import MEANING
from woz_drivers.simulated.senses import SENSORS
from woz_drivers.simulated.settings import SimulatedSettings
from woz_tui.drivers.contract import SPEECH, SPEECH_TEXT, Argument, Verb
from woz_tui.drivers.fields import Range

# -- moves ----------------------------------------------------------------------------------------
# The gestures that `play` knows, as poses at fractions of their duration.


@dataclass(frozen=True, slots=True)
class SimulatedMove:
    """A gesture. `keys` are (fraction of the duration, degrees from home by role of the joint).

    The roles are yaw, pitch and hip; a robot without such a joint leaves it out.
    """

    seconds: float
    keys: tuple[tuple[float, Mapping[str, float]], ...] = ()


_HOME = {"yaw": 0.0, "pitch": 0.0, "hip": 0.0}

MOVES: Mapping[str, SimulatedMove] = {
    "nod": SimulatedMove(
        1.2,
        (
            (0.2, {"pitch": 18}),
            (0.45, {"pitch": -6}),
            (0.7, {"pitch": 14}),
            (1.0, {"pitch": 0}),
        ),
    ),
    "shake": SimulatedMove(
        1.6,
        (
            (0.15, {"yaw": 22}),
            (0.4, {"yaw": -22}),
            (0.65, {"yaw": 18}),
            (0.85, {"yaw": -10}),
            (1.0, {"yaw": 0}),
        ),
    ),
    "dance": SimulatedMove(
        6.0,
        (
            (0.12, {"yaw": 30, "pitch": 10, "hip": 10}),
            (0.25, {"yaw": -30, "pitch": -8, "hip": -8}),
            (0.37, {"yaw": 30, "pitch": 10, "hip": 10}),
            (0.5, {"yaw": -30, "pitch": -8, "hip": -8}),
            (0.65, {"yaw": 45, "pitch": 15, "hip": 12}),
            (0.8, {"yaw": -45, "pitch": -12, "hip": -10}),
            (0.9, {"yaw": 0, "pitch": 20, "hip": 15}),
            (1.0, _HOME),
        ),
    ),
    "wave": SimulatedMove(
        2.4,
        (
            (0.2, {"yaw": 8, "hip": 6}),
            (0.4, {"yaw": -8, "hip": -6}),
            (0.6, {"yaw": 8, "hip": 6}),
            (0.8, {"yaw": -8, "hip": -6}),
            (1.0, _HOME),
        ),
    ),
    "bow": SimulatedMove(
        2.6, ((0.4, {"hip": 24, "pitch": 20}), (0.6, {"hip": 24, "pitch": 20}), (1, _HOME))
    ),
    "point-left": SimulatedMove(
        2.0, ((0.35, {"yaw": 50, "hip": 6}), (0.7, {"yaw": 50, "hip": 6}), (1.0, _HOME))
    ),
    "point-middle": SimulatedMove(
        2.0, ((0.35, {"pitch": 14, "hip": 12}), (0.7, {"pitch": 14, "hip": 12}), (1.0, _HOME))
    ),
    "point-right": SimulatedMove(
        2.0, ((0.35, {"yaw": -50, "hip": 6}), (0.7, {"yaw": -50, "hip": 6}), (1.0, _HOME))
    ),
    "look-around": SimulatedMove(
        4.0,
        (
            (0.25, {"yaw": 55, "pitch": -8}),
            (0.5, {"yaw": 10, "pitch": 8}),
            (0.75, {"yaw": -55, "pitch": -8}),
            (1.0, _HOME),
        ),
    ),
}


def playable_moves(settings: SimulatedSettings) -> dict[str, SimulatedMove]:
    """Our gestures, and those that the robot file adds: these take their time and move nothing."""
    return dict(MOVES) | {name: SimulatedMove(seconds) for name, seconds in settings.moves.items()}


def roles(settings: SimulatedSettings) -> dict[str, str]:
    """Role of a joint -> its name, for those the robot has."""
    joints_by_role = {
        "yaw": settings.yaw_joint,
        "pitch": settings.pitch_joint,
        "hip": settings.hip_joint,
        "roll": settings.hip_roll_joint,
    }
    return {role: name for role, name in joints_by_role.items() if name in settings.joints}


# --------------------------------------------------------------------------------------------------

#: How coloured eyes move.
ANIMATIONS = ("steady", "blink", "intermittent")

_DEGREES = Range(-180, 180, "degrees")
_STEP = Range(-90, 90, "degrees")
_METRES = Range(-5, 5, "m")


def offered(settings: SimulatedSettings) -> tuple[Verb, ...]:
    """The verbs of a robot with these joints, moves and modes."""
    senses = (room_threshold.verb(), _LEARN_FACE) if settings.visitor else ()
    if settings.voice_only:
        return (*_VOICE, *senses)
    rest = (*_body(settings), *_face(settings), _DRIVE, *_control(settings))
    return (*_VOICE, *rest, *senses)


def sensors(settings: SimulatedSettings) -> tuple[str, ...]:
    """Names of the readings: joints, base, and the visitor's traces if there is one."""
    joints = [f"{kind}.{name}" for name in settings.joints for kind in ("joint", "setpoint")]
    visitor_sensors = (
        (*SENSORS, room_threshold.THRESHOLD, SPEECH, SPEECH_TEXT) if settings.visitor else ()
    )
    if settings.voice_only:
        return visitor_sensors
    return (*joints, "base.x", "base.y", "base.heading", *visitor_sensors)


def lanes(settings: SimulatedSettings) -> tuple[str, ...]:
    """The lanes of all verbs, in order."""
    return tuple(dict.fromkeys(verb.lane for verb in offered(settings)))


_VOICE = (
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


_LEARN_FACE = Verb(
    "learn_face",
    "recognise the present visitor by this name from now on",
    (Argument("name", "text", "a code or a pseudonym", required=True),),
    lane="eye",
    limit_s=10.0,
)


def _body(settings: SimulatedSettings) -> tuple[Verb, ...]:
    moves = [
        Verb(
            "play",
            "play a gesture by name",
            (
                Argument(
                    "move", "choice", required=True, choices=tuple(sorted(playable_moves(settings)))
                ),
                Argument("speed", "number", "2 is twice as fast", default=1.0, range=Range(0.1, 4)),
                Argument("amplitude", "number", "size", default=1.0, range=Range(0, 2)),
            ),
            lane="body",
            limit_s=120.0,
        )
    ]
    if settings.joints:
        moves += _JOINT_VERBS
    have = roles(settings)
    if "yaw" in have or "pitch" in have:
        moves += _HEAD
    if "hip" in have or "roll" in have:
        moves.append(_HIP)
    return tuple(moves)


_SECONDS = Argument("seconds", "seconds", "0: as fast as it can", default=0.0)
_JOINT_VERBS = (
    Verb(
        "pose",
        "take a pose",
        (Argument("joints", "joints", "degrees by joint", required=True), _SECONDS),
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
    Verb("home", "take the home pose", (_SECONDS,), lane="body", limit_s=60.0),
    Verb(
        "torque",
        "switch the motors on or off",
        (Argument("on", "flag", required=True),),
        lane="control",
    ),
)


_HEAD = (
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


_HIP = Verb(
    "hip",
    "bend the hips a step from where they are",
    (
        Argument("pitch", "number", "forward is positive", default=0.0, range=_STEP),
        Argument("roll", "number", "left is positive", default=0.0, range=_STEP),
    ),
    lane="hip",
    limit_s=5.0,
)


def _face(settings: SimulatedSettings) -> tuple[Verb, ...]:
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
                    "steady, blinking lids, or a pulsing light",
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


_DRIVE = Verb(
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


def _control(settings: SimulatedSettings) -> tuple[Verb, ...]:
    return (
        Verb(
            "mode",
            "change the robot's mode",
            (Argument("mode", "choice", required=True, choices=settings.modes),),
            lane="control",
        ),
        Verb(
            "fault",
            "simulate a fault, for rehearsals",
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


def breakable(settings: SimulatedSettings, kind: str) -> tuple[str, ...]:
    """What a fault of this kind may name as its part; some hit the whole robot only."""
    if kind in ("nan", "stuck", "silent"):
        return sensors(settings)
    if kind == "overheat":
        return tuple(settings.joints)
    if kind in ("slow", "deaf"):
        return ()
    return tuple(lane for lane in lanes(settings) if lane != "fault")
