"""The verbs of a chain of servos: what they are called, and what their arguments mean."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from woz_drivers.dynamixel.setpoint_planning import Keyframe
from woz_drivers.dynamixel.settings import SECONDS, ServoSettings
from woz_tui.drivers.contract import Argument, RejectedError, Verb
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_verbs import common_verb

BODY = "body"
HEAD = "head"
POWER = "power"
#: Time a named pose takes when `play` is called with it, in seconds.
POSE_SECONDS = 1.0
LONGEST = Range(0.0, 60.0, "s")


def servo_verbs(settings: ServoSettings) -> tuple[Verb, ...]:
    """The verbs that make sense with these settings."""
    power = _power_verbs(settings)
    if settings.follows:
        return power
    verbs = [
        common_verb("pose", "", _seconds(1.0), arrives=True, evidence="measured"),
        common_verb("poses", arrives=True, evidence="measured"),
        common_verb("home", "", _seconds(2.0), arrives=True, evidence="measured"),
        *power,
    ]
    if names := (*settings.moves, *settings.poses):
        speed = Argument("speed", "number", "2 is twice as fast", False, 1.0, Range(0.1, 5.0))
        share = "share of the way from home"
        amplitude = Argument("amplitude", "number", share, False, 1.0, Range(0.0, 2.0))
        summary = "play a named move, or take a named pose"
        verbs.append(
            common_verb("play", summary, speed, amplitude, choices=names, evidence="measured")
        )
    if settings.pan or settings.tilt:
        # Each step counts, so `nudge` is queued; of a stream of gazes only the last one counts.
        verbs += [
            replace(_turn("gaze", 90.0), arrives=True),
            _turn("nudge", 45.0),
        ]
    return tuple(verbs)


def _seconds(default: float) -> Argument:
    return Argument("seconds", "seconds", "time it takes; 0: fastest", False, default, LONGEST)


def _power_verbs(settings: ServoSettings) -> tuple[Verb, ...]:
    joint = Argument("joint", "choice", "only this one", False, "", choices=("", *settings.joints))
    summary = "switch the joints on (they hold) or off (they go limp)"
    torque = common_verb("torque", summary, joint, lane=POWER, evidence="reported")
    if settings.protocol == 1:
        return (torque,)
    alarmed = replace(joint, summary="only this one; empty: all with an alarm")
    summary = "restart servos that report an alarm; they are limp afterwards"
    return (torque, Verb("reboot", summary, (alarmed,), POWER, evidence="reported"))


def _turn(name: str, reach: float) -> Verb:
    bound = Range(-2 * reach, 2 * reach, "degrees")
    return common_verb(
        name,
        "",
        Argument("yaw", "number", "left is positive", False, None, bound),
        Argument("pitch", "number", "down is positive", False, None, bound),
    )


# -- arguments ------------------------------------------------------------------------------------


Args = Mapping[str, Any]


def keyframes(settings: ServoSettings, verb: str, args: Args) -> list[Keyframe]:
    """What `pose`, `poses`, `home` or `play` asks for. `RejectedError` says what is wrong."""
    if verb == "pose":
        return [_keyframe(settings, args)]
    if verb == "home":
        home = {name: joint.home for name, joint in settings.joints.items()}
        return [Keyframe(home, args["seconds"])]
    if verb == "poses":
        return [_keyframe(settings, pose) for pose in args["poses"]]
    return _move(settings, args)


def _keyframe(settings: ServoSettings, pose: Args) -> Keyframe:
    for name in pose["joints"]:
        if name not in settings.joints:
            known = ", ".join(sorted(settings.joints))
            raise RejectedError(f"there is no joint {name!r}", f"the joints are {known}")
    return Keyframe(pose["joints"], pose.get("seconds", 1.0))


def turn(settings: ServoSettings, args: Args) -> dict[str, float]:
    """Angles of the pan and tilt joints for `yaw` and `pitch`."""
    found = {}
    for key, role, joint in (("yaw", "pan", settings.pan), ("pitch", "tilt", settings.tilt)):
        if key not in args:
            continue
        if not joint:
            raise RejectedError(
                f"there is no {role} joint for {key}", f"set `{role}` in the robot file"
            )
        found[joint] = args[key]
    if not found:
        raise RejectedError("neither yaw nor pitch was given")
    return found


def _move(settings: ServoSettings, args: Args) -> list[Keyframe]:
    name = args["move"]
    if name in settings.moves:
        frames = settings.moves[name]
    else:
        frames = [{**settings.poses[name], SECONDS: POSE_SECONDS}]
    homes = {joint: each.home for joint, each in settings.joints.items()}
    return [
        Keyframe(
            {
                joint: homes[joint] + args["amplitude"] * (angle - homes[joint])
                for joint, angle in frame.items()
                if joint != SECONDS
            },
            frame[SECONDS] / args["speed"],
        )
        for frame in frames
    ]
