"""Draws the meters: distance, loudness, who is there, engagement, the robot's pose, all other
sensors.

The order is fixed, whatever comes first: what the experiment file names under `sensors`, then what
the wizard plays by, and where the robot stands at the bottom.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from rich.cells import cell_len

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Cells, Piece, Row, clean, cut_rows, fit, heading, length
from woz_tui.console.drawing.glyphs import Glyphs, PaintFrame
from woz_tui.console.drawing.meter_rows import (
    MeterFrame,
    age_note,
    hidden_row,
    hidden_word,
    merge_pieces,
    meter_frame,
    meter_row,
    name_piece,
    ruler,
    track_cell,
)
from woz_tui.console.drawing.number_text import SILENCE_DB, decibels
from woz_tui.console.engagement.meter import block_rows
from woz_tui.console.engagement.sign_bars import FARTHEST
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.engagement_text import (
    nothing_seen,
    roughly,
    sign_word,
    state_sentence,
    zone_text,
)
from woz_tui.console.state.view_models import READING_WORDS, SENSOR_STATES, SensorView
from woz_tui.console.state.wizard_overrides import is_offered
from woz_tui.protocol.requesters import WATCHER
from woz_tui.protocol.sentence import Sentence
from woz_tui.sensing.sample_values import FLAGS, ZONES, is_share, percent, state_word
from woz_tui.session.redactor import perceived_kind

#: What one degree of freedom publishes; with its robot in front where several have the same.
_JOINT = re.compile(r"(?P<whose>.*\.)?(?P<kind>joint|setpoint)\.(?P<name>.+)")
#: Belongs to a loudness, and is drawn with it.
_THRESHOLD = re.compile(r"(.*\.)?loudness\..+")
#: Digits behind the point by unit, so that a value does not change its width.
_DIGITS = {"m": 2, "ms": 1, "deg": 0, "C": 0, "V": 1, "%": 0}
#: Half of a joint's range where nobody has told its limits, in degrees.
_HALF, _WHOLE = 90.0, 180.0
#: For programs, not for a wizard: how punctual a body's ticks are; that a driver cuts speech; how
#: many of a rangefinder's values arrive whole; what is sensed of each of several faces.
_FOR_THE_LOG = re.compile(r"(.*\.)?(tick|speech|distance\.(rate|bad)|face)")
#: Said last: where the robot stands, and from where it hears.
_LAST = ("direction", "base")


#: Joints that turn a robot away from whom it talks to, and from how many degrees on.
_TURNING = frozenset({"pan", "yaw", "tilt", "pitch", "hip", "hip-roll"})
TURNED = 10.0


def joint_rows(state: ConsoleState, frame: MeterFrame, room: int, others: int) -> list[Row]:
    """A row for each joint, or if that leaves less than `others` of `room`, all of them as text."""
    joints = _joints(state)
    if not joints:
        return []
    if state.perception.hides("joints"):
        return [hidden_row(say("meters.pose", "pose"), frame)]
    if len(joints) + others <= room:
        return [_joint(state, name, shown, frame) for name, shown in joints.items()]
    members = []
    for name, short in joints.items():
        sensor = _sensor(state, "joint", name) or _sensor(state, "setpoint", name)
        if sensor is not None:
            unit = _unit(sensor, frame)
            value = "?" if sensor.value is None else f"{round(sensor.value)}{unit}"
            members.append(_member(short, f"{value:<4}", state.is_stale(sensor, frame.now), frame))
    return _wrapped(name_piece(say("meters.pose", "pose"), frame), members, frame, max(1, room - 1))


def _joints(state: ConsoleState) -> dict[str, str]:
    """Joints by their full name, with the short one where that is no other joint's.

    In the robot file's order; those that it does not tell come last, by name.
    """
    found = (_JOINT.match(name) for name in state.sensors)
    known = {f"{match['whose'] or ''}{match['name']}": None for match in found if match}
    told = [name for name in _limits(state) if name in known]
    full = list(dict.fromkeys((*told, *known)))
    short = [name.rpartition(".")[2] for name in full]
    return {
        name: last if short.count(last) == 1 else name
        for name, last in zip(full, short, strict=True)
    }


def turned_away(state: ConsoleState) -> str:
    """The joints of head and trunk that are far from the middle, with their angles; empty: none, or
    they are kept from the wizard.
    """
    if state.perception.hides("joints"):
        return ""
    found = []
    for name, short in _joints(state).items():
        sensor = _sensor(state, "joint", name)
        if sensor is None or name.rpartition(".")[2] not in _TURNING:
            continue
        angle = sensor.value or 0.0
        if sensor.unit in ("", "deg") and abs(angle) >= TURNED:
            found.append(f"{clean(short)} {round(angle)}°")
    return ", ".join(found)


def _sensor(state: ConsoleState, kind: str, joint: str) -> SensorView | None:
    """The sensor of a joint, also of one robot's among several: `left.joint.pan` of `left.pan`."""
    whose, dot, name = joint.rpartition(".")
    found = state.sensor(f"{kind}.{joint}")
    return found or state.sensor(f"{whose}{dot}{kind}.{name}")


def _unit(sensor: SensorView | None, frame: MeterFrame) -> str:
    """Of a joint: degrees, unless its driver says otherwise."""
    unit = sensor.unit if sensor is not None else ""
    return frame.glyphs.degrees if unit in ("", "deg") else f" {unit}"


def _limits(state: ConsoleState) -> dict[str, tuple[float, float]]:
    """Joint -> lowest and highest angle in degrees, as far as the host has told."""
    joints = state.settings.joints
    return {name: (low, high) for name, (low, high) in joints.items() if low < high}


def _joint(state: ConsoleState, name: str, shown: str, frame: MeterFrame) -> Row:
    """Where the joint is (full mark) and where it should be (hollow mark) between its limits."""
    glyphs, width = frame.glyphs, frame.track
    present, wanted = _sensor(state, "joint", name), _sensor(state, "setpoint", name)
    here = present.value if present is not None else None
    there = wanted.value if wanted is not None else None
    limits = _limits(state)
    known = limits.get(name, limits.get(name.rpartition(".")[2]))
    if known is None:  # from where to where its values need
        values = [value for value in (here, there) if value is not None]
        half = _HALF if all(abs(value) <= _HALF for value in values) else _WHOLE
        known = -half, half
    low, high = known
    stale = present is not None and state.is_stale(present, frame.now)
    spots: dict[int, tuple[str, str]] = {}
    texts = []
    if here is not None:
        texts.append(f"{round(here):4}{_unit(present, frame)}")
    if there is not None:
        spots[track_cell((there - low) / (high - low), width)] = (glyphs.target, "run")
        if here is None or abs(there - here) >= 1:
            texts.append(f"{glyphs.next} {round(there)}{_unit(wanted, frame)}")
    if here is not None:
        spots[track_cell((here - low) / (high - low), width)] = (
            glyphs.position,
            "stale" if stale else "strong",
        )
    ticks = {track_cell(-low / (high - low), width): glyphs.tick} if low < 0 < high else {}
    text = age_note(present.t, frame) if stale and present is not None else " ".join(texts)
    look = "stale" if stale else "plain"
    return meter_row(shown, ruler(width, ticks, spots, glyphs), text, look, frame)


def _member(name: str, value: str, stale: bool, frame: MeterFrame) -> Row:
    mark = frame.glyphs.stale if stale else ""
    return ((f"{clean(name)} ", "muted"), (f"{mark}{value}", "stale" if stale else "plain"))


def _wrapped(front: Piece, members: Sequence[Row], frame: MeterFrame, room: int) -> list[Row]:
    """Members behind `front`, on at most `room` lines."""
    rows: list[Row] = []
    row: Row = (front,)
    for member in members:
        if length(row) + length(member) >= frame.width and len(row) > 1 and len(rows) + 1 < room:
            rows.append(row)
            row = (name_piece("", frame),)
        row += ((" ", "plain"), *member) if len(row) > 1 else member
    (text, look) = row[-1]
    return [*rows, (*row[:-1], (text.rstrip(), look))]


# -- everything else ----------------------------------------------------------------------------


def sensor_groups(state: ConsoleState, known: Sequence[str]) -> dict[str, list[SensorView]]:
    """Sensors that are not `known` and no joint, by the name of their row: those with a common
    first name (`base.x`, `base.y`) have one together.
    """
    groups: dict[str, list[SensorView]] = {}
    for name in sorted(state.sensors, key=lambda name: (len(name), name)):
        told = any(shape.fullmatch(name) for shape in (_JOINT, _THRESHOLD))
        sensor = state.sensor(name)
        if sensor is None or name in known or told:
            continue
        # What was understood of speech is in the model's rows, where there is a model.
        understood = bool(sensor.text) and state.session.model.shown is None
        if understood or not _FOR_THE_LOG.fullmatch(name):
            groups.setdefault(name.rpartition(".")[0] or name, []).append(sensor)
    names = sorted(groups, key=lambda name: (name in _LAST, name))
    return {name: groups[name] for name in names}


def _group_row(
    name: str, sensors: list[SensorView], state: ConsoleState, frame: MeterFrame, below: bool
) -> Row:
    """`below`: it stands under the sensor whose parts they are, which has the name."""
    if len(sensors) == 1:
        return _sensor_row(sensors[0], state, frame)
    members = []
    if all(state.perception.hides(perceived_kind(sensor.name)) for sensor in sensors):
        return hidden_row(name, frame)
    if not any(sensor.value is not None or sensor.text for sensor in sensors):
        nothing = say("meters.nothing_yet", "nothing yet")
        return (name_piece("" if below else name, frame), (nothing, "muted"))
    for sensor in sensors:
        # What has never been anything, such as a touch of a tablet, does not get old.
        stale = sensor.value is not None and state.is_stale(sensor, frame.now)
        last = sensor.name.rpartition(".")[2]
        members.append(_member(last, f"{figure(sensor, frame.glyphs):<7}", stale, frame))
    return _wrapped(name_piece("" if below else name, frame), members, frame, 1)[0]


def _sensor_row(sensor: SensorView, state: ConsoleState, frame: MeterFrame) -> Row:
    if state.perception.hides(perceived_kind(sensor.name)):
        return hidden_row(sensor.name, frame)
    ever = sensor.value is not None or sensor.text or sensor.state == "stale"
    stale = bool(ever) and state.is_stale(sensor, frame.now)
    parts = (clean(sensor.text), figure(sensor, frame.glyphs))
    text = " ".join(part for part in parts if part)
    text = text or say("meters.nothing", "nothing")
    told = "" if sensor.state == "ok" else _state_text(sensor)
    note = age_note(sensor.t, frame) if stale else told
    room = max(1, frame.width - frame.name - cell_len(note) - 2)
    return (
        name_piece(sensor.name, frame),
        (fit(text, room), "stale" if stale else "plain"),
        (f" {note} ", "stale" if stale else "muted"),
    )


def figure(sensor: SensorView, glyphs: Glyphs) -> str:
    """A sensor's value with its unit, always equally many digits behind the point."""
    if sensor.value is None:
        return "" if sensor.text else glyphs.dash
    if told := state_word(sensor.name, sensor.value):
        return word(READING_WORDS.get(told, told))
    if is_share(sensor.name, sensor.value, sensor.unit):
        return percent(sensor.value)
    digits = _DIGITS.get(sensor.unit)
    shown = f"{sensor.value:.4g}" if digits is None else f"{sensor.value:.{digits}f}"
    if shown.startswith("-") and not shown.strip("-0."):
        shown = shown[1:]  # no minus before a zero
    if sensor.unit == "deg":
        return f"{shown}{glyphs.degrees}"
    return f"{shown} {clean(sensor.unit)}".strip()


def _state_text(sensor: SensorView) -> str:
    return clean(word(SENSOR_STATES.get(sensor.state, sensor.state)))


#: Rows of meters at the most.
MOST = 40
#: Sensors with a place of their own.
_KNOWN = ("distance", "loudness", "presence", "gaze", "identity")


def meter_rows(state: ConsoleState, space: PaintFrame) -> list[Row]:
    """At most the frame's height; joints fold into text where room is short."""
    known = [name for name in state.sensors if name.rpartition(".")[2] in _KNOWN]
    near = [name for name in known if name.endswith("distance")]
    groups = sensor_groups(state, known)
    names = [_short(name) for name in known if name.rpartition(".")[2] in ("distance", "loudness")]
    names += [_visitor(robot) for robot in _robots(known)]
    names += [sensors[0].name if len(sensors) == 1 else name for name, sensors in groups.items()]
    frame = meter_frame(space, [*names, *_joints(state).values()])
    shown = state.session.model.shown
    if shown is not None:
        parts = block_rows(state, shown, frame, _loudness_rows)
        for name in near if len(near) > 1 else ():  # one alone is the model's, which has its place
            parts[name] = [*parts.get(name, ()), *_distance(state, name, frame)]
    else:
        parts = {name: _distance(state, name, frame) for name in near}
        parts["loudness"] = _loudness_rows(state, frame, "")
        for robot in _robots(known):
            parts[f"{robot}visitor"] = _verdicts(state, robot, frame)
        parts["engagement"] = _engagement(state, frame)
    others = {
        name: _group_row(name, sensors, state, frame, name in parts)
        for name, sensors in groups.items()
    }
    room = frame.height - sum(map(len, parts.values()))
    parts["pose"] = joint_rows(state, frame, room, len(others))
    for name, row in others.items():
        parts[name] = [*parts.get(name, ()), row]
    # What the file names first, in its order; then the others in theirs.
    first = [name for wish in state.settings.sensors for name in parts if _is_named(name, wish)]
    rows = [row for name in dict.fromkeys((*first, *parts)) for row in parts[name]]
    if not rows:
        rows = [((fit(f" {say('meters.no_data', 'no sensor data yet')}", frame.width), "muted"),)]
    return cut_rows(rows, frame)


def _is_named(part: str, wish: str) -> bool:
    """Whether a part shows the sensor `wish`, or is called so; also one robot's among several."""
    last = part.rpartition(".")[2]
    if wish.rpartition(".")[2] in ("presence", "gaze", "identity"):
        return last == "visitor" and part.startswith(wish.rpartition(".")[0])
    return wish in (part, last) or wish.startswith(f"{part}.")


# -- distance and loudness ----------------------------------------------------------------------


def _distance(state: ConsoleState, name: str, frame: MeterFrame) -> list[Row]:
    sensor = state.sensor(name)
    if sensor is None or state.perception.hides("distance"):
        return [hidden_row(_short(name), frame)]
    glyphs, width = frame.glyphs, frame.track
    if state.perception.blurs("distance"):
        return [_coarse(state, sensor, frame)]
    ticks = {track_cell(limit / FARTHEST, width): glyphs.tick for limit, _ in ZONES}
    stale = state.is_stale(sensor, frame.now)
    if sensor.value is None:
        text = age_note(sensor.t, frame) if stale else nothing_seen()
        look = "stale" if stale else "muted"
        return [meter_row(_short(name), ruler(width, ticks, {}, glyphs), text, look, frame)]
    spot = {
        track_cell(sensor.value / FARTHEST, width): (glyphs.spot, "stale" if stale else "strong")
    }
    text = f"{sensor.value:.2f} m {zone_text(sensor.value)}"
    if stale:
        text = f"{sensor.value:.1f} m {age_note(sensor.t, frame)}"
    look = "stale" if stale else "plain"
    return [meter_row(_short(name), ruler(width, ticks, spot, glyphs), text, look, frame)]


def _coarse(state: ConsoleState, sensor: SensorView, frame: MeterFrame) -> Row:
    """A blurred value in a word, on a track without marks."""
    stale = state.is_stale(sensor, frame.now)
    track_row: Row = ((frame.glyphs.track * frame.track, "faint"),)
    text = age_note(sensor.t, frame) if stale else roughly(sensor.text)
    look = "stale" if stale else "plain"
    return meter_row(_short(sensor.name), track_row, text, look, frame)


def _short(name: str) -> str:
    """`distance`, or whose it is: `left dist`."""
    whose, _, kind = name.rpartition(".")
    told = word(_ROWS.get(kind, kind))
    return f"{whose} {told[:4]}" if whose else told


#: Sensors that have a row of their own, as it is called.
_ROWS = {
    "distance": Sentence("meters.distance", "distance"),
    "loudness": Sentence("meters.loudness", "loudness"),
}


def _visitor(robot: str) -> str:
    """What the row of a robot's visitor is called."""
    return f"{robot}{say('meters.visitor', 'visitor')}"


def _robots(names: list[str]) -> list[str]:
    """What stands before the sensors of each robot: `left.`, or nothing."""
    return list(dict.fromkeys(name[: -len(name.rpartition(".")[2])] for name in names))


def _loudness_rows(state: ConsoleState, frame: MeterFrame, speech: str) -> list[Row]:
    """Every microphone's level; `speech`: how long an utterance lasts that is being cut out."""
    loud = [name for name in state.sensors if name.rpartition(".")[2] == "loudness"]
    return [row for name in loud for row in _loudness(state, name, frame, speech)]


def _loudness(state: ConsoleState, name: str, frame: MeterFrame, speech: str = "") -> list[Row]:
    """The level on a track of decibels, quiet below the threshold of speech, green in a voice."""
    sensor = state.sensor(name)
    if sensor is None or state.perception.hides("loudness"):
        return [hidden_row(_short(name), frame)]
    if state.perception.blurs("loudness"):
        return [_coarse(state, sensor, frame)]
    glyphs, width = frame.glyphs, frame.track
    if sensor.value is None or state.is_stale(sensor, frame.now):
        empty: Row = ((glyphs.track * width, "faint"),)
        return [meter_row(_short(name), empty, age_note(sensor.t, frame), "stale", frame)]
    level = decibels(sensor.value)
    speaking = sensor.state == "speaking"
    full = track_cell(1 - level / SILENCE_DB, width + 1)
    loud = "good" if speaking else "muted"
    cells = [(glyphs.bar, loud) if x < full else (glyphs.track, "faint") for x in range(width)]
    threshold = state.sensor(f"{name}.threshold")  # from which a voice counts
    if threshold is not None and threshold.value is not None:
        mark_at = track_cell(1 - decibels(threshold.value) / SILENCE_DB, width)
        cells[mark_at] = (glyphs.tick, "strong")
    voice = say("meters.voice", "voice")
    mark = f"{glyphs.yes} {voice}" if speaking else _state_text(sensor)
    look = "good" if speaking else "warn" if sensor.state in ("clipping", "silent") else "plain"
    if speech and look != "warn":
        mark, look = f"{glyphs.yes} {speech}", "good"
    return [meter_row(_short(name), merge_pieces(cells), f"{level:3.0f} dB {mark}", look, frame)]


# -- who is there, and what the robot makes of it -------------------------------------------------


def _verdicts(state: ConsoleState, robot: str, frame: MeterFrame) -> list[Row]:
    """Presence, gaze and identity with a mark each: yes, no, old."""
    glyphs = frame.glyphs
    pieces: list[Piece] = []
    for name in ("presence", "gaze"):
        shown = sign_word(name)
        sensor = state.sensor(f"{robot}{name}")
        if sensor is None:
            continue
        if state.perception.hides(name):
            mark, told, look = glyphs.middle, f"{shown} {hidden_word()}", "muted"
        elif state.is_stale(sensor, frame.now):
            mark, told, look = glyphs.stale, shown, "stale"
        elif FLAGS[name](sensor.value):
            mark, told, look = glyphs.yes, shown, "good"
        else:
            mark, told, look = glyphs.no, shown, "muted"
        pieces += [(f"{mark} {told}", look), ("  ", "plain")]
    who = state.sensor(f"{robot}identity")
    if who is not None and state.perception.hides("identity"):
        pieces.append((say("meters.who_hidden", "who hidden"), "muted"))
    elif who is not None:
        name = clean(who.text) or say("meters.unknown", "unknown")
        look = "stale" if state.is_stale(who, frame.now) else "plain" if who.text else "muted"
        pieces.append((name, look))
    return [(name_piece(_visitor(robot), frame), *pieces)] if pieces else []


def _engagement(state: ConsoleState, frame: MeterFrame) -> list[Row]:
    changed = state.session.model.changed
    if state.perception.hides("engagement") and is_offered(state.engaged, state.verbs):
        return [hidden_row(say("meters.engaged", "engaged"), frame)]
    if changed is None:
        return []
    glyphs, watches = frame.glyphs, state.role == WATCHER
    told = state_sentence(changed.now, changed.visitor, glyphs, watches=watches)
    first: Row = (
        name_piece(say("meters.engaged", "engaged"), frame),
        (told, "strong"),
    )
    marked = []
    for name, value in changed.verdicts.items():
        if isinstance(value, bool | int | float):
            marked.append(f"{glyphs.yes if value else glyphs.no} {clean(name)}")
        elif isinstance(value, str):
            marked.append(clean(value))
    verdicts = "  ".join(marked)
    if length(first) + cell_len(verdicts) + 2 <= frame.width:
        first += ((f"  {verdicts}", "muted"),)
    why: Row = (name_piece("", frame), (clean(changed.why), "muted"))
    return [first, why]


class Meters(Cells):
    #: Lines they would like to have; never less than before, so that nothing jumps back.
    needs = 1

    def paint(self, state: ConsoleState, frame: PaintFrame) -> None:
        """Show a heading, and what the sensors said last."""
        inner = replace(frame, height=MOST)
        rows = meter_rows(state, inner)
        self.needs = max(self.needs, len(rows) + 1)
        if len(rows) > frame.height - 1:
            rows = meter_rows(state, replace(frame, height=frame.height - 1))
        self.show([heading(say("meters.heading", "Sensors"), frame), *rows])
