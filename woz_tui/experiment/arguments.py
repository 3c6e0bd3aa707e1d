"""Arguments of verbs: from a node to the value that a driver is given."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

from woz_tui.core.driver import Argument
from woz_tui.core.fields import Range
from woz_tui.core.messages import Json
from woz_tui.experiment import template
from woz_tui.experiment.nodes import Table
from woz_tui.experiment.settings import resolved
from woz_tui.experiment.spot import (
    Spot,
    read_flag,
    read_number,
    read_seconds,
    read_text,
    read_whole,
    read_word,
)

#: Seconds. Nothing in an experiment takes longer than a day.
_LONGEST = 86_400.0


@dataclass(frozen=True, slots=True)
class Setting:
    """What arguments are checked against, beside their own description.

    `joints`: a driver's joints with their ranges in degrees; None if it does not tell.
    """

    variables: Collection[str]
    joints: Mapping[str, Range] | None = field(default=None)


def read_argument(spot: Spot, argument: Argument, setting: Setting) -> Json:
    """The checked value; None if it is wrong (and reported)."""
    if argument.choices and argument.kind in ("text", "choice"):
        return read_word(spot, argument.choices)
    reader = _READERS.get(argument.kind)
    if reader is None:
        spot.error(f"the driver names an unknown kind of argument: {argument.kind!r}")
        return None
    return reader(spot, argument, setting)


def _text(spot: Spot, argument: Argument, setting: Setting) -> Json:
    text = read_text(spot)
    if text is not None:
        template.check(spot, text, setting.variables)
    return text


def _file(spot: Spot, argument: Argument, setting: Setting) -> Json:
    text = read_text(spot, "a file")
    if text is None or "://" in text:
        return text
    template.check(spot, text, setting.variables)
    # Only looked for: the argument stays as written, so that no home folder gets into the log.
    resolved(spot, text, must_exist=not template.names(text))
    return text


def _number(spot: Spot, argument: Argument, setting: Setting) -> Json:
    return read_number(spot, argument.range)


def _whole(spot: Spot, argument: Argument, setting: Setting) -> Json:
    return read_whole(spot, argument.range)


def _flag(spot: Spot, argument: Argument, setting: Setting) -> Json:
    return read_flag(spot)


def _seconds(spot: Spot, argument: Argument, setting: Setting) -> Json:
    return read_seconds(spot, argument.range or Range(0.0, _LONGEST, "s"))


def _joints(spot: Spot, argument: Argument, setting: Setting) -> Json:
    table = spot.table("joint names with degrees, such as {pan: 20}")
    return None if table is None else _angles(spot, table, argument, setting)


def _angles(spot: Spot, table: Mapping[str, Spot], argument: Argument, setting: Setting) -> Json:
    if not table:
        spot.error("no joint is named here")
    angles: dict[str, Json] = {}
    for name, entry in table.items():
        allowed = argument.range
        if setting.joints is not None:
            if name not in setting.joints:
                near = entry.report.hint(name, setting.joints, or_list="the joints are")
                entry.error(f"there is no joint {name!r}{near}")
                continue
            allowed = setting.joints[name]
        angles[name] = read_number(entry, allowed)
    return angles


def _poses(spot: Spot, argument: Argument, setting: Setting) -> Json:
    entries = spot.list("a list of poses, such as [{pan: 20, seconds: 1}]")
    if entries is not None and not entries:
        spot.error("no pose stands here")
    return None if entries is None else [_pose(entry, argument, setting) for entry in entries]


def _pose(spot: Spot, argument: Argument, setting: Setting) -> Json:
    """`{joints: {pan: 20}, seconds: 1}`, or shorter `{pan: 20, seconds: 1}`."""
    table = spot.table("a pose, such as {pan: 20, seconds: 1}")
    if table is None:
        return None
    pose: dict[str, Json] = {}
    seconds = table.pop("seconds", None)
    nested = table.get("joints")
    if nested is not None and isinstance(nested.node, Table):
        pose["joints"] = _joints(table.pop("joints"), argument, setting)
        for entry in table.values():
            entry.unknown(("joints", "seconds"), "a pose has")
    else:
        pose["joints"] = _angles(spot, table, argument, setting)
    if seconds is not None:
        pose["seconds"] = read_seconds(seconds, Range(0.0, _LONGEST, "s"))
    return pose


_Reader = Callable[[Spot, Argument, Setting], Json]
_READERS: Mapping[str, _Reader] = {
    "text": _text,
    "choice": _text,
    "file": _file,
    "number": _number,
    "whole": _whole,
    "flag": _flag,
    "seconds": _seconds,
    "joints": _joints,
    "poses": _poses,
}
