"""The robot's pose, and sensors that have no place of their own among the meters."""

from __future__ import annotations

import re
from collections.abc import Sequence

from rich.cells import cell_len

from woz_tui.console.cells import Piece, Row, clean, fit, length
from woz_tui.console.console_state import ConsoleState
from woz_tui.console.glyphs import Glyphs, PaintFrame
from woz_tui.console.meter_rows import (
    NAME,
    age_note,
    hidden_row,
    meter_row,
    name_piece,
    ruler,
    track_cell,
    track_width,
)
from woz_tui.console.number_text import is_share
from woz_tui.console.view_models import SensorView
from woz_tui.session.redactor import perceived_kind

#: What one degree of freedom publishes; with its robot in front where several have the same.
_JOINT = re.compile(r"(?P<whose>.*\.)?(?P<kind>joint|setpoint)\.(?P<name>.+)")
#: Belongs to a loudness, and is drawn with it.
_THRESHOLD = re.compile(r"(.*\.)?loudness\..+")
#: Digits behind the point by unit, so that a value does not change its width.
_DIGITS = {"m": 2, "ms": 1, "deg": 0, "C": 0, "V": 1, "%": 0}
#: Half of a joint's range where nobody has told its limits, in degrees.
_HALF, _WHOLE = 90.0, 180.0
#: For programs, not for a wizard: how punctual a body's ticks are; that a driver cuts speech.
_FOR_THE_LOG = re.compile(r"(.*\.)?(tick|speech)")
#: Said last: where the robot stands, and from where it hears.
_LAST = ("direction", "base")


def joint_rows(picture: ConsoleState, frame: PaintFrame, room: int, others: int) -> list[Row]:
    """A row for each joint, or if that leaves less than `others` of `room`, all of them as text."""
    joints = _joints(picture)
    if not joints:
        return []
    if picture.perception.hides("joints"):
        return [hidden_row("pose", frame)]
    if len(joints) + others <= room:
        return [_joint(picture, name, shown, frame) for name, shown in joints.items()]
    return _folded(picture, joints, frame, max(1, room - 1))


def _joints(picture: ConsoleState) -> dict[str, str]:
    """Joints by their full name, with the short one where that is no other joint's.

    In the robot file's order; those that it does not tell come last, by name.
    """
    found = (_JOINT.match(name) for name in picture.sensors)
    known = {f"{match['whose'] or ''}{match['name']}": None for match in found if match}
    told = [name for name in _limits(picture) if name in known]
    full = list(dict.fromkeys((*told, *known)))
    short = [name.rpartition(".")[2] for name in full]
    return {
        name: last if short.count(last) == 1 else name
        for name, last in zip(full, short, strict=True)
    }


def _sensor(picture: ConsoleState, kind: str, joint: str) -> SensorView | None:
    """The sensor of a joint, also of one robot's among several: `left.joint.pan` of `left.pan`."""
    whose, dot, name = joint.rpartition(".")
    found = picture.sensor(f"{kind}.{joint}")
    return found or picture.sensor(f"{whose}{dot}{kind}.{name}")


def _limits(picture: ConsoleState) -> dict[str, tuple[float, float]]:
    """Joint -> lowest and highest angle in degrees, as far as the host has told."""
    joints = picture.settings.joints
    return {name: (low, high) for name, (low, high) in joints.items() if low < high}


def _joint(picture: ConsoleState, name: str, shown: str, frame: PaintFrame) -> Row:
    """Where the joint is (full mark) and where it should be (hollow mark) between its limits."""
    glyphs, width = frame.glyphs, track_width(frame)
    present, wanted = _sensor(picture, "joint", name), _sensor(picture, "setpoint", name)
    here = present.value if present is not None else None
    there = wanted.value if wanted is not None else None
    limits = _limits(picture)
    low, high = _range(limits.get(name, limits.get(name.rpartition(".")[2])), here, there)
    stale = present is not None and picture.is_stale(present, frame.now)
    spots: dict[int, tuple[str, str]] = {}
    texts = []
    if here is not None:
        texts.append(f"{round(here):4}{glyphs.degrees}")
    if there is not None:
        spots[track_cell((there - low) / (high - low), width)] = (glyphs.target, "run")
        if here is None or abs(there - here) >= 1:
            texts.append(f"{glyphs.next} {round(there)}{glyphs.degrees}")
    if here is not None:
        spots[track_cell((here - low) / (high - low), width)] = (
            glyphs.position,
            "stale" if stale else "strong",
        )
    ticks = {track_cell(-low / (high - low), width): glyphs.tick} if low < 0 < high else {}
    text = age_note(present, frame) if stale and present is not None else " ".join(texts)
    return meter_row(shown, ruler(width, ticks, spots, glyphs), text, "stale" if stale else "plain")


def _range(
    limits: tuple[float, float] | None, here: float | None, there: float | None
) -> tuple[float, float]:
    """From where to where a joint's row goes: its limits, or what its values need."""
    if limits is not None:
        return limits
    values = [value for value in (here, there) if value is not None]
    half = _HALF if all(abs(value) <= _HALF for value in values) else _WHOLE
    return -half, half


def _folded(
    picture: ConsoleState, joints: dict[str, str], frame: PaintFrame, room: int
) -> list[Row]:
    """All joints as text, on as many lines as there is room for."""
    pieces = []
    for name, short in joints.items():
        sensor = _sensor(picture, "joint", name) or _sensor(picture, "setpoint", name)
        if sensor is not None:
            value = "?" if sensor.value is None else f"{round(sensor.value)}{frame.glyphs.degrees}"
            pieces.append(_member(short, f"{value:<4}", picture.is_stale(sensor, frame.now), frame))
    return _wrapped(name_piece("pose"), pieces, frame, room)


def _member(name: str, value: str, stale: bool, frame: PaintFrame) -> Row:
    mark = frame.glyphs.stale if stale else ""
    return ((f"{clean(name)} ", "muted"), (f"{mark}{value}", "stale" if stale else "plain"))


def _wrapped(front: Piece, members: Sequence[Row], frame: PaintFrame, room: int) -> list[Row]:
    """Members behind `front`, on at most `room` lines."""
    rows: list[Row] = []
    row: Row = (front,)
    for member in members:
        if length(row) + length(member) >= frame.width and len(row) > 1 and len(rows) + 1 < room:
            rows.append(row)
            row = (name_piece(""),)
        row += ((" ", "plain"), *member) if len(row) > 1 else member
    (text, look) = row[-1]
    return [*rows, (*row[:-1], (text.rstrip(), look))]


# -- everything else ----------------------------------------------------------------------------


def other_rows(picture: ConsoleState, frame: PaintFrame, known: Sequence[str]) -> dict[str, Row]:
    """Sensors that are not `known` and no joint, by name: one a line, those with a common first
    name (`base.x`, `base.y`) together on one.
    """
    groups: dict[str, list[SensorView]] = {}
    for name in sorted(picture.sensors, key=lambda name: (len(name), name)):
        told = any(shape.fullmatch(name) for shape in (_JOINT, _THRESHOLD, _FOR_THE_LOG))
        if name not in known and not told and (sensor := picture.sensor(name)) is not None:
            groups.setdefault(name.rpartition(".")[0] or name, []).append(sensor)
    names = sorted(groups, key=lambda name: (name in _LAST, name))
    return {name: _group(name, groups[name], picture, frame) for name in names}


def _group(name: str, sensors: list[SensorView], picture: ConsoleState, frame: PaintFrame) -> Row:
    if len(sensors) == 1:
        return _alone(sensors[0], picture, frame)
    members = []
    if all(picture.perception.hides(perceived_kind(sensor.name)) for sensor in sensors):
        return hidden_row(name, frame)
    for sensor in sensors:
        # What has never been anything, such as a touch of a tablet, does not get old.
        stale = sensor.value is not None and picture.is_stale(sensor, frame.now)
        last = sensor.name.rpartition(".")[2]
        members.append(_member(last, f"{figure(sensor, frame.glyphs):<7}", stale, frame))
    return _wrapped(name_piece(name), members, frame, 1)[0]


def _alone(sensor: SensorView, picture: ConsoleState, frame: PaintFrame) -> Row:
    if picture.perception.hides(perceived_kind(sensor.name)):
        return hidden_row(sensor.name, frame)
    stale = picture.is_stale(sensor, frame.now)
    parts = (clean(sensor.text), figure(sensor, frame.glyphs))
    text = " ".join(part for part in parts if part) or "nothing"
    state = age_note(sensor, frame) if stale else clean(sensor.state)
    room = max(1, frame.width - NAME - cell_len(state) - 2)
    return (
        name_piece(sensor.name),
        (fit(text, room), "stale" if stale else "plain"),
        (f" {state} ", "stale" if stale else "muted"),
    )


def figure(sensor: SensorView, glyphs: Glyphs) -> str:
    """A sensor's value with its unit, always equally many digits behind the point."""
    if sensor.value is None:
        return "" if sensor.text else glyphs.dash
    if is_share(sensor.name, sensor.value, sensor.unit):
        return f"{sensor.value:.0%}"
    digits = _DIGITS.get(sensor.unit)
    shown = f"{sensor.value:.4g}" if digits is None else f"{sensor.value:.{digits}f}"
    if shown.startswith("-") and not shown.strip("-0."):
        shown = shown[1:]  # no minus before a zero
    if sensor.unit == "deg":
        return f"{shown}{glyphs.degrees}"
    return f"{shown} {clean(sensor.unit)}".strip()
