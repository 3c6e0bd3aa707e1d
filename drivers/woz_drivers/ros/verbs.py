"""The verbs that a robot file declares: the common ones have their arguments from here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from woz_drivers.ros.declarations import DriveDeclaration, VerbDeclaration
from woz_tui.drivers.contract import Argument, Verb
from woz_tui.drivers.fields import Range

DRIVE = "drive"
#: Verbs that the driver makes of another one.
DERIVED = {"nudge": "gaze", "poses": "pose"}

#: What they change is over at once, so that a stop has nothing to end.
BRIEF = frozenset({"volume", "torque", "eyes", "emotion", "screen", "mode"})

_PAN, _TILT = Range(-180, 180, "deg"), Range(-90, 90, "deg")
_SHARE = Range(0, 1)
_METRES = Range(-5, 5, "m")


def _verb(name: str, summary: str, lane: str, *arguments: Argument, stream: bool = False) -> Verb:
    return Verb(name, summary, arguments, lane=lane, stream=stream)


def _text(name: str, summary: str = "", kind: str = "text") -> Argument:
    return Argument(name, kind, summary, required=True)


#: The common verbs of drivers/README.md, as far as a message can play them.
COMMON: Mapping[str, Verb] = {
    verb.name: verb
    for verb in (
        _verb("say", "say a text", "voice", _text("text")),
        _verb(
            "sound", "play a sound of the robot", "sound", _text("file", "as the robot names it")
        ),
        _verb(
            "volume",
            "how loud it is",
            "volume",
            Argument("level", "number", "", True, None, _SHARE),
        ),
        _verb(
            "play",
            "play a gesture",
            "body",
            _text("move"),
            Argument("speed", "number", "1: as recorded", False, 1.0, Range(0.1, 5)),
            Argument("amplitude", "number", "1: as recorded", False, 1.0, Range(0, 2)),
        ),
        _verb(
            "pose",
            "take a pose",
            "body",
            Argument("joints", "joints", "degrees by joint", True),
            Argument("seconds", "seconds", "how long it takes", False, 1.0, Range(0.1, 60, "s")),
        ),
        _verb(
            "home",
            "take the pose of rest",
            "body",
            Argument("seconds", "seconds", "how long it takes", False, 1.0, Range(0.1, 60, "s")),
        ),
        _verb(
            "gaze",
            "look there",
            "head",
            Argument("yaw", "number", "degrees to the left", True, None, _PAN),
            Argument("pitch", "number", "degrees down", False, None, _TILT),
            stream=True,
        ),
        _verb("torque", "motors on or off", "torque", Argument("on", "flag", "", True)),
        _verb(
            "emotion",
            "show an emotion",
            "face",
            _text("emotion"),
            Argument("intensity", "number", "how strongly", False, 1.0, _SHARE),
        ),
        _verb(
            "eyes",
            "colour of the eyes",
            "face",
            _text("color", "a name or #rrggbb"),
            Argument(
                "animation",
                "choice",
                "how the light is",
                default="steady",
                choices=("steady", "blink", "intermittent"),
            ),
        ),
        _verb("screen", "show a picture", "screen", _text("file", "as the robot names it")),
        _verb("mode", "change the robot's mode", "control", _text("mode")),
    )
}

_NUDGE = Verb(
    "nudge",
    "look a step further",
    (
        Argument("yaw", "number", "degrees to the left", default=0.0, range=_PAN),
        Argument("pitch", "number", "degrees down", default=0.0, range=_TILT),
    ),
    lane="head",
    brief=True,
)
_POSES = Verb(
    "poses",
    "take poses one after the other",
    (Argument("poses", "poses", "", True),),
    lane="body",
    limit_s=600.0,
)


def arguments_of(name: str, declared: VerbDeclaration) -> dict[str, Argument]:
    """The arguments of a verb by name: a common one's, else those that the file gives."""
    common = COMMON.get(name)
    if common is None:
        arguments = {
            one: Argument(
                one,
                given.kind,
                required=given.default is None,
                default=given.default,
                range=given.range,
            )
            for one, given in declared.arguments.items()
        }
    else:
        arguments = {argument.name: argument for argument in common.arguments}
        for one, given in declared.arguments.items():
            if one in arguments and given.range is not None:
                arguments[one] = replace(arguments[one], range=given.range)
    for one, words in declared.values.items():
        if one in arguments:
            default = arguments[one].default
            arguments[one] = replace(
                arguments[one],
                kind="choice",
                choices=tuple(words),
                range=None,
                default=default if default in words else None,
                required=arguments[one].required or default is not None,
            )
    return arguments


def offered(
    declarations: Mapping[str, VerbDeclaration], drive: DriveDeclaration | None
) -> tuple[Verb, ...]:
    """Every verb of a robot file."""
    verbs = []
    for name, declared in declarations.items():
        common = COMMON.get(name) or Verb(name, "send what the robot file says", lane=name)
        verbs.append(
            replace(
                common,
                summary=declared.help or common.summary,
                arguments=tuple(arguments_of(name, declared).values()),
                lane=declared.lane or common.lane,
                limit_s=declared.within,
                drives=declared.drives,
            )
        )
    verbs += [_NUDGE] if "gaze" in declarations else []
    verbs += [_POSES] if "pose" in declarations else []
    return (*verbs, *([_drive(drive)] if drive is not None else []))


def _drive(declared: DriveDeclaration) -> Verb:
    sideways = [Argument("y", "number", "metres to the left", default=0.0, range=_METRES)]
    return Verb(
        DRIVE,
        "drive and turn from where it stands",
        (
            Argument("x", "number", "metres forward", default=0.0, range=_METRES),
            *(sideways if declared.sideways else []),
            Argument("turn", "number", "degrees to the left", default=0.0, range=Range(-360, 360)),
        ),
        lane="base",
        drives=True,
        limit_s=600.0,
    )
