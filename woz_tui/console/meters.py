"""What the sensors say: distance, loudness, who is there, engagement, the robot's pose.

The order is fixed, whatever comes first: what the experiment file names under `sensors`, then what
the wizard plays by, and where the robot stands at the bottom.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from rich.cells import cell_len

from woz_tui.console.cells import Cells, Piece, Row, clean, cut, fit, heading, length
from woz_tui.console.console_state import ConsoleState
from woz_tui.console.engagement.engagement_meter import block_rows
from woz_tui.console.engagement.engagement_text import state_sentence
from woz_tui.console.engagement.sign_bars import FARTHEST
from woz_tui.console.engagement.wizard_overrides import is_offered
from woz_tui.console.glyphs import Glyphs, PaintFrame
from woz_tui.console.meter_rows import (
    NAME,
    age_note,
    hidden_row,
    merge_pieces,
    meter_row,
    name_piece,
    ruler,
    track_cell,
    track_width,
)
from woz_tui.console.number_text import SILENCE_DB, decibels
from woz_tui.console.pose_meter import joint_rows, other_rows
from woz_tui.console.view_models import SensorView
from woz_tui.protocol import messages as m
from woz_tui.sensing.proxemics import ZONES, zone
from woz_tui.sensing.sample_values import FLAGS
from woz_tui.session.redactor import HIDDEN

#: Rows of meters at the most.
MOST = 40
#: Sensors with a place of their own.
_KNOWN = ("distance", "loudness", "presence", "gaze", "identity")


def meter_rows(picture: ConsoleState, frame: PaintFrame) -> list[Row]:
    """At most the frame's height; joints fold into text where room is short."""
    known = [name for name in picture.sensors if name.rpartition(".")[2] in _KNOWN]
    near = [name for name in known if name.endswith("distance")]
    shown = picture.engaged.shown
    if shown is not None:
        parts = block_rows(picture, shown, frame, _loudness_rows)
        for name in near if len(near) > 1 else ():  # one alone is the model's, which has its place
            parts[name] = [*parts.get(name, ()), *_distance(picture, name, frame)]
    else:
        parts = {name: _distance(picture, name, frame) for name in near}
        parts["loudness"] = _loudness_rows(picture, frame, "")
        for robot in _robots(known):
            parts[f"{robot}visitor"] = _verdicts(picture, robot, frame)
        parts["engagement"] = _engagement(picture, frame)
    others = other_rows(picture, frame, known)
    room = frame.height - sum(map(len, parts.values()))
    parts["pose"] = joint_rows(picture, frame, room, len(others))
    parts |= {name: [row] for name, row in others.items()}
    rows = [row for name in _ordered(parts, picture.settings.sensors) for row in parts[name]]
    if not rows:
        rows = [((fit(" no sensor has said anything yet", frame.width), "muted"),)]
    return [cut(row, frame.width, frame.glyphs.ellipsis) for row in rows[: frame.height]]


def _ordered(parts: Iterable[str], wanted: Iterable[str]) -> list[str]:
    """The parts that the file names first, in its order; then the others in theirs."""
    names = list(parts)
    first = [name for wish in wanted for name in names if _is_named(name, wish)]
    return list(dict.fromkeys((*first, *names)))


def _is_named(part: str, wish: str) -> bool:
    """Whether a part shows the sensor `wish`, or is called so; also one robot's among several."""
    last = part.rpartition(".")[2]
    if wish.rpartition(".")[2] in ("presence", "gaze", "identity"):
        return last == "visitor" and part.startswith(wish.rpartition(".")[0])
    return wish in (part, last) or wish.startswith(f"{part}.")


def _stale(picture: ConsoleState, sensor: SensorView, frame: PaintFrame) -> bool:
    return picture.is_stale(sensor, frame.now)


# -- distance and loudness ----------------------------------------------------------------------


def _distance(picture: ConsoleState, name: str, frame: PaintFrame) -> list[Row]:
    sensor = picture.sensor(name)
    if sensor is None or picture.perception.hides("distance"):
        return [hidden_row(_short(name), frame)]
    glyphs, width = frame.glyphs, track_width(frame)
    if picture.perception.blurs("distance"):
        return [_coarse(picture, sensor, frame)]
    ticks = {track_cell(limit / FARTHEST, width): glyphs.tick for limit, _ in ZONES}
    stale = _stale(picture, sensor, frame)
    if sensor.value is None:
        text = age_note(sensor, frame) if stale else "nothing seen"
        look = "stale" if stale else "muted"
        return [meter_row(_short(name), ruler(width, ticks, {}, glyphs), text, look)]
    spot = {
        track_cell(sensor.value / FARTHEST, width): (glyphs.spot, "stale" if stale else "strong")
    }
    text = f"{sensor.value:.2f} m {zone(sensor.value)}"
    if stale:
        text = f"{sensor.value:.1f} m {age_note(sensor, frame)}"
    look = "stale" if stale else "plain"
    return [meter_row(_short(name), ruler(width, ticks, spot, glyphs), text, look)]


def _coarse(picture: ConsoleState, sensor: SensorView, frame: PaintFrame) -> Row:
    """A blurred value in a word, on a track without marks."""
    stale = _stale(picture, sensor, frame)
    track_row: Row = ((frame.glyphs.track * track_width(frame), "faint"),)
    text = age_note(sensor, frame) if stale else sensor.text or "nothing seen"
    return meter_row(_short(sensor.name), track_row, text, "stale" if stale else "plain")


def _short(name: str) -> str:
    """`distance`, or whose it is: `left dist`."""
    whose, _, kind = name.rpartition(".")
    return f"{fit(whose, NAME - 7).rstrip()} {kind[:4]}" if whose else name


def _robots(names: list[str]) -> list[str]:
    """What stands before the sensors of each robot: `left.`, or nothing."""
    return list(dict.fromkeys(name[: -len(name.rpartition(".")[2])] for name in names))


def _loudness_rows(picture: ConsoleState, frame: PaintFrame, speech: str) -> list[Row]:
    """Every microphone's level; `speech` is said of an utterance that is being cut out of it."""
    loud = [name for name in picture.sensors if name.rpartition(".")[2] == "loudness"]
    return [row for name in loud for row in _loudness(picture, name, frame, speech)]


def _loudness(picture: ConsoleState, name: str, frame: PaintFrame, speech: str = "") -> list[Row]:
    """The level on a track of decibels, quiet below the threshold of speech, green in a voice."""
    sensor = picture.sensor(name)
    if sensor is None or picture.perception.hides("loudness"):
        return [hidden_row(_short(name), frame)]
    if picture.perception.blurs("loudness"):
        return [_coarse(picture, sensor, frame)]
    glyphs, width = frame.glyphs, track_width(frame)
    if sensor.value is None or _stale(picture, sensor, frame):
        empty: Row = ((glyphs.track * width, "faint"),)
        return [meter_row(_short(name), empty, age_note(sensor, frame), "stale")]
    level = decibels(sensor.value)
    speaking = sensor.state == "speaking"
    full = track_cell(1 - level / SILENCE_DB, width + 1)
    threshold = _threshold(picture, name)
    mark_at = None if threshold is None else track_cell(1 - decibels(threshold) / SILENCE_DB, width)
    loud = "good" if speaking else "muted"
    cells = [(glyphs.bar, loud) if x < full else (glyphs.track, "faint") for x in range(width)]
    if mark_at is not None:
        cells[mark_at] = (glyphs.tick, "strong")
    mark = f"{glyphs.yes} voice" if speaking else clean(sensor.state)
    look = "good" if speaking else "warn" if sensor.state in ("clipping", "silent") else "plain"
    if speech and look != "warn":
        mark, look = speech.replace("speech", glyphs.yes), "good"
    return [meter_row(_short(name), merge_pieces(cells), f"{level:3.0f} dB {mark}", look)]


def _threshold(picture: ConsoleState, loudness: str) -> float | None:
    """RMS from which a voice counts, as the microphone published it."""
    published = picture.sensor(f"{loudness}.threshold")
    return published.value if published is not None else None


# -- who is there, and what the robot makes of it -------------------------------------------------


def _verdicts(picture: ConsoleState, robot: str, frame: PaintFrame) -> list[Row]:
    """Presence, gaze and identity with a mark each: yes, no, old."""
    pieces: list[Piece] = []
    for name, word in (("presence", "person"), ("gaze", "looks")):
        sensor = picture.sensor(f"{robot}{name}")
        if sensor is None:
            continue
        if picture.perception.hides(name):
            pieces.append((f"{frame.glyphs.middle} {word} {HIDDEN}", "faint"))
        else:
            yes = bool(FLAGS[name](sensor.value))
            pieces.append(_verdict(yes, word, _stale(picture, sensor, frame), frame.glyphs))
        pieces.append(("  ", "plain"))
    who = picture.sensor(f"{robot}identity")
    if who is not None and picture.perception.hides("identity"):
        pieces.append((f"who {HIDDEN}", "faint"))
    elif who is not None:
        name = clean(who.text) or "unknown"
        look = "stale" if _stale(picture, who, frame) else "plain" if who.text else "muted"
        pieces.append((name, look))
    return [(name_piece(f"{robot}visitor"), *pieces)] if pieces else []


def _verdict(yes: bool, word: str, stale: bool, glyphs: Glyphs) -> Piece:
    if stale:
        return (f"{glyphs.stale} {word}", "stale")
    if yes:
        return (f"{glyphs.yes} {word}", "good")
    return (f"{glyphs.no} {word}", "muted")


def _engagement(picture: ConsoleState, frame: PaintFrame) -> list[Row]:
    changed = picture.session.model.changed
    if picture.perception.hides("engagement") and is_offered(picture.engaged, picture.verbs):
        return [hidden_row("engaged", frame)]
    if changed is None:
        return []
    verdicts = "  ".join(_marked(changed, frame.glyphs))
    first: Row = (
        name_piece("engaged"),
        (state_sentence(changed.now, changed.visitor, frame.glyphs), "strong"),
    )
    if length(first) + cell_len(verdicts) + 2 <= frame.width:
        first += ((f"  {verdicts}", "muted"),)
    why: Row = ((" " * NAME, "plain"), (clean(changed.why), "muted"))
    return [first, why]


def _marked(changed: m.EngagementChanged, glyphs: Glyphs) -> list[str]:
    marked = []
    for name, value in changed.verdicts.items():
        if isinstance(value, bool | int | float):
            marked.append(f"{glyphs.yes if value else glyphs.no} {clean(name)}")
        elif isinstance(value, str):
            marked.append(clean(value))
    return marked


class Meters(Cells):
    """The meters."""

    #: Lines they would like to have; never less than before, so that nothing jumps back.
    needs = 1

    def paint(self, picture: ConsoleState, frame: PaintFrame) -> None:
        """Show a heading, and what the sensors said last."""
        inner = replace(frame, height=MOST)
        rows = meter_rows(picture, inner)
        self.needs = max(self.needs, len(rows) + 1)
        if len(rows) > frame.height - 1:
            rows = meter_rows(picture, replace(frame, height=frame.height - 1))
        self.show([heading("Sensors", frame), *rows])
