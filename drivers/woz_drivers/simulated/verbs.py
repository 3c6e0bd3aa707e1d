"""The verbs of the simulated robot: the common ones, and one that breaks it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from woz_drivers.simulated.faults import MEANING
from woz_drivers.simulated.senses import SENSORS
from woz_drivers.simulated.settings import SimulatedSettings
from woz_drivers.sound import room_threshold
from woz_tui.drivers.contract import (
    FACE_CONSENT,
    LEARN_FACE,
    SPEECH,
    SPEECH_TEXT,
    Argument,
    Verb,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_verbs import common_verb, known_by
from woz_tui.motion.emotions import FEELINGS

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

_STEP = Range(-90, 90, "degrees")


def offered(settings: SimulatedSettings) -> tuple[Verb, ...]:
    """The verbs of a robot with these joints, moves and modes.

    It stands for a robot that answers, and whose joints, base and microphone have sensors.
    """
    known = known_by("reported", _all(settings))
    known = known_by("measured", known, *_MEASURED)
    return tuple(known_by("", known, "fault"))


#: What sensors of the simulated robot show; a gaze is only taken when it is done, and measured when
#: it has arrived.
_MEASURED = ("play", "pose", "poses", "home", "nudge", "hip", "drive", room_threshold.NAME)


def _all(settings: SimulatedSettings) -> tuple[Verb, ...]:
    sensing = (room_threshold.NAME, FACE_CONSENT, LEARN_FACE)
    senses = tuple(map(common_verb, sensing)) if settings.visitor else ()
    if settings.voice_only:
        return (*_VOICE, *senses)
    face = (
        common_verb("emotion", choices=settings.emotions),
        common_verb("eyes"),
        common_verb("screen"),
    )
    rest = (*_body(settings), *face, common_verb("drive"), *_control(settings))
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
    common_verb(
        "say", "speak a sentence; tags for pauses and rate count", markup=("pause", "speed")
    ),
    common_verb("utter", choices=FEELINGS),
    common_verb("sound"),
    common_verb("volume"),
)


def _body(settings: SimulatedSettings) -> tuple[Verb, ...]:
    moves = [
        common_verb("play", "play a gesture by name", choices=sorted(playable_moves(settings)))
    ]
    if settings.joints:
        moves += [common_verb(name, arrives=True) for name in ("pose", "poses", "home")]
        moves.append(common_verb("torque"))
    have = roles(settings)
    if "yaw" in have or "pitch" in have:
        moves += [common_verb("gaze", arrives=True), common_verb("nudge")]
    if "hip" in have or "roll" in have:
        moves.append(_HIP)
    return tuple(moves)


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


def _control(settings: SimulatedSettings) -> tuple[Verb, ...]:
    return (
        common_verb("mode", choices=settings.modes),
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
