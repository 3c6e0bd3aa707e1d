"""The verbs of a chain of servos: what they are called, and what their arguments mean."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from woz_drivers.dynamixel.motion import Keyframe
from woz_drivers.dynamixel.settings import SECONDS, Settings
from woz_tui.core.driver import Argument, Rejected, Verb
from woz_tui.core.fields import Range
from woz_tui.core.messages import Json

BODY = "body"
HEAD = "head"
POWER = "power"
#: Time a named pose takes when `play` is called with it, in seconds.
POSE_SECONDS = 1.0
LONGEST = Range(0.0, 60.0, "s")


def offered(settings: Settings) -> tuple[Verb, ...]:
    """The verbs that make sense with these settings."""
    verbs = _power(settings)
    if settings.follows:
        return tuple(verbs)
    verbs = [*_moves(), *verbs]
    if settings.moves or settings.poses:
        verbs.append(_play(settings))
    if settings.pan or settings.tilt:
        # Each step counts, so `nudge` is queued; of a stream of gazes only the last one counts.
        verbs += [
            _turn("gaze", "Look into a direction", 90.0),
            _turn("nudge", "Look further", 45.0),
        ]
    return tuple(verbs)


def _moves() -> list[Verb]:
    return [
        Verb(
            "pose",
            "Move joints to angles in degrees, together",
            (
                Argument("joints", "joints", "angles by joint, in degrees", required=True),
                Argument("seconds", "seconds", "time it takes; 0: fastest", False, 1.0, LONGEST),
            ),
            lane=BODY,
        ),
        Verb(
            "poses",
            "Move through several poses, one after the other",
            (Argument("poses", "poses", "angles by joint, each with seconds", required=True),),
            lane=BODY,
        ),
        Verb(
            "home",
            "Move all joints to their home angles",
            (Argument("seconds", "seconds", "time it takes; 0: fastest", False, 2.0, LONGEST),),
            lane=BODY,
        ),
    ]


def _power(settings: Settings) -> list[Verb]:
    verbs = [
        Verb(
            "torque",
            "Switch the joints on (they hold) or off (they go limp)",
            (
                Argument("on", "flag", "whether the joints hold", required=True),
                Argument("joint", "choice", "only this one", choices=_joints(settings), default=""),
            ),
            lane=POWER,
        ),
    ]
    if settings.protocol == 2:
        verbs.append(
            Verb(
                "reboot",
                "Restart servos that report an alarm; they are limp afterwards",
                (
                    Argument(
                        "joint",
                        "choice",
                        "only this one; empty: all with an alarm",
                        choices=_joints(settings),
                        default="",
                    ),
                ),
                lane=POWER,
            )
        )
    return verbs


def _joints(settings: Settings) -> tuple[str, ...]:
    return ("", *settings.joints)


def _play(settings: Settings) -> Verb:
    return Verb(
        "play",
        "Play a named move or take a named pose",
        (
            Argument(
                "move",
                "choice",
                "its name",
                required=True,
                choices=(*settings.moves, *settings.poses),
            ),
            Argument("speed", "number", "1 is as written", False, 1.0, Range(0.1, 5.0)),
            Argument(
                "amplitude", "number", "share of the way from home", False, 1.0, Range(0.0, 2.0)
            ),
        ),
        lane=BODY,
    )


def _turn(name: str, summary: str, reach: float) -> Verb:
    bound = Range(-2 * reach, 2 * reach, "deg")
    return Verb(
        name,
        summary,
        (
            Argument("yaw", "number", "degrees to the left", False, None, bound),
            Argument("pitch", "number", "degrees down", False, None, bound),
        ),
        lane=HEAD,
        stream=name == "gaze",
    )


# -- arguments ------------------------------------------------------------------------------------


def keyframes(settings: Settings, verb: str, args: Mapping[str, Json]) -> list[Keyframe]:
    """What `pose`, `poses`, `home` or `play` asks for. `Rejected` says what is wrong."""
    if verb == "pose":
        return [Keyframe(angles(settings, args.get("joints")), seconds(args.get("seconds"), 1.0))]
    if verb == "home":
        home = {name: joint.home for name, joint in settings.joints.items()}
        return [Keyframe(home, seconds(args.get("seconds"), 2.0))]
    if verb == "poses":
        return _sequence(settings, args.get("poses"))
    return _move(settings, args)


def angles(settings: Settings, value: Json) -> dict[str, float]:
    """Angles in degrees by joint; every joint must exist, every angle be a finite number."""
    if not isinstance(value, Mapping) or not value:
        raise Rejected("no joints were named", "write for example `pose: {pan: 20}`")
    found = {}
    for name, angle in value.items():
        if name not in settings.joints:
            known = ", ".join(sorted(settings.joints))
            raise Rejected(f"there is no joint {name!r}", f"the joints are {known}")
        found[str(name)] = number(angle, f"the angle of {name}")
    return found


def number(value: Json, what: str) -> float:
    """A finite number, or `Rejected`."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise Rejected(f"{what} is not a number: {value!r}")
    try:
        result = float(value)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        raise Rejected(f"{what} is not a finite number: {value!r}")
    return result


def seconds(value: Json, default: float) -> float:
    """A time, 0 or more: 0 is as fast as the limits allow."""
    if value is None:
        return default
    result = number(value, SECONDS)
    if result < 0:
        raise Rejected(f"{SECONDS} is negative: {result:g}")
    return result


def turn(settings: Settings, args: Mapping[str, Json]) -> dict[str, float]:
    """Angles of the pan and tilt joints for `yaw` and `pitch`."""
    found = {}
    for key, role, joint in (("yaw", "pan", settings.pan), ("pitch", "tilt", settings.tilt)):
        value = args.get(key)
        if value is None:
            continue
        angle = number(value, key)
        if not joint:
            raise Rejected(f"there is no {role} joint for {key}", f"set `{role}` in the robot file")
        found[joint] = angle
    if not found:
        raise Rejected("neither yaw nor pitch was given")
    return found


def _sequence(settings: Settings, value: Json) -> list[Keyframe]:
    if not isinstance(value, Sequence) or isinstance(value, str) or not value:
        raise Rejected(
            "no poses were given", "write for example `poses: [{joints: {pan: 20}, seconds: 1}]`"
        )
    frames = []
    for entry in value:
        if not isinstance(entry, Mapping):
            raise Rejected(f"a pose must map joints to degrees, not be {entry!r}")
        time = seconds(entry.get(SECONDS), 1.0)
        frames.append(Keyframe(angles(settings, entry.get("joints")), time))
    return frames


def _move(settings: Settings, args: Mapping[str, Json]) -> list[Keyframe]:
    name = args.get("move")
    speed = number(args.get("speed", 1.0), "speed")
    amplitude = number(args.get("amplitude", 1.0), "amplitude")
    if speed <= 0:
        raise Rejected(f"speed must be above 0, not {speed:g}")
    if isinstance(name, str) and name in settings.moves:
        frames = settings.moves[name]
    elif isinstance(name, str) and name in settings.poses:
        frames = [{**settings.poses[name], SECONDS: POSE_SECONDS}]
    else:
        known = ", ".join([*settings.moves, *settings.poses]) or "none"
        raise Rejected(f"there is no move {name!r}", f"the moves are {known}")
    return [
        Keyframe(
            {
                joint: _scaled(settings, joint, angle, amplitude)
                for joint, angle in frame.items()
                if joint != SECONDS
            },
            frame[SECONDS] / speed,
        )
        for frame in frames
    ]


def _scaled(settings: Settings, joint: str, angle: float, amplitude: float) -> float:
    home = settings.joints[joint].home
    return home + amplitude * (angle - home)
