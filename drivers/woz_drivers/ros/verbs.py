"""The verbs that a robot file declares: the common ones have their arguments from here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from woz_drivers.ros.declarations import DriveDeclaration, VerbDeclaration
from woz_tui.drivers.contract import Argument, Verb
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_verbs import COMMON_VERBS, common_verb
from woz_tui.protocol.action_messages import Evidence

DRIVE = "drive"
#: Verbs that the driver makes of another one.
DERIVED = {"nudge": "gaze", "poses": "pose"}

#: What they change is over at once, so that a stop has nothing to end.
BRIEF = frozenset({"volume", "torque", "eyes", "emotion", "screen", "mode"})

_SECONDS = Argument("seconds", "seconds", "how long it takes", False, 1.0, Range(0.1, 60, "s"))


def _named(argument: str, summary: str = "") -> Argument:
    """A word that the robot knows, or that `values` translates for it."""
    return Argument(argument, "text", summary, required=True)


#: The common verbs as far as a message can play them.
COMMON: Mapping[str, Verb] = {
    verb.name: verb
    for verb in (
        common_verb("say"),
        common_verb("sound", "", _named("file", "as the robot names it")),
        common_verb("volume", lane="volume"),
        common_verb("play", "", _named("move")),
        common_verb("pose", "", _SECONDS),
        common_verb("home", "", _SECONDS),
        common_verb("gaze", "", replace(COMMON_VERBS["gaze"].arguments[0], required=True)),
        common_verb("torque", lane="torque"),
        common_verb("emotion", "", _named("emotion")),
        common_verb("eyes"),
        common_verb("screen", "", _named("file", "as the robot names it")),
        common_verb("mode", "", _named("mode")),
    )
}


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
                drives=declared.is_driving,
                markup=declared.markup if name == "say" else common.markup,
                evidence="reported" if declared.is_answered else "timed",
            )
        )
    verbs += [
        common_verb(name, evidence="reported" if declarations[other].is_answered else "timed")
        for name, other in DERIVED.items()
        if other in declarations
    ]
    return (*verbs, *([_drive(drive)] if drive is not None else []))


def _drive(declared: DriveDeclaration) -> Verb:
    known: Evidence = "measured" if declared.odometry else "timed"
    drive = common_verb(DRIVE, limit_s=600.0, arrives=True, evidence=known)
    ways = [each for each in drive.arguments if declared.sideways or each.name != "y"]
    return replace(drive, arguments=tuple(ways))
